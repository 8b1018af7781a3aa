"""The study `restshape bench body`: the grid of a body's distance, and an adaptive one beside it."""

import argparse
import math
from pathlib import Path
from typing import Any

from restshape_studies.bench.turns import Announce, Case
from restshape_studies.commands.bench_kind import Kind

from restshape.bounds import BODY_TRIANGLES
from restshape.cli.options import print_table
from restshape.errors import UserError


def declare(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--file", type=Path, metavar="FILE", help="a closed surface (default: a mannequin)")
    parser.add_argument(
        "--triangles", type=int, default=30_000, metavar="N", help="of the mannequin, about (default: %(default)s)"
    )
    parser.add_argument("--spacing", type=float, metavar="MM", help="of the grid (default: as its error asks for)")
    parser.add_argument("--adaptive", action="store_true", help="compare it with an adaptive grid of cubes")


def check(args: argparse.Namespace) -> None:
    """Refuse scenes, and numbers that make no grid."""
    if args.scenes:
        raise UserError("it has a body of its own, or one of a file", "SCENE", "--file body.obj")
    if not 5_000 <= args.triangles <= min(250_000, BODY_TRIANGLES):
        raise UserError(f"a mannequin of {args.triangles} triangles is not made", "--triangles", "name 5000 to 250000")
    if args.spacing is not None and not 0.0 < args.spacing < math.inf:
        raise UserError(f"{args.spacing:g} mm is no spacing", "--spacing", "name a number above 0")


def own(args: argparse.Namespace) -> list[Case]:
    """Its only case."""
    return [Case(args.file.name if args.file else "mannequin", args.file or Path(), None)]


def measure(args: argparse.Namespace, case: Case, announce: Announce) -> dict[str, Any]:
    """Times and errors of the grid, and rows of the comparison."""
    from restshape_studies.bench.body import beside_adaptive, body_of, grid_times

    surface = body_of(args.file, args.triangles)
    announce(f"{case.name}: a grid for {len(surface.cells):,} of its triangles")
    found = grid_times(surface, None if args.spacing is None else 1e-3 * args.spacing)
    rows = beside_adaptive(surface, found) if args.adaptive else []
    return {key: value for key, value in found.items() if key != "grid"} | {"beside": rows}


def show(_: argparse.Namespace, name: str, found: dict[str, Any]) -> None:
    """Print the tables."""
    heads = ("triangles", "spacing [mm]", "MB", "error [mm]", "of 99 % [mm]")
    heads += ("made, busy [s]", "read [s]", "10,000 places [ms]")
    lengths = [f"{1e3 * found[key]:.3g}" for key in ("error", "usual_error")]
    times = [f"{found['made']:.3g}", f"{found['read']:.3g}", f"{found['asked_ms']:.3g}"]
    row = [str(found["triangles"]), f"{1e3 * found['spacing']:.3g}", f"{found['megabytes']:.3g}", *lengths, *times]
    print_table(f"grid of {name}: distance, gradient and Hessian", heads, [row], heads)
    if not found["beside"]:
        return
    heads = ("grid", "MB", "error [mm]", "of 99 % [mm]", "gradient, 99 %", "its jump, 99 %", "made, busy [s]")
    rows = [_row(one, found["made"]) for one in found["beside"]]
    print_table(f"in a band of {1e3 * found['band']:.3g} mm", heads, rows, heads[1:])


def _row(one: dict[str, Any], made: float) -> list[str]:
    lengths = [f"{1e3 * one[key]:.3g}" for key in ("error", "usual_error")]
    slopes = [f"{one[key]:.2g}" for key in ("gradient", "jump")]
    return [one["name"], f"{one['megabytes']:.3g}", *lengths, *slopes, f"{one.get('made', made):.3g}"]


KINDS = (
    Kind(
        "body",
        "time, memory and error of the grid of a body of triangles",
        declare,
        check,
        measure,
        show,
        scenes="still",
        own=own,
        times="making, of the processor; reading and asking, the shortest of several",
    ),
)
