"""The study `restshape bench size`: time of a frame of each level against the number of unknowns."""

import argparse
import tempfile
from pathlib import Path
from typing import Any

from restshape_studies.bench.turns import Announce, Case
from restshape_studies.commands.bench_kind import FRAMES, Kind, add_policy

from restshape.cli.options import print_table
from restshape.errors import UserError


def declare(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--from", dest="least", type=float, default=1e3, metavar="N", help="unknowns (default: 1e3)")
    parser.add_argument("--to", dest="most", type=float, default=1e6, metavar="N", help="unknowns (default: 1e6)")
    parser.add_argument("--points", type=int, default=7, metavar="K", help="sizes (default: %(default)s)")
    add_policy(parser)
    parser.add_argument(
        "--seconds", type=float, default=330.0, metavar="S", help="for all sizes together (default: %(default)g)"
    )


def check(args: argparse.Namespace) -> None:
    """Refuse what is no range of sizes."""
    if not 100 <= args.least <= args.most:
        raise UserError(
            f"{args.least:g} to {args.most:g} is no range of unknowns", "--from, --to", "--from 1e3 --to 1e6"
        )
    if args.points < 1 or args.seconds <= 0:
        raise UserError("there must be a size and time for it", "--points, --seconds", "leave them out")


def measure(args: argparse.Namespace, case: Case, announce: Announce) -> dict[str, Any]:
    """A record for each size, and the fitted powers."""
    from restshape_studies.bench.size import exponents, measure, sizes

    wanted = sizes(args.least, args.most, args.points if args.most > args.least else 1)
    with tempfile.TemporaryDirectory(prefix="restshape-bench-") as folder:
        given = (args.seconds, args.policy, tuple(args.set), tuple(args.petsc), announce)
        records = measure(case.scene, wanted, Path(folder), *given)
    return {"policy": args.policy, "sizes": records, "exponents": exponents(records)}


def draw(found: dict[str, Any], args: argparse.Namespace, path: Path) -> None:
    """Draw times against sizes."""
    from restshape_studies.pictures.scaling import draw_scaling

    (one,) = found.values()
    draw_scaling(one["sizes"], one["exponents"], one["policy"], path)


def show(args: argparse.Namespace, name: str, found: dict[str, Any]) -> None:
    """Print the tables of all sizes."""
    records, fits = found["sizes"], found["exponents"]
    heads = (
        "unknowns",
        "triangles",
        "level 1",
        "iterations",
        "level 1, old factor",
        "iterations",
        "level 2",
        "iterations",
    )
    heads += ("2 / 1", "level 3", "memory, MB", "what is missing, and why")
    rows = [_size_row(record) for record in records]
    powers = ["fitted power", "", *("" for _ in heads[2:])]
    for level, place in (("1", 2), ("2", 6), ("3", 9)):
        powers[place] = f"n^{fits[level]['exponent']:.2f}" if fits[level] else ""
    print_table(f"time a frame, p50 in ms, one core, policy {args.policy}", heads, [*rows, powers], heads[:-1])
    if any(record["first_frame_serves_as_level_3"] for record in records):
        print("* the first frame of the replay: a new mesh, pattern and factor, without the way from an old mesh")
    stages = ("edit", "relocate", "flip", "pattern", "values", "factor", "krylov", "observe", "python")
    shown = [(record, level) for level in ("1", "2") for record in records if record["levels"][level]]
    rows = [
        [level, f"{record['unknowns']}", *(f"{record['levels'][level]['stages'][stage]:.3f}" for stage in stages)]
        for record, level in shown
    ]
    print_table("stages of a frame, p50 in ms", ("level", "unknowns", *stages), rows, ("unknowns", *stages))


def _size_row(record: dict[str, Any]) -> list[str]:
    levels = record["levels"]
    cells = [str(record["unknowns"] or f"about {record['wanted']:.0f}"), str(record["elements"] or "")]
    for level in ("1", "1_old", "2"):
        found = levels[level]
        cells += [f"{found['ms']['p50']:.3f}", f"{found['iterations']:.1f}"] if found else ["", ""]
    # Of frames with the same old factor: a fresh one takes fewer iterations.
    both = levels["2"] and levels["1_old"]
    cells.append(f"{levels['2']['ms']['p50'] / levels['1_old']['ms']['p50']:.2f}" if both else "")
    star = " *" if record["first_frame_serves_as_level_3"] else ""
    cells.append(f"{levels['3']['ms']['p50']:.1f}{star}" if levels["3"] else "")
    cells.append(f"{record['memory_mb']:.0f}" if record["memory_mb"] else "")
    return [*cells, record["problem"]]


KINDS = (
    Kind(
        "size",
        "time of a frame of each level against the number of unknowns",
        declare,
        check,
        measure,
        show,
        scenes="plate",
        picture="bench-size.png",
        times=FRAMES,
        draw=draw,
    ),
)
