"""What commands share: options on scenes, tables for people, JSON for programs."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from restshape.application import application_of
from restshape.cli.plain_table import plain_table
from restshape.cli.ranks import first_rank
from restshape.cli.terminal import on_terminal
from restshape.errors import UserError, printable
from restshape.outputs.atomic_files import write_whole
from restshape.outputs.claims import command_files, refuse_outputs
from restshape.outputs.kinds import JsonFile
from restshape.scene.permits import allow, trust_scripts
from restshape.scene.plain_values import named_files

if TYPE_CHECKING:
    from restshape.scene.model import Scene


def add_json(parser: argparse.ArgumentParser) -> None:
    """Adds ``--json FILE``."""
    parser.add_argument("--json", metavar="FILE", type=JsonFile, help="write the result for programs into this file")


ONE_KEY = "change one key of the scene, e.g. --set material.steel.E='70 GPa'"


def add_set(parser: argparse.ArgumentParser, form: str = "KEY=VALUE", what: str = ONE_KEY) -> None:
    """Adds ``--set key=value``, which may come several times, and what scenes may name and run.

    Args:
        parser: of the command.
        form: what follows --set.
        what: that does.
    """
    parser.add_argument(
        "--allow-path",
        metavar="DIR",
        action="append",
        default=[],
        type=Path,
        help="let the scene name files in this folder, not only beside itself (may be given several times)",
    )
    parser.add_argument(
        "--trust-geo", action="store_true", help="let gmsh run a whole .geo file, which may then do anything"
    )
    parser.add_argument(
        "--set",
        metavar=form,
        action="append",
        default=[],
        help=f"{what} (may be given several times)",
    )


def add_scene(parser: argparse.ArgumentParser, form: str = "KEY=VALUE", what: str = ONE_KEY) -> None:
    """Adds the scene with ``--set``, which `form` and `what` describe, and ``--json``."""
    parser.add_argument("scene", metavar="SCENE", type=Path, help="scene file (.toml)")
    add_set(parser, form, what)
    add_json(parser)


def read_scene(args: argparse.Namespace) -> Scene:
    """The scene that the command line names, with its overrides.

    Raises:
        UserError: a bad scene, or an output that is a file which the scene names.
    """
    from restshape.scene.load import load_scene

    scene = load_scene(args.scene, args.set)
    refuse_files_of_scene(args, scene)
    return scene


def permit(args: argparse.Namespace) -> None:
    """Lets scenes do what the command line permits.

    Raises:
        UserError: it names a folder that is not there.
    """
    for folder in getattr(args, "allow_path", ()):
        if not folder.is_dir():
            raise UserError("there is no such folder", f"--allow-path {folder}", "name the folder of the scene's file")
        allow(folder)
    if getattr(args, "trust_geo", False):
        trust_scripts()


def require_mesh(scene: Scene, why: str) -> None:
    """Makes sure that a scene has a mesh.

    Raises:
        UserError: its application needs none, and the command has no meaning for it, as `why` reports.
    """
    if not application_of(scene).editing.has_mesh:
        do = "name a scene of another application; restshape replay reports times and residuals of this one"
        raise UserError(f"a scene of {scene.app!r} has no mesh: {why}", str(scene.path), do)


def refuse_overwriting(args: argparse.Namespace) -> None:
    """Makes sure, before any work, that all files of the command line can be written, and destroy nothing.

    Raises:
        UserError: an output is an input, another output or a foreign file, or cannot be written.
    """
    if first_rank():
        refuse_outputs(*command_files(vars(args)))


def refuse_files_of_scene(args: argparse.Namespace, scene: Scene) -> None:
    """Makes sure that no output is a file that the scene names.

    Raises:
        UserError: one is.
    """
    inputs = {f"{scene.path} ({'.'.join(key)})": scene.folder / file for key, file in named_files(scene.raw)}
    if inputs and first_rank():
        refuse_outputs(command_files(vars(args))[0], inputs)


def write_json(args: argparse.Namespace, data: Any) -> None:
    """Writes the result for programs, if ``--json`` asks for it.

    Raises:
        UserError: the file cannot be written.
    """
    if args.json is None:
        return
    try:
        write_whole(args.json, json.dumps(data, indent=1, allow_nan=False) + "\n")
    except OSError as error:
        what = f"{args.json} cannot be written: {(error.strerror or str(error)).lower()}"
        raise UserError(what, "--json", "name another file") from error


def print_table(
    title: str,
    columns: Sequence[str],
    rows: Iterable[Sequence[Any]],
    right: Sequence[str] = (),
    doubtful: bool = False,
) -> None:
    """Prints a table: ruled on a terminal, elsewhere aligned plain text, a row a line.

    Args:
        title: one line above.
        columns: heads.
        rows: one cell a column; numbers are shown with six digits.
        right: heads of the columns to align to the right.
        doubtful: it is of what is not to be trusted: orange on a terminal.
    """
    cells = [[shown(cell) for cell in row] for row in rows]
    if not on_terminal():
        for line in (printable(title), *plain_table(columns, cells, right)):
            print(line)
        return
    # Rich takes as long to import as short commands take in all.
    from rich.table import Table
    from rich.text import Text

    from restshape.cli.console import ORANGE, console

    out = console()
    table = Table(header_style="bold", style=ORANGE if doubtful else "", row_styles=[ORANGE] * doubtful)
    for column in columns:
        table.add_column(Text(column), justify="right" if column in right else "left", overflow="fold")
    for row in cells:
        table.add_row(*map(Text, row))
    out.print(Text(printable(title), style="bold"), soft_wrap=True)
    out.print(table)


def shown(cell: Any) -> str:
    """A cell as text."""
    if isinstance(cell, float):
        return f"{cell:.6g}"
    return "" if cell is None else printable(str(cell))
