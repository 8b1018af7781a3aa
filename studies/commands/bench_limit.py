"""The study `restshape bench limit`: what a level-1 frame must move, over what this machine can."""

import argparse
from dataclasses import replace
from math import sqrt
from pathlib import Path
from typing import Any

from restshape_studies.bench.turns import Announce, Case
from restshape_studies.commands.bench_kind import Kind, job_of

from restshape.cli.options import print_table
from restshape.errors import UserError

TIMES = (
    "frames of level 1 with an old preconditioner; residual, estimate and hand-over timed beside, without a recorder"
)
TRIANGLES = "2000,19000,200000"


def declare(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument(
        "--triangles", default=TRIANGLES, metavar="N,N", help="about how many, a size each (default: %(default)s)"
    )
    what = "frames of level 1 that are looked at (default: %(default)s)"
    parser.add_argument("--frames", dest="moved", type=int, default=30, metavar="N", help=what)


def triangles(args: argparse.Namespace) -> list[float]:
    """Numbers of triangles that are asked for.

    Raises:
        UserError: they are no such numbers.
    """
    try:
        found = [float(word) for word in args.triangles.split(",")]
    except ValueError:
        found = []
    if not found or not all(10 <= number < 1e8 for number in found):
        raise UserError(f"{args.triangles!r} is no list of numbers of triangles", "--triangles", TRIANGLES)
    return found


def check(args: argparse.Namespace) -> None:
    """Refuse what measures nothing."""
    triangles(args)
    if args.moved < 1:
        raise UserError(f"{args.moved} frames measure nothing", "--frames", "at least 1")


def measure(args: argparse.Namespace, case: Case, announce: Announce) -> dict[str, Any]:
    """A record a size."""
    from restshape_studies.bench.job import run
    from restshape_studies.bench.order import outline_of, sizes
    from restshape_studies.bench.turns import found_of

    from restshape.mesh.generate import generate
    from restshape.scene.load import load_scene

    scene = load_scene(case.scene, args.set)
    own = len(generate(outline_of(scene, str(case.scene)), scene.mesh).cells)
    found = {}
    for number in triangles(args):
        announce(f"{case.name}: about {number:,.0f} triangles")
        job = job_of(args, case, "auto", measure="limit", details={"frames": args.moved})
        job = replace(job, overrides=(*job.overrides, *sizes(scene, sqrt(own / number))))
        found[f"{number:.0f}"] = found_of(run(job), job)
    return {"tolerance": scene.solve.tolerance, "times": TIMES, "triangles": found}


def draw(found: dict[str, Any], args: argparse.Namespace, path: Path) -> None:
    """Draw stages beside their limits."""
    from restshape_studies.pictures.limit import draw_limits

    draw_limits(found, path)


def show(args: argparse.Namespace, name: str, found: dict[str, Any]) -> None:
    """Print a table a size."""
    for one in found["triangles"].values():
        sizes = one["sizes"]
        applied = sizes["preconditioner"]
        title = (
            f"{name}: {sizes['cells']:,} triangles, {sizes['unknowns']:,} unknowns, {sizes['blocks']:,} blocks in the "
            f"matrix, {applied['numbers']:,} numbers in the {applied['kind']} preconditioner, which is an old one; a "
            f"frame of level 1, {one['iterations']:.1f} iterations to {found['tolerance']:g}"
        )
        heads = ("stage", "must move, kB", "working set, kB", "triad, GB/s", "operations", "bound by", "limit, ms")
        heads += ("median, ms", "reached, %")
        rows = [_stage_row(stage, entry) for stage, entry in one["stages"].items()]
        rows.append(["rest: edit, Python", *[""] * 6, f"{one['rest_ms']:.4f}", ""])
        for key, words in (("answer", "until the answer"), ("whole", "with residual, estimate, hand-over")):
            share = one[key]
            cells = (f"{share['least_ms']:.4f}", f"{share['ms']:.4f}", f"{100 * share['fraction']:.0f}")
            rows.append([words, *[""] * 5, *cells])
        print_table(title, heads, rows, right=heads[1:])
        print(f"most operations a second, measured: {one['flop_rate']:.3g}; one core; {one['frames']} frames")
        print()


def _stage_row(name: str, entry: dict[str, Any]) -> list[str]:
    kilobytes = [f"{entry[key] / 1e3:,.0f}" for key in ("bytes", "working_set")]
    fraction = entry["fraction"]
    return [
        name,
        *kilobytes,
        f"{entry['bandwidth'] / 1e9:.1f}",
        f"{entry['flops']:.3g}",
        entry["bound"] if entry["least_ms"] else "",
        f"{entry['least_ms']:.4f}",
        f"{entry['ms']:.4f}",
        f"{100 * fraction:.0f}" if fraction else "",
    ]


KINDS = (
    Kind(
        "limit",
        "the least time of a level-1 frame, by memory and operations, and the part reached",
        declare,
        check,
        measure,
        show,
        scenes="several",
        default=("plate",),
        picture="bench-limit.png",
        times=TIMES,
        draw=draw,
    ),
)
