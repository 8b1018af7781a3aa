"""The study `restshape bench large`: drags of large problems, under policies of reuse."""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path
from typing import Any

from restshape_studies.bench.turns import Announce, Case
from restshape_studies.commands.bench_drape import chosen
from restshape_studies.commands.bench_kind import FRAMES, Kind

from restshape.application import applications
from restshape.cli.options import print_table
from restshape.cli.shipped import named_scenes
from restshape.errors import UserError

NAMES = ("plane", "space", "motion")
LEAST = 100.0
HEADS = ("policy", "unknowns", "first frame, processor [ms]", "frames", "p50 [ms]", "processor [ms]", "frames/s")
HEADS += ("over auto", "iterations")
HEADS += ("refreshes", "preconditioner", "peak [MB]", "matrices, preconditioner [MB]", "rest over these")


def declare(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--cases", default="", metavar="A,B", help=f"these of {','.join(NAMES)} (default: all)")
    what = "about how many in each case (default: 1e6 in the plane and in motion, 3e5 in space)"
    parser.add_argument("--unknowns", type=float, default=None, metavar="N", help=what)
    what = "that a replay may take (default: %(default)g)"
    parser.add_argument("--seconds", type=float, default=600.0, metavar="S", help=what)


def check(args: argparse.Namespace) -> None:
    """Refuse scenes, unknown names, and numbers that measure nothing."""
    if args.scenes:
        raise UserError("it has scenes and edits of its own", "SCENE", "leave it out")
    if args.seconds <= 0.0 or not (args.unknowns is None or args.unknowns >= LEAST):
        raise UserError("this measures nothing", "--unknowns, --seconds", "--unknowns 1e6")
    chosen(args.cases, "cases", NAMES)


def own(args: argparse.Namespace) -> list[Case]:
    """Its cases."""
    return [Case(name, Path(), None) for name in chosen(args.cases, "cases", NAMES) or NAMES]


def measure(args: argparse.Namespace, case: Case, announce: Announce) -> dict[str, Any]:
    """The record of a case."""
    from restshape_studies.bench.large import CASES, study

    one = CASES[case.name]
    (scene,) = named_scenes([Path(one.scene)], [path for app in applications().values() for path in app.scenes()])
    unknowns = args.unknowns or one.unknowns
    with tempfile.TemporaryDirectory(prefix="restshape-bench-") as folder:
        return study(one, scene, unknowns, Path(folder), args.set, args.seconds, announce)


def show(_: argparse.Namespace, name: str, found: dict[str, Any]) -> None:
    """Print the table of a case."""
    rows = [_row(policy, one, found["ratios"]) for policy, one in found["policies"].items()]
    print_table(f"{name}: {found['title']}, one core", HEADS, rows, right=HEADS[1:])
    print()


def _row(policy: str, one: dict[str, Any], ratios: dict[str, float]) -> tuple[str, ...]:
    if "problem" in one:
        return (f"{policy}: {one['problem']}", *("" for _ in HEADS[1:]))
    moved = one["frames"] > 0
    rest = one["peak_mb"] - one["base_mb"]
    return (
        policy,
        f"{one['unknowns']:,}",
        f"{one['first_cpu_ms']:,.0f}",
        str(one["frames"]),
        f"{one['ms']:,.1f}" if moved else "",
        f"{one['cpu_ms']:,.1f}" if moved else "",
        f"{1e3 / one['cpu_ms']:.1f}" if moved else "",
        f"{ratios[policy]:.2f}" if policy in ratios else "",
        f"{one['iterations']:.1f}" if moved else "",
        str(one["refreshes"]) if moved else "",
        one["preconditioner"] if moved else "",
        f"{one['peak_mb']:,.0f}",
        f"{one['stored_mb']:,.0f}",
        f"{rest / one['stored_mb']:.2f}" if one["stored_mb"] else "",
    )


KINDS = (
    Kind(
        "large",
        "drags of a million unknowns: reuse beside refactoring and rebuilding, memory, predicted frames",
        declare,
        check,
        measure,
        show,
        scenes="still",
        own=own,
        times=FRAMES,
    ),
)
