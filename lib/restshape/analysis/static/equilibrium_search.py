"""The search for one solution of a nonlinear problem: by Newton's method, in steps of load where it must."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from restshape.algebra.nonlinear.newton import Newton
from restshape.algebra.nonlinear.newton_convergence import INDEFINITE, Outcome
from restshape.analysis.static.load_stepping import LoadPath, step_load
from restshape.analysis.static.residual_equations import ResidualEquations
from restshape.errors import ReplayProblem
from restshape.fem.problem import SteadyProblem
from restshape.fem.residuals import internal_norm

SCALE_SLACK = 1.1
"""A residual is measured against internal forces that are known up to this factor."""
ROUND_OFF = 1e-13
"""A residual below this share of the forces is rounding, as where supports only carry the body somewhere else."""
ROUGH = 1e-3
"""Tolerance of the states between steps of load."""
NEAR = 2
"""Newton's steps from a guess so near that the equilibrium is believed to be stable as the one before."""


def rounding(problem: SteadyProblem) -> float:
    """Residual a unit of the unknowns below which one that steps do not lower any more is rounding."""
    return ROUND_OFF * problem.stiffest


def least_scale(problem: SteadyProblem, x: np.ndarray, tolerance: float) -> float:
    """What a residual at x (n, f) is measured against at least.

    0, but where supports move a body: it may bear no load, and what it bears may be rounding.
    """
    return rounding(problem) / tolerance * float(np.abs(x).max(initial=0.0)) if problem.boundary.nonzero else 0.0


class EquilibriumSearch:
    """Finds the solution of a frame.

    Newton's method starts at a guess. Where that fails, the force that the last state lacks on the new shape is put on
    as a load that keeps it, and taken away in steps; then the same from rest, where these steps are those of the load.
    Where the last state is unstable under the load that keeps it, rest comes first.
    A solution counts if the problem has no objection to it and, unless the guess was near, if the tangent is positive
    definite.

    Args:
        equations: on the shape of the frame.
        newton: solves them.
        goal: gives the residual over its scale to aim at with the preconditioner as it is; tolerance: to meet.
        load_steps: that are tried at most.

    Attributes:
        scale: what residuals are measured against.
        tested: a factor of the tangent has shown whether the solution is stable.

    Source: docs/theory/solids.md.
    """

    def __init__(
        self, equations: ResidualEquations, newton: Newton, goal: Callable[[], float], tolerance: float, load_steps: int
    ) -> None:
        self.equations, self.newton, self.problem = equations, newton, equations.problem
        self.goal, self.tolerance, self.load_steps = goal, tolerance, load_steps
        self.load = float(np.linalg.norm(equations.load()))
        self.scale = self.load
        self.tested = False

    def find(self, guess: np.ndarray, start: np.ndarray, near: bool) -> tuple[Outcome, np.ndarray]:
        """The solution (n, f) near a guess, by steps of load where Newton's method does not reach it.

        Args:
            guess: (n, f).
            start: (n, f) the last state.
            near: the guess may be believed to be close to it.

        Raises:
            ReplayProblem: none is found.
        """
        x = guess.copy()
        self.problem.boundary.apply(x)
        outcome, problem = self._attempt(x, near=near)
        if not problem:
            return outcome, x
        far = ""
        for begin in self._beginnings(start):
            found = self._stepped(begin, outcome)
            outcome = found.outcome
            if found.reached == 1.0:
                return outcome, found.x
            # Only from rest steps are parts of the load.
            if not begin.any():
                far = f"no equilibrium found beyond {100 * found.reached:.3g} % of the load: {found.why}"
        raise ReplayProblem(far)

    def _beginnings(self, start: np.ndarray) -> list[np.ndarray]:
        """States (n, f) that steps of load begin at, the most promising one first: the last state, and rest.

        A last state whose tangent on the new shape is not positive definite is an unstable equilibrium under the load
        that keeps it, so that no short step from it is one to a stable one.
        """
        rest = np.zeros_like(start)
        if not start.any():
            return [rest]
        return [start, rest] if self.newton.definite(start) else [rest, start]

    def _stepped(self, start: np.ndarray, before: Outcome) -> LoadPath:
        """Load steps to this frame's solution from a state (n, f), after other runs of Newton's method."""
        boundary, equations, from_zero = self.problem.boundary, self.equations, not start.any()
        constrained, prescribed = boundary.constrained, boundary.values.ravel()

        def put_on(x: np.ndarray, part: float) -> None:
            boundary_values = (1.0 - part) * start.ravel() + part * prescribed
            x.ravel()[constrained] = boundary_values[constrained]
            if from_zero and equations.part != part:
                equations.part = part

        try:
            equations.part = 0.0 if from_zero else 1.0
            lacking = equations.full_residual(start)
            return step_load(self._attempt, start, lacking, put_on, before, self.load_steps)
        finally:
            equations.part = 1.0

    def _attempt(
        self, x: np.ndarray, added: np.ndarray | None = None, searched: bool = False, near: bool = False
    ) -> tuple[Outcome, str]:
        """Newton's method from x (n, f), which is changed, under an added load: what came of it, and what is wrong.

        Near a stable equilibrium, one that takes few steps is believed to be stable.
        """
        total = None
        while True:
            self.scale = self._scale(x)
            goal = (self.goal() if added is None else ROUGH) * self.scale
            outcome = self.newton.solve(x, goal, self.scale, searched, added, rounding(self.problem))
            total = outcome if total is None else outcome.after(total)
            if not outcome.converged:
                return total, outcome.why
            if added is not None or self.scale <= SCALE_SLACK * self._scale(x) or not outcome.newton:
                return total, self._objection(x, near and total.monotone and total.newton <= NEAR)

    def _objection(self, x: np.ndarray, stable: bool) -> str:
        """What speaks against the solution x (n, f) that Newton's method has found."""
        problem = self.problem.objection(x)
        if problem or stable:
            return problem
        self.tested = True
        return "" if self.newton.definite(x) else INDEFINITE

    def _scale(self, x: np.ndarray) -> float:
        """What residuals are measured against: the load, and internal forces where supports move."""
        if not self.problem.boundary.nonzero:
            return self.load
        return max(self.load, internal_norm(self.problem, x), least_scale(self.problem, x, self.tolerance))
