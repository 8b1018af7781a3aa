"""Refuses, before any work, to write over files that are not restshape's to replace."""

import os
import stat
from collections.abc import Iterable, Mapping
from pathlib import Path

from restshape.errors import UserError
from restshape.outputs.atomic_files import writable
from restshape.outputs.kinds import OutputFile

Identity = tuple[int, int] | str


def refuse_outputs(outputs: dict[str, OutputFile], inputs: dict[str, Path]) -> None:
    """Makes sure that files can be written, and that this destroys nothing of the user's.

    Args:
        outputs: by the option that names each; folders, and devices such as /dev/null, are not looked at.
        inputs: files that the command reads, by what names each.

    Raises:
        UserError: an output is an input, another output, also through links, or not a file that restshape wrote by
            such an option; its name does not end as those of its kind; or it cannot be written.
    """
    taken = {identity(path): f"{name} reads" for name, path in inputs.items() if _is_file(path)}
    for option, path in outputs.items():
        _refuse_ending(path, option)
        if path.exists() and not path.is_file() and not path.is_dir():
            continue
        own = identity(path)
        if own in taken:
            raise UserError(f"this is the file that {taken[own]}", f"{option} {path}", "name another file")
        taken[own] = f"{option} writes"
        if not path.is_dir():
            refuse_foreign(path, f"{option} {path}")
            _check(path, option)


def refuse_foreign(path: OutputFile, where: str) -> None:
    """Makes sure that a file is not there, or is one that restshape wrote.

    Raises:
        UserError: it is another, or cannot be looked at.
    """
    try:
        ours = path.ours()
    except OSError as error:
        what = f"what is there cannot be read: {(error.strerror or str(error)).lower()}"
        raise UserError(what, where, "name another file") from error
    if not ours:
        raise UserError(f"this file is there, and is not {path.what}", where, "name another file, or move it away")


def command_files(values: Mapping[str, object]) -> tuple[dict[str, OutputFile], dict[str, Path]]:
    """The outputs and inputs among the arguments of a command, by options and names; those left out are left out."""
    outputs: dict[str, OutputFile] = {}
    inputs: dict[str, Path] = {}
    for name, value in values.items():
        for path in _paths(value):
            if isinstance(path, OutputFile):
                outputs[f"--{name.replace('_', '-')}"] = path
            else:
                inputs[f"{name} {path}"] = path
    return outputs, inputs


def identity(path: Path) -> Identity:
    """What two names of one file have in common: device and number, or where a file would be made."""
    try:
        found = path.stat()
    except OSError:
        return os.path.realpath(path)
    return found.st_dev, found.st_ino


def _refuse_ending(path: OutputFile, option: str) -> None:
    if path.endings and path.suffix.lower() not in path.endings:
        ends = " or ".join(path.endings)
        raise UserError(f"{path.noun}'s name ends in {ends}", f"{option} {path}", f"{option} {path}{path.endings[0]}")


def _is_file(path: Path) -> bool:
    try:
        return stat.S_ISREG(path.stat().st_mode)
    except OSError:
        return False


def _paths(value: object) -> Iterable[Path]:
    if isinstance(value, Path):
        return (value,)
    return (item for item in value if isinstance(item, Path)) if isinstance(value, list | tuple) else ()


def _check(path: OutputFile, option: str) -> None:
    try:
        writable(path)
    except OSError as error:
        do = "make its folder first" if not path.parent.is_dir() else "name another file"
        raise UserError(f"{path} cannot be written: {(error.strerror or str(error)).lower()}", option, do) from error
