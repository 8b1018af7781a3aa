"""How much more a replay costs than the best policy, and than the best schedule of refreshes, by counted work."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import TypedDict

from restshape.algebra.linear import LinearSolver
from restshape.algebra.linear_report import LinearReport
from restshape.algebra.reuse.counted_work import EVENTS, NUMERIC, counted_seconds
from restshape.algebra.stages import Stages
from restshape.analysis.row_values import whole
from restshape.errors import UserError
from restshape.interface.run import Run
from restshape.policy import POLICIES, policy
from restshape.replay.event_counts import EventCounts, begin_log
from restshape.replay.request import Request
from restshape.variation import hindsight

ENOUGH = 2.0
"""A policy that has cost so many times the cheapest so far is not the best, and its replay ends."""
LINEAR = "restshape linear"
"""Owner of the log stages of linear solves."""


class Work(TypedDict):
    """Counted work of the linear solves of a replay.

    Args:
        seconds: by the calibration.
        ended: frame after which the replay was ended, having cost `ENOUGH` times the cheapest; None: it was not.
    """

    seconds: float
    iterations: int
    factors: int
    ended: int | None


class Regret(TypedDict):
    """What a replay costs beside the best.

    Args:
        policies: by name; best: the cheapest one.
        over_policy, over_schedule: work of `auto` over that of the best policy, and over that of the best schedule.
        hindsight: schedules of refreshes.
    """

    policies: dict[str, Work]
    best: str
    over_policy: float
    hindsight: hindsight.Beside
    over_schedule: float


def measure(request: Request, on_frame: Callable[[], None] = lambda: None) -> Regret:
    """Counted work of linear solves under each policy, and of `auto` beside the best schedule in hindsight.

    Args:
        request: of a steady analysis or one in time; its policy is not looked at.
        on_frame: called after each frame of each policy.

    Raises:
        UserError: the analysis has no linear solver whose preconditioner is kept.
    """
    begin_log()
    run = _of(request, "auto")
    watch = hindsight.Watch(_solver(run))
    found = {"auto": _counted(run, on_frame, watch)}
    schedule = watch.found()
    for name in ("refactor", "rebuild", "thesis"):
        least = min(one["seconds"] for one in found.values())
        found[name] = _counted(_of(request, name), on_frame, most=ENOUGH * least or math.inf)
    best = min(found, key=lambda name: found[name]["seconds"])
    least = found[best]["seconds"]
    return {
        "policies": {name: found[name] for name in POLICIES},
        "best": best,
        "over_policy": found["auto"]["seconds"] / least if least else 1.0,
        "hindsight": schedule,
        "over_schedule": schedule["ratio"],
    }


def _of(request: Request, name: str) -> Run:
    """A run under a policy, with nothing beside its frames."""
    return Run(replace(request, policy=policy(name), measured="nothing"), summed=False)


def _solver(run: Run) -> LinearSolver:
    """The solver whose preconditioner the run keeps."""
    solver = getattr(run.replay.analysis, "solver", None)
    if not isinstance(solver, LinearSolver):
        raise UserError(
            "there is no linear solver whose preconditioner is kept",
            str(run.replay.session.scene.path),
            "take a scene of a solid, in motion or not, or of heat",
        )
    return solver


def _counted(
    run: Run, on_frame: Callable[[], None], watch: hindsight.Watch | None = None, most: float = math.inf
) -> Work:
    """Counted work of a run, which may be watched, until it has cost so many seconds by the calibration."""
    solver, found, made = _solver(run), Work(seconds=0.0, iterations=0, factors=0, ended=None), 0
    # Modes beside a motion have factors and iterations of their own, in the stages of the replay.
    solver.stages = Stages(LINEAR)
    counts, watched = EventCounts(EVENTS, LINEAR), solver.on_solved

    def note(report: LinearReport | None) -> None:
        nonlocal made
        made += report.iterations if report else 0
        if watched:
            watched(report)

    solver.on_solved = note
    counts.since_last()
    for row in run.rows():
        events = counts.since_last()
        found["seconds"] += counted_seconds(events, made, solver)
        found["iterations"] += made
        found["factors"] += sum(events[name] for name in NUMERIC)
        made = 0
        if watch:
            watch.settle()
        on_frame()
        if run.replay.comm.tompi4py().bcast(found["seconds"] > most):
            found["ended"] = whole(row, "index")
            break
    return found
