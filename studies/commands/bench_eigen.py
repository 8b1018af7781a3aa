"""The study `restshape bench eigen`: eigensolvers on the same frames."""

import argparse
from typing import Any

from restshape_studies.bench.turns import Announce, Case
from restshape_studies.commands.bench_kind import Kind, job_of, unchecked

from restshape.cli.options import print_table

INCLUDED = """\
included: the solve, from K and M as they are assembled to modes with residuals within the scene's tolerance; factors,
  substitutions (all in panels), and counts of eigenvalues, which restshape alone makes
not included, as it is the same for all: K and M of the frame, observation, estimate
factors: Krylov-Schur makes one a frame, of single numbers or in blocks of a node; restshape makes one where counted
  work asks for it, and GD, JD and LOBPCG have one made when restshape does, whose time is in theirs
starts: the last modes, or their sum (Krylov-Schur); of three frames where it says so, as for restshape"""


def measure(args: argparse.Namespace, case: Case, announce: Announce) -> dict[str, Any]:
    """A record for each solver."""
    from restshape_studies.bench.job import run
    from restshape_studies.bench.turns import found_of

    announce(f"{case.name}: eigensolvers")
    job = job_of(args, case, "auto", measure="eigen")
    return found_of(run(job), job)


def show(args: argparse.Namespace, name: str, found: dict[str, Any]) -> None:
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
    rivals = [entry["ms"] for solver, entry in found["solvers"].items() if solver != "restshape" and entry["ms"]]
    own = found["solvers"]["restshape"]["ms"]
    if rivals and own:
        print(f"SLEPc's fastest method takes {min(rivals) / own:.1f} times as long.")
    print(INCLUDED)


def _number(value: float | None, form: str) -> str:
    return "-" if value is None else format(value, form)


KINDS = (
    Kind(
        "eigen",
        "our eigensolver beside SLEPc's, on the modes of the same frames",
        unchecked,
        unchecked,
        measure,
        show,
        times="eigensolvers alone on the same matrices: no mesh, no assembly, no quantities, no estimates",
    ),
)
