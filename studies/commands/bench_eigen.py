"""The study `restshape bench eigen`: eigensolvers on the same frames."""

import argparse
from pathlib import Path
from typing import Any

from restshape.cli.options import print_table


def arguments(studies: Any) -> argparse.ArgumentParser:
    """Declare the study; returns its parser."""
    study = studies.add_parser("eigen", help="our eigensolver beside SLEPc's, on the modes of the same frames")
    study.add_argument("scene", metavar="SCENE", type=Path, help="scene file of a metallophone")
    study.add_argument("--edits", type=Path, metavar="FILE", help="edit script (default: the one that names the scene)")
    return study


def eigen(args: argparse.Namespace, case: Any, announce: Any) -> dict[str, Any]:
    """Let all solvers find the modes of each frame, and print what was found."""
    from restshape_studies.bench.job import Job, run
    from restshape_studies.bench.prediction import Case, checked_found

    announce(f"{case.name}: eigensolvers")
    job = Job(str(case.scene), str(case.edits), "auto", tuple(args.set), tuple(args.petsc), measure="eigen")
    found = checked_found(run(job), Case(case.name, job))
    print_eigen(case.name, found)
    return found


def print_eigen(name: str, found: dict[str, Any]) -> None:
    """Print the table of the solvers."""
    title = (
        f"{name}: {found['modes']} modes, {found['unknowns']} unknowns, {found['frames']} frames, all solvers on each"
    )
    heads = ("solver", "ms a frame", "p50 [ms]", "substitutions a frame", "largest residual")
    heads += ("largest error of f", "frames without an answer")
    rows = [
        (
            solver,
            *(_number(entry[key], form) for key, form in (("ms", ".2f"), ("p50", ".2f"), ("substitutions", ".1f"))),
            *(_number(entry[key], ".1e") for key in ("residual", "error")),
            entry["problems"],
        )
        for solver, entry in found["solvers"].items()
    ]
    print_table(title, heads, rows, right=heads[1:])


def _number(value: float | None, form: str) -> str:
    return "-" if value is None else format(value, form)
