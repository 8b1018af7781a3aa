"""What commands share: options on scenes, tables for people, JSON for programs."""

import argparse
import json
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from restshape.application import application
from restshape.cli.ranks import first_rank, launched
from restshape.errors import UserError
from restshape.scene.load import load_scene
from restshape.scene.model import Scene

ENDLESS = 1_000_000
"""Columns of a table where there is no terminal: a row is one line there, for `grep` and `awk`."""


def add_json(parser: argparse.ArgumentParser) -> None:
    """Adds ``--json FILE``."""
    parser.add_argument("--json", metavar="FILE", type=Path, help="write the result for programs into this file")


def add_set(parser: argparse.ArgumentParser) -> None:
    """Adds ``--set key=value``, which may come several times."""
    parser.add_argument(
        "--set",
        metavar="KEY=VALUE",
        action="append",
        default=[],
        help="change one key of the scene, e.g. --set material.steel.E='70 GPa' (may be given several times)",
    )


def add_scene(parser: argparse.ArgumentParser) -> None:
    """Adds the scene with ``--set`` and ``--json``."""
    parser.add_argument("scene", metavar="SCENE", type=Path, help="scene file (.toml)")
    add_set(parser)
    add_json(parser)


def read_scene(args: argparse.Namespace) -> Scene:
    """The scene that the command line names, with its overrides; also makes sure that ``--json`` can be written.

    Raises:
        UserError: a bad scene, or an output that cannot be written.
    """
    open_json(args)
    return load_scene(args.scene, args.set)


def require_mesh(scene: Scene, why: str) -> None:
    """Makes sure that a scene has a mesh.

    Raises:
        UserError: its application needs none, and the command has no meaning for it, as `why` tells.
    """
    if application(scene.app).session:
        do = "name a scene of another application; restshape replay tells times and residuals of this one"
        raise UserError(f"a scene of {scene.app!r} has no mesh: {why}", str(scene.path), do)


def open_json(args: argparse.Namespace) -> None:
    """Makes sure, before any work, that the file of ``--json`` can be written.

    Raises:
        UserError: it cannot.
    """
    check_output(args.json, "--json")


def check_output(path: Path | None, option: str) -> None:
    """Makes sure, before any work, that a file can be written; leaves things as they were.

    Raises:
        UserError: it cannot.
    """
    if path is None or not first_rank():
        return
    existed = path.exists()
    try:
        path.open("ab").close()
    except OSError as error:
        do = "make its folder first" if not path.parent.is_dir() else "name another file"
        raise UserError(f"{path} cannot be written: {(error.strerror or str(error)).lower()}", option, do) from error
    if not existed:
        path.unlink(missing_ok=True)


def write_json(args: argparse.Namespace, data: Any) -> None:
    """Writes the result for programs, if ``--json`` asks for it.

    Raises:
        UserError: the file cannot be written.
    """
    if args.json is None:
        return
    try:
        args.json.write_text(json.dumps(data, indent=1, allow_nan=False) + "\n", encoding="utf-8")
    except OSError as error:
        what = f"{args.json} cannot be written: {(error.strerror or str(error)).lower()}"
        raise UserError(what, "--json", "name another file") from error


class Output(Console):
    """A console that leaves it to the caller what a pipe means whose reader has gone."""

    def on_broken_pipe(self) -> None:
        """Raises the error that there was."""
        raise BrokenPipeError


def console() -> Console:
    """Where tables go: as wide as the terminal, or as wide as they come where there is none, or a launcher's."""
    terminal = sys.stdout.isatty() and not launched()
    width = None if terminal else ENDLESS
    return Output(file=sys.stdout, force_terminal=terminal, width=width, highlight=False, soft_wrap=False)


def print_table(title: str, columns: Sequence[str], rows: Iterable[Sequence[Any]], right: Sequence[str] = ()) -> None:
    """Prints a table: ruled on a terminal, elsewhere aligned plain text, a row a line.

    Args:
        title: one line above.
        columns: heads.
        rows: one cell a column; numbers are shown with six digits.
        right: heads of the columns to align to the right.
    """
    out = console()
    box = {} if out.is_terminal else {"box": None, "pad_edge": False, "padding": (0, 2, 0, 0)}
    table = Table(header_style="bold", **box)
    for column in columns:
        table.add_column(Text(column), justify="right" if column in right else "left", overflow="fold")
    for row in rows:
        cells = [shown(cell) for cell in row]
        table.add_row(*(Text(cell if out.is_terminal else " ".join(cell.splitlines())) for cell in cells))
    out.print(Text(title, style="bold"), soft_wrap=True)
    if out.is_terminal:
        out.print(table)
        return
    with out.capture() as plain:
        out.print(table)
    for line in plain.get().splitlines():
        out.file.write(line.rstrip() + "\n")


def shown(cell: Any) -> str:
    """A cell as text."""
    if isinstance(cell, float):
        return f"{cell:.6g}"
    return "" if cell is None else str(cell)
