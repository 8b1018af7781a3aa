"""The study `restshape bench nested`: drags of cloth on a coarse mesh, shown on a fine one."""

import argparse
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from restshape_studies.bench.turns import Announce, Case
from restshape_studies.commands.bench_kind import Kind

from restshape.application import application
from restshape.cli.options import print_table
from restshape.errors import UserError

BENDINGS = ("hinge", "morley")
SIZES = (1.0, 100.0)
"""Sizes [mm] of the fine mesh that may be asked for."""
MOST_LEVELS = 4


def declare(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--mm", type=float, default=3.5, help="size of the fine mesh [mm] (default: 3.5)")
    parser.add_argument("--bending", choices=BENDINGS, help="this kind alone (default: both)")
    parser.add_argument("--levels", type=int, default=2, metavar="N", help="nested meshes (default: 2)")
    parser.add_argument("--along", type=int, default=30, metavar="N", help="frames of the drag (default: 30)")


def check(args: argparse.Namespace) -> None:
    """Refuse scenes of the user's, and sizes and frames that make no sense."""
    if args.scenes:
        raise UserError("it has a scene and edits of its own", "SCENE", "leave it out")
    if not SIZES[0] <= args.mm <= SIZES[1]:
        raise UserError(f"{args.mm:g} mm is no size for it", "--mm", f"name one of {SIZES[0]:g} to {SIZES[1]:g} mm")
    if not 2 <= args.levels <= MOST_LEVELS:
        raise UserError(f"{args.levels} nested meshes are no number for it", "--levels", f"name 2 to {MOST_LEVELS}")
    if args.along < 2:
        raise UserError("a drag has two frames at least", "--along", "name more")


def own(args: argparse.Namespace) -> list[Case]:
    """Its cases: kinds of bending."""
    return [Case(name, Path(), None) for name in BENDINGS if args.bending in (None, name)]


def measure(args: argparse.Namespace, case: Case, announce: Announce) -> dict[str, Any]:
    """A record by the mesh that is predicted."""
    from restshape_studies.bench.nested import nested_drags

    scene = application("couture").folder / "scenes" / "longer.toml"
    with tempfile.TemporaryDirectory(prefix="restshape-nested-") as folder:
        return nested_drags(scene, case.name, 1e-3 * args.mm, args.along, Path(folder), announce, args.levels)


def show(_: argparse.Namespace, name: str, found: Mapping[str, Any]) -> None:
    """Print the table of a kind of bending."""
    heads = (
        "predicted",
        "nodes",
        "coarse",
        "unknowns",
        "first [s]",
        "press [s]",
        "frames",
        "p50 [ms]",
        "mean",
        "worst",
        "a second",
    )
    heads += ("steps", "largest estimate", "most idle [ms]")
    rows = []
    for way, one in found.items():
        counts = (
            f"{one['nodes']:,}",
            f"{one['coarse']:,}",
            f"{one['unknowns']:,}",
            f"{one['first']:.2f}",
            f"{one['press']:.2f}",
        )
        pace = ["-"] * 6
        if one["frames"]:
            pace = [
                f"{1e3 * one['median']:.1f}",
                f"{1e3 * one['mean']:.1f}",
                f"{1e3 * one['worst']:.1f}",
                f"{1.0 / one['mean']:.0f}",
                f"{one['steps']:g}",
            ]
            pace.append("-" if one["estimate"] is None else f"{one['estimate']:.1e}")
        rows.append((way, *counts, str(one["frames"]), *pace, f"{1e3 * one['idle']:.0f}"))
    print_table(name, heads, rows, heads[1:])


KINDS = (
    Kind(
        "nested",
        "frames a second of drags of cloth from a coarse mesh, shown on a fine one",
        declare,
        check,
        measure,
        show,
        scenes="still",
        about="drags on nested meshes are about one",
        own=own,
        times="predicted frames, of the processor, with their estimates; a second by the mean; idle: of one gap",
    ),
)
