"""The studies of `restshape bench` that have to do with the design derivative: its use and its exactness."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from restshape_studies.bench.turns import Announce, Case
from restshape_studies.commands.bench_kind import (
    FRAMES,
    Kind,
    add_frames,
    add_policy,
    add_repeat,
    check_runs,
    job_of,
    unchecked,
    unscripted,
)
from restshape_studies.commands.drape_tables import show_drape

from restshape.cli.options import print_table
from restshape.errors import UserError

if TYPE_CHECKING:
    from restshape.scene.edit_script import Script
    from restshape.scene.model import Scene

EXACT = "solve.tolerance=1e-12"
"""Derivatives by differences are only as good as the solves."""


def declare_prediction(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    add_policy(parser)
    add_frames(parser)
    add_repeat(parser)


def measure_prediction(args: argparse.Namespace, case: Case, announce: Announce) -> dict[str, Any]:
    """Pace and errors of predicted frames."""
    from restshape_studies.bench.prediction import study

    return study(case.name, job_of(args, case), args.repeat, announce)


def drags_the_shape(script: Script, scene: Scene) -> bool:
    """Whether a hand of a script takes hold of the shape, and not of bodies or supports alone."""
    beside = {*scene.raw.get("bodies", {}), *scene.raw.get("supports", {})}
    return any(event.do == "press" and event.on not in beside for event in script.events)


def draw_prediction(found: dict[str, Any], args: argparse.Namespace, path: Path) -> None:
    """Draw errors over the way of the hand."""
    from restshape_studies.pictures import design

    ((name, one),) = found.items()
    design.draw_prediction(name, one, path)


def show_prediction(args: argparse.Namespace, name: str, found: dict[str, Any]) -> None:
    """Print the tables of predicted frames."""
    print(
        f"{name}: {found['elements']} elements, {found['unknowns']} unknowns; "
        f"{found['predicted']} of {found['frames']} frames predicted from {found['anchors']} solved ones"
    )
    fps, ms = found["fps"], found["ms"]
    heads = ("the same frames", "frames a second", "p50 [ms]", "iterations of the whole replay")
    rows = [(key, f"{fps[key]:,.0f}", f"{ms[key]:.3f}", found["iterations"][key]) for key in fps]
    print_table("", heads, rows, right=heads[1:])
    session, ratios = found["session_s"], found["ratios"]
    heads = ("prediction against solves", "solved", "predicted", "times as fast")
    rows = [
        ("single predicted frames, mean [ms]", f"{1e3 / fps['solved']:.3f}", f"{1e3 / fps['predicted']:.3f}", "frames"),
        ("the whole session [s]", f"{session['solved']:.3f}", f"{session['predicted']:.3f}", "session"),
    ]
    print_table("", heads, [(*row[:3], f"{ratios[row[3]]:.2f}") for row in rows], right=heads[1:])
    stages = ", ".join(f"{key} {value:.3f}" for key, value in found["stages"].items())
    print(f"of a predicted frame [ms]: {stages}")
    show_ways(found["ways"])
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


def show_ways(ways: dict[str, Any]) -> None:
    """Print what none, one and several samples give in the frames of drags."""
    heads = (
        "frames of drags",
        "p50 [ms]",
        "session [s]",
        "predicted",
        "samples",
        "mean",
        "largest",
        "nodes [mm]",
        "energy",
        "lag [ms]",
    )
    rows = []
    for way, one in ways.items():
        times = [f"{one[key]:.3f}" if key in one else "" for key in ("ms", "session_s")]
        counts = [f"{one['predicted']} of {one['frames']}", str(one["samples"])] if "frames" in one else ["", ""]
        errors = [f"{one[key]:.1e}" if key in one else "" for key in ("mean", "max")]
        distance = f"{1e3 * one['distance']['max']:.2g}" if "distance" in one else ""
        energy = f"{one['energy']['max']:.1e}" if "energy" in one else ""
        lag = f"{one['lag_ms']['mean']:.0f}" if "lag_ms" in one else ""
        rows.append((way, *times, *counts, *errors, distance, energy, lag))
    print_table("ways of prediction against the solved answer", heads, rows, right=heads[1:])


def declare_derivative(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    by = 'of cloth: a number of the scene, such as material.cotton.E, or "hand" (default: the hand, and all numbers)'
    parser.add_argument("--by", action="append", default=[], metavar="KEY", help=by)
    parser.add_argument("--only-times", action="store_true", help="of cloth: times and residuals, without remainders")


def measure_derivative(args: argparse.Namespace, case: Case, announce: Announce) -> dict[str, Any]:
    """Differences from the derivative."""
    from restshape_studies.bench.drape_derivative import is_drape
    from restshape_studies.bench.job import run
    from restshape_studies.bench.turns import found_of

    from restshape.scene.load import load_scene

    announce(f"{case.name}: derivatives")
    # Drapes rest as exactly as rounding lets them.
    drape = is_drape(load_scene(case.scene, args.set))
    if not drape and case.edits is None:
        raise unscripted(case.scene)
    if not drape and (args.by or args.only_times):
        raise UserError("this is about cloth", "--by, --only-times", "leave it out, or name a scene of cloth")
    args.set = args.set if drape else [*args.set, EXACT]
    details = {"by": args.by, "only_times": args.only_times}
    job = job_of(args, case, "refactor", measure="derivative", details=details)
    return found_of(run(job), job)


def draw_derivative(found: dict[str, Any], args: argparse.Namespace, path: Path) -> None:
    """Draw the distances over the step of the differences."""
    from restshape_studies.pictures import design

    ((name, one),) = found.items()
    draw = design.draw_drape if one.get("drape") else design.draw_derivative
    draw(name, one, path)


def show_derivative(args: argparse.Namespace, name: str, found: dict[str, Any]) -> None:
    """Print the table of a derivative."""
    if found.get("drape"):
        show_drape(name, found)
        return
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


KINDS = (
    Kind(
        "predict",
        "predicted frames: how many a second, and how far from the solved ones",
        declare_prediction,
        check_runs,
        measure_prediction,
        show_prediction,
        picture="bench-predict.png",
        times=f"{FRAMES}; predicted frames have their estimated distance from the solution",
        draw=draw_prediction,
        fits=drags_the_shape,
    ),
    Kind(
        "derivative",
        "the derivative by dual numbers beside differences over their step",
        declare_derivative,
        unchecked,
        measure_derivative,
        show_derivative,
        scenes="either",
        picture="sensitivity-epsilon.png",
        times="one derivative at a solution, with its factor at hand",
        draw=draw_derivative,
    ),
)
