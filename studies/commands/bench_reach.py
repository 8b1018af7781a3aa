"""The study `restshape bench reach`: frames of a drag that moves the nodes near the hand alone."""

import argparse
import tempfile
from pathlib import Path
from typing import Any

from restshape_studies.bench.turns import Announce, Case
from restshape_studies.commands.bench_kind import FRAMES, Kind, add_policy, add_repeat

from restshape.cli.options import print_table
from restshape.errors import UserError


def declare(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--unknowns", type=float, default=1e5, metavar="N", help="about how many (default: 1e5)")
    parser.add_argument("--share", type=float, default=0.05, help="of the nodes that move (default: %(default)s)")
    parser.add_argument("--frames", type=int, default=40, metavar="N", help="of the drag (default: %(default)s)")
    add_policy(parser)
    add_repeat(parser)


def check(args: argparse.Namespace) -> None:
    """Refuse what measures nothing."""
    if args.repeat < 1 or args.frames < 2 or not args.unknowns >= 100:
        what = f"{args.repeat} runs of {args.frames} frames of {args.unknowns:g} unknowns measure nothing"
        raise UserError(what, "--repeat, --frames, --unknowns", "at least 1 run, 2 frames, 100 unknowns")
    if not 0 < args.share <= 0.5:
        what = f"{args.share:g} is no share of the nodes around the hole"
        raise UserError(what, "--share", "a number above 0, up to 0.5")


def measure(args: argparse.Namespace, case: Case, announce: Announce) -> dict[str, Any]:
    """A record with and without reach."""
    from restshape_studies.bench.reach import study

    with tempfile.TemporaryDirectory(prefix="restshape-bench-") as folder:
        given = (args.unknowns, args.share, args.frames, args.repeat, Path(folder), args.policy)
        return study(case.scene, *given, tuple(args.set), tuple(args.petsc), announce)


def show(args: argparse.Namespace, name: str, found: dict[str, Any]) -> None:
    """Print both, and their stages."""
    records = found["records"]
    heads = (
        "moves",
        "unknowns",
        "frames",
        "iterations",
        "level 1, p50",
        "its processor time",
        "press",
        "press and drag",
    )
    rows = [
        (
            key,
            f"{one['unknowns']}",
            f"{one['frames']}",
            f"{one['iterations']:.1f}",
            *(f"{one[ms]:.2f}" for ms in ("p50_ms", "cpu_p50_ms", "press_ms", "drag_ms")),
        )
        for key, one in records.items()
    ]
    print_table(f"{name}, reach {1e3 * found['reach']:.3g} mm, policy {args.policy}, ms", heads, rows, right=heads[1:])
    time, processor = found["ratios"].values()
    print(f"level 1 with reach is {time:.2f} times as fast, by processor time {processor:.2f} times")
    stages = ("edit", "relocate", "values", "factor", "krylov", "observe", "python", "estimate")
    rows = [(key, *(f"{one['stages'][stage]:.3f}" for stage in stages)) for key, one in records.items()]
    print_table("stages of a frame of level 1, p50 in ms", ("moves", *stages), rows, right=stages)


KINDS = (
    Kind(
        "reach",
        "a drag that moves the nodes near the hand alone, beside one that moves all",
        declare,
        check,
        measure,
        show,
        scenes="plate",
        times=FRAMES,
    ),
)
