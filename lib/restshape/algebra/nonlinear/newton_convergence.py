"""When a run of Newton's method has converged, and when it never will."""

import math
from collections.abc import Callable
from dataclasses import dataclass

from petsc4py import PETSc

Reason = PETSc.SNES.ConvergedReason
MOST_STEPS = 15
"""Steps at full length after which the equations are better approached in steps of load."""
MOST_SEARCHED = 60
"""Steps with a line search."""
STALLED = 0.5
"""A step near rounding that leaves more than this part of the residual has met it."""
GROWTH = 1e4
"""A residual that grows by more, from the first one or from the load, will not come back. (The first step of a slender
body stretches it, for rotations are linear in it: its residual grows by the square of length over thickness.)"""
INDEFINITE = "the tangent stiffness is not positive definite: such an equilibrium is unstable"
WORDS = {
    Reason.DIVERGED_FNORM_NAN: "the residual is no number",
    Reason.DIVERGED_DTOL: "the residual grows without bound",
    Reason.DIVERGED_MAX_IT: "Newton's method does not come to an end",
    Reason.DIVERGED_LINE_SEARCH: "no step makes the energy smaller",
    Reason.DIVERGED_LINEAR_SOLVE: "the linear solve fails",
}


@dataclass(frozen=True)
class Outcome:
    """How a run of Newton's method ended.

    Args:
        converged: the residual is small enough.
        newton: steps taken.
        iterations: of the linear solver.
        refreshed: a preconditioner was made.
        monotone: no step has made the residual larger.
        why: it did not converge, for people.
        norm: of the last residual.
    """

    converged: bool
    newton: int
    iterations: int
    refreshed: bool
    monotone: bool
    why: str = ""
    norm: float = 0.0

    def after(self, other: "Outcome") -> "Outcome":
        """This run as the last one after another."""
        return Outcome(
            self.converged,
            self.newton + other.newton,
            self.iterations + other.iterations,
            self.refreshed or other.refreshed,
            self.monotone,
            self.why,
            self.norm,
        )


class ConvergenceTest:
    """Looks at the norms of the residuals of one run.

    Args:
        goal: norm at which it ends.
        scale: norm of the load, against which residuals are large.
        searched: with a line search.
        rounding: times the largest unknown, the norm below which a residual that steps do not lower is rounding.

    Attributes:
        steps: taken; last: the norm after them; monotone: no step has made it larger.
    """

    def __init__(self, goal: float, scale: float, searched: bool, rounding: float) -> None:
        self.goal, self.scale, self.searched, self.rounding = goal, scale, searched, rounding
        self.steps, self.first, self.last, self.monotone = 0, 0.0, 0.0, True

    def stalled(self, norm: float, largest: Callable[[], float]) -> bool:
        """Whether a step has left a residual that is rounding; `largest` gives the size of the largest unknown."""
        return norm > STALLED * self.last and norm <= self.rounding * largest()

    def reason(self, steps: int, norm: float, stalled: bool) -> int:
        """PETSc's reason to end after so many steps, 0 to go on."""
        if steps == 0:
            self.first = norm
        elif norm > self.last:
            self.monotone = False
        self.steps, self.last = steps, norm
        if norm <= self.goal or stalled:
            return Reason.CONVERGED_FNORM_ABS
        if not math.isfinite(norm):
            return Reason.DIVERGED_FNORM_NAN
        if self.searched:
            return Reason.ITERATING if steps < MOST_SEARCHED else Reason.DIVERGED_MAX_IT
        if norm > GROWTH * max(self.first, self.scale):
            return Reason.DIVERGED_DTOL
        return Reason.ITERATING if steps < MOST_STEPS else Reason.DIVERGED_MAX_IT
