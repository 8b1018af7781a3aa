"""The study `restshape bench order`: elements of both orders with as many unknowns."""

import argparse
from typing import Any

from restshape_studies.bench.turns import Announce, Case
from restshape_studies.commands.bench_kind import FRAMES, Kind, add_frames, add_policy, add_repeat, check_runs, job_of

from restshape.cli.options import print_table


def declare(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_policy(parser)
    add_frames(parser)
    add_repeat(parser)


def measure(args: argparse.Namespace, case: Case, announce: Announce) -> dict[str, Any]:
    """A record for each order."""
    from restshape_studies.bench.order import study

    return study(case.name, job_of(args, case), args.repeat, announce)


def show(args: argparse.Namespace, name: str, found: dict[str, Any]) -> None:
    """Print the table of both orders."""
    frames = found["orders"]["1"]["frames"]
    title = f"{name}: {frames} frames, policy {args.policy}; counts without the first frame"
    heads = ("order", "unknowns", "triangles", "frames of level 1, 2, 3", "iterations of level 1, 2, 3")
    heads += ("refreshes", "p50 [ms]", "p50, order 1 = 1", "all moved frames, order 1 = 1")
    rows = [
        (
            order,
            entry["unknowns"],
            entry["elements"],
            ", ".join(str(count) for count in entry["levels"].values()),
            ", ".join("-" if some is None else f"{some:.1f}" for some in entry["iterations"].values()),
            entry["refreshes"],
            f"{entry['p50_ms']:.3f}",
            *(("1", "1") if order == "1" else (f"{found['ratios'][key]:.2f}" for key in ("p50", "all"))),
        )
        for order, entry in found["orders"].items()
    ]
    print_table(title, heads, rows, right=heads)
    print(f"triangles of order 2 are {found['factor']:.3f} times as large")


KINDS = (
    Kind(
        "order",
        "elements of first and second order, with as many unknowns",
        declare,
        check_runs,
        measure,
        show,
        times=FRAMES,
    ),
)
