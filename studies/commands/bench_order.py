"""The study `restshape bench order`: elements of both orders with as many unknowns."""

import argparse
from pathlib import Path
from typing import Any

from restshape.cli.options import print_table
from restshape.errors import UserError
from restshape.policy import POLICIES


def arguments(studies: Any) -> argparse.ArgumentParser:
    """Declare the study; returns its parser."""
    study = studies.add_parser("order", help="elements of first and second order, with as many unknowns")
    study.add_argument("scene", metavar="SCENE", type=Path, help="scene file")
    study.add_argument("--edits", type=Path, metavar="FILE", help="edit script (default: the one that names the scene)")
    study.add_argument("--policy", choices=list(POLICIES), default="auto", help="default: %(default)s")
    study.add_argument(
        "--frames",
        type=int,
        default=0,
        metavar="N",
        help="first N frames of the script, 0 for all (default: %(default)s)",
    )
    study.add_argument("--repeat", type=int, default=3, metavar="R", help="timed runs (default: %(default)s)")
    return study


def order(args: argparse.Namespace, case: Any, announce: Any) -> dict[str, Any]:
    """Measure both orders, and print what was found."""
    from restshape_studies.bench.job import Job
    from restshape_studies.bench.order import study
    from restshape_studies.bench.prediction import Case

    if args.repeat < 1 or args.frames < 0 or args.frames == 1:
        what = f"{args.repeat} runs of {args.frames} frames measure nothing"
        raise UserError(what, "--repeat, --frames", "at least 1 run, at least 2 frames")
    job = Job(str(case.scene), str(case.edits), args.policy, tuple(args.set), tuple(args.petsc), args.frames or None)
    found = study(Case(case.name, job), args.repeat, announce)
    print_order(case.name, found, args.policy)
    return found


def print_order(name: str, found: dict[str, Any], policy: str) -> None:
    """Print the table of both orders."""
    frames = found["orders"]["1"]["frames"]
    title = f"{name}: {frames} frames, policy {policy}; counts without the first frame"
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
