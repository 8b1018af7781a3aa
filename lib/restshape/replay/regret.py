"""How much more a replay costs than the best policy, and than the best schedule of refreshes, by counted work."""

from dataclasses import replace
from typing import TypedDict

from petsc4py import PETSc

from restshape.algebra.counted_work import EVENTS, counted_seconds
from restshape.algebra.linear import LinearSolver
from restshape.algebra.stages import LOGGED, log_stage
from restshape.analysis.row_values import whole
from restshape.errors import UserError
from restshape.policy import POLICIES, policy
from restshape.replay import hindsight
from restshape.replay.event_counts import EventCounts
from restshape.replay.loop import Replay
from restshape.replay.request import Request


class Work(TypedDict):
    """Counted work of the linear solves of a replay: seconds by the calibration, iterations and factors."""

    seconds: float
    iterations: int
    factors: int


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


def measure(request: Request) -> Regret:
    """Counted work of linear solves under each policy, and of `auto` beside the best schedule in hindsight.

    Args:
        request: of a steady analysis or one in time; its policy is not looked at.

    Raises:
        UserError: the analysis has no linear solver whose preconditioner is kept.
    """
    begin_log()
    found = {name: _counted(_of(request, name)) for name in POLICIES}
    best = min(found, key=lambda name: found[name]["seconds"])
    replay = _of(request, "auto")
    schedule = hindsight.measure(replay, _solver(replay))
    least = found[best]["seconds"]
    return {
        "policies": found,
        "best": best,
        "over_policy": found["auto"]["seconds"] / least if least else 1.0,
        "hindsight": schedule,
        "over_schedule": schedule["ratio"],
    }


def _of(request: Request, name: str) -> Replay:
    """A replay under a policy, with nothing beside its frames."""
    made = Replay(replace(request, policy=policy(name)), PETSc.COMM_WORLD)
    made.errors.estimating = made.measuring = made.errors.jumps.wanted = False
    return made


def _solver(replay: Replay) -> LinearSolver:
    """The solver whose preconditioner the replay keeps."""
    solver = getattr(replay.analysis, "solver", None)
    if not isinstance(solver, LinearSolver):
        raise UserError(
            "there is no linear solver whose preconditioner is kept",
            str(replay.session.scene.path),
            "take a scene of a solid, in motion or not, or of heat",
        )
    return solver


def _counted(replay: Replay) -> Work:
    """Seconds by the calibration, iterations and factors of a replay."""
    counts, solver = EventCounts(EVENTS), _solver(replay)
    counts.since_last()
    seconds, iterations, factors = 0.0, 0, 0
    for row in replay.frames():
        events = counts.since_last()
        seconds += counted_seconds(events, whole(row, "iterations"), solver)
        iterations += whole(row, "iterations")
        factors += events["MatCholFctrNum"] + events["MatLUFactorNum"]
    return {"seconds": seconds, "iterations": iterations, "factors": factors}


def begin_log() -> None:
    """Let PETSc count; the events of all its parts are known by their names then."""
    PETSc.Log.begin()
    PETSc.KSP().create(PETSc.COMM_SELF).destroy()
    for name in LOGGED:
        log_stage(name)
