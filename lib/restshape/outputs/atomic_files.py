"""Files that are there whole or not at all: written under a name of their own beside the place, then renamed."""

import errno
import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

LONGEST = 255
"""Bytes of a file's name at most."""


def new_part(path: Path, keep_suffix: bool = False) -> tuple[Path, int]:
    """A new empty file beside a path, and its descriptor: nothing that was there is opened, and no link followed.

    Args:
        path: for which it stands in.
        keep_suffix: the name ends as that of the path, for programs that go by it.

    Raises:
        OSError: it cannot be made.
    """
    tail = f".part-{os.getpid()}-{secrets.token_hex(4)}"
    name = f"{path.stem}{tail}{path.suffix}" if keep_suffix else f"{path.name}{tail}"
    over = len(os.fsencode(name)) - LONGEST
    if over > 0:
        short = os.fsencode(path.stem if keep_suffix else path.name)[:-over].decode(errors="ignore")
        name = f"{short}{tail}{path.suffix if keep_suffix else ''}"
    part = path.with_name(name)
    flags = os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC
    return part, os.open(part, flags, 0o666)


def writable(path: Path) -> None:
    """Makes sure that a file can be written; leaves things as they were.

    Raises:
        OSError: it cannot.
    """
    target = Path(os.path.realpath(path))
    if target.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if target.exists() and not os.access(target, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))
    part, number = new_part(target)
    os.close(number)
    part.unlink()


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A new file to write, which takes the place of `path` once all is written; else that stays as it was.

    Where `path` is a link the file that it leads to is replaced; devices and pipes are written themselves.

    Raises:
        OSError: it cannot be written.
    """
    target = Path(os.path.realpath(path))
    if target.exists() and not target.is_file():
        yield target
        return
    part, number = new_part(target, keep_suffix=True)
    try:
        if target.exists():
            os.fchmod(number, target.stat().st_mode & 0o777)
        os.close(number)
        yield part
        with part.open("rb") as file:
            os.fsync(file.fileno())
        os.replace(part, target)
    except BaseException:
        with suppress(OSError):
            part.unlink()
        raise


def write_whole(path: Path, text: str) -> None:
    """Writes a text in UTF-8, whole or not at all.

    Raises:
        OSError: it cannot be written.
    """
    with replacing(path) as part:
        part.write_text(text, encoding="utf-8")
