"""The studies of `restshape bench` that have to do with the design derivative: its use and its exactness."""

import argparse
from pathlib import Path
from typing import Any

from restshape.cli.options import print_table
from restshape.errors import UserError
from restshape.policy import POLICIES

EXACT = "solve.tolerance=1e-12"
"""Derivatives by differences are only as good as the solves."""


def arguments(studies: Any) -> list[argparse.ArgumentParser]:
    """Declare the studies; returns their parsers."""
    predict = studies.add_parser(
        "predict", help="predicted frames: how many a second, and how far from the solved ones"
    )
    derivative = studies.add_parser(
        "derivative", help="the derivative by dual numbers beside differences over their step"
    )
    for study in (predict, derivative):
        study.add_argument("scene", metavar="SCENE", type=Path, help="scene file")
        study.add_argument(
            "--edits", type=Path, metavar="FILE", help="edit script (default: the one that names the scene)"
        )
    predict.add_argument("--policy", choices=list(POLICIES), default="auto", help="default: %(default)s")
    predict.add_argument(
        "--frames",
        type=int,
        default=0,
        metavar="N",
        help="first N frames of the script, 0 for all (default: %(default)s)",
    )
    predict.add_argument("--repeat", type=int, default=3, metavar="R", help="timed runs (default: %(default)s)")
    return [predict, derivative]


def predict(args: argparse.Namespace, case: Any, announce: Any) -> dict[str, Any]:
    """Measure predicted frames, and print what was found."""
    from restshape_studies.bench.job import Job
    from restshape_studies.bench.prediction import Case, study

    if args.repeat < 1 or args.frames < 0:
        raise UserError(
            f"{args.repeat} runs of {args.frames} frames measure nothing", "--repeat, --frames", "leave them out"
        )
    job = Job(str(case.scene), str(case.edits), args.policy, tuple(args.set), tuple(args.petsc), args.frames or None)
    found = study(Case(case.name, job), args.repeat, announce)
    print_prediction(case.name, found)
    return found


def print_prediction(name: str, found: dict[str, Any]) -> None:
    """Print the tables of predicted frames."""
    print(
        f"{name}: {found['elements']} elements, {found['unknowns']} unknowns; "
        f"{found['predicted']} of {found['frames']} frames predicted from {found['anchors']} solved ones"
    )
    fps, ms = found["fps"], found["ms"]
    heads = ("the same frames", "frames a second", "p50 [ms]", "iterations of the whole replay")
    rows = [(key, f"{fps[key]:,.0f}", f"{ms[key]:.3f}", found["iterations"][key]) for key in fps]
    print_table("", heads, rows, right=heads[1:])
    stages = ", ".join(f"{key} {value:.3f}" for key, value in found["stages"].items())
    print(f"of a predicted frame [ms]: {stages}")
    parts = list(found["at"])
    heads = ("largest error, relative", *(f"up to {100 * float(part):.0f} % of the way" for part in parts))
    rows = [(found["of"], *(f"{found['at'][part]:.2e}" for part in parts))]
    way = found["way"]
    for quantity, errors in found["quantities"].items():
        cells = [
            max((abs(e) for w, e in zip(way, errors) if w <= float(part) * max(way)), default=0.0) for part in parts
        ]
        rows.append((quantity, *(f"{cell:.2e}" for cell in cells)))
    print_table("against the solved answer", heads, rows, right=heads[1:])


def derivative(args: argparse.Namespace, case: Any, announce: Any) -> dict[str, Any]:
    """Measure differences from the derivative, and print them."""
    from restshape_studies.bench.job import Job, run
    from restshape_studies.bench.prediction import Case, checked_found

    announce(f"{case.name}: derivatives")
    job = Job(str(case.scene), str(case.edits), "refactor", (*args.set, EXACT), tuple(args.petsc), measure="derivative")
    found = checked_found(run(job), Case(case.name, job))
    print_derivative(case.name, found)
    return found


def print_derivative(name: str, found: dict[str, Any]) -> None:
    """Print the table of a derivative."""
    ways = ("forward", "central", "semi")
    heads = ("step / size", "full solves (5.13)", "full solves, central", "semi-analytic (5.14)")
    rows = [
        (f"{step:.1e}", *("-" if found[way][i] is None else f"{found[way][i]:.1e}" for way in ways))
        for i, step in enumerate(found["steps"])
    ]
    title = f"{name}: distance from the derivative by dual numbers, relative; {found['unknowns']} unknowns"
    print_table(title, heads, rows, right=heads)
    times = ", ".join(f"{way} {ms:.2f}" for way, ms in found["ms"].items())
    print(f"one derivative takes [ms], with its factor at hand: {times}")
