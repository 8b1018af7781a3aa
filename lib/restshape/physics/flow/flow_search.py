"""The search for a flow: by Newton's method, from Picard's where it must, and from a more viscous fluid."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from restshape.algebra.nonlinear.newton import Newton
from restshape.algebra.nonlinear.newton_convergence import Outcome
from restshape.analysis.static.residual_equations import ResidualEquations
from restshape.errors import ReplayProblem
from restshape.physics.flow.incompressible_flow import IncompressibleFlow
from restshape.physics.flow.reynolds import characteristic_length, stream

SCALE_SLACK = 1.1
"""A residual is measured against forces that are known up to this factor."""
ROUGH = 1e-3
"""Tolerance on the way, and of the linear solves of Picard's method."""
PICARD = 20
"""Steps of Picard's method: each takes the velocity that advects from the one before."""
NEAR = (0.1, 0.01, 0.001)
"""Changes of the velocity in one of them, over the velocity, from which Newton's method goes on: a smaller one where it
failed from the one before."""
THICKER = (300.0, 100.0, 30.0, 10.0, 5.0, 2.5, 1.5, 1.0)
"""Viscosities over the fluid's through which a steady flow is followed where nothing else finds it."""


class FlowSearch:
    """Finds the flow of a frame, or of a time step.

    Args:
        problem: whose flow it is.
        equations: of it.
        newton: solves them.
        goal: gives the residual over its scale to aim at with the preconditioner as it is.

    Attributes:
        scale: what residuals are measured against.
        tested: whether a factor of the tangent shows that the solution is stable: none does.

    Source: docs/theory/flow.md.
    """

    tested = False

    def __init__(
        self, problem: IncompressibleFlow, equations: ResidualEquations, newton: Newton, goal: Callable[[], float]
    ) -> None:
        self.problem, self.equations, self.newton, self.goal = problem, equations, newton, goal
        self.scale = 0.0

    def find(self, guess: np.ndarray, start: np.ndarray, _: bool = False) -> tuple[Outcome, np.ndarray]:
        """The steady flow (n, 3) near a guess (n, 3); start (n, 3): the last one.

        Raises:
            ReplayProblem: none is found.
        """
        if self.problem.speed == 0.0:
            # What is left of an earlier flow is rounding, beside which every residual is large.
            guess = start = self.problem.start()
        outcome, x = self.near(guess, start)
        if not outcome.converged:
            outcome, x = self.thinned(outcome, self.problem.start())
        if not outcome.converged:
            raise ReplayProblem(
                f"no steady flow is found{self._reynolds()}: {outcome.why}; give [effects.flow] a time_step"
            )
        return outcome, x

    def near(self, guess: np.ndarray, start: np.ndarray) -> tuple[Outcome, np.ndarray]:
        """The flow (n, 3) from a guess (n, 3), else by Picard's method from a start (n, 3), and what came of it."""
        x, draws_in = guess.copy(), self.problem.draws_in(guess)
        if draws_in != self.problem.drawing_in:
            self._change(drawing_in=draws_in)
        outcome = self._solve(x)
        if not outcome.converged:
            outcome, x = self._nearer(start.copy(), outcome)
        return outcome, x

    def _nearer(self, x: np.ndarray, before: Outcome) -> tuple[Outcome, np.ndarray]:
        """The flow (n, 3) by Picard's method from x (n, 3), as near as Newton's method wants it, and what it took."""
        found = x
        for change in NEAR:
            outcome = self._picard(x, change)
            before, found = outcome.after(before), x.copy()
            before = self._solve(found).after(before)
            if before.converged or not outcome.converged or not self.problem.inertia:
                break
        return before, found

    def thinned(self, before: Outcome, start: np.ndarray) -> tuple[Outcome, np.ndarray]:
        """The flow from that of a fluid with a large viscosity, which is made smaller in steps.

        Args:
            before: what came of the search so far.
            start: (n, f) unknowns, from which the most viscous one is looked for.
        """
        x = start.copy()
        try:
            for factor in THICKER:
                self._change(thickening=factor)
                outcome, x = self.near(x, x)
                before = outcome.after(before)
                if not before.converged:
                    break
        finally:
            self._change(thickening=1.0)
        return before, x

    def _picard(self, x: np.ndarray, change: float) -> Outcome:
        """Picard's method from x (n, 3), which is changed, until a step changes the velocity by this part of it."""
        total = None
        try:
            for _ in range(PICARD if self.problem.inertia else 0):
                before = x[:, :2].copy()
                self._change(advecting=before if total is None else self._relaxed(before))
                outcome = self._solve(x, ROUGH)
                total = outcome if total is None else outcome.after(total)
                moved = np.linalg.norm(x[:, :2] - before)
                if not outcome.converged or moved <= change * np.linalg.norm(x[:, :2]):
                    break
        finally:
            self._change(advecting=None)
        return total or Outcome(True, 0, 0, False, True)

    def _relaxed(self, velocity: np.ndarray) -> np.ndarray:
        """The velocity (n, 2) that advects next: some of the last one, for what it carries drives it too."""
        part = self.problem.relaxation
        return velocity if part == 1.0 else part * velocity + (1.0 - part) * self.problem.advecting

    def _change(self, **values: object) -> None:
        """Change the equations, which stay those of the same unknowns."""
        for name, value in values.items():
            setattr(self.problem, name, value)
        self.equations.begin()

    def _solve(self, x: np.ndarray, tolerance: float = 0.0) -> Outcome:
        """Newton's method from x (n, 3), which is changed, to the residual of the goal, or a coarser one."""
        self.problem.boundary.apply(x)
        total = None
        while True:
            self.scale = self.problem.force_scale(x)
            goal = max(self.goal(), tolerance) * self.scale
            outcome = self.newton.solve(x, goal, self.scale, rounding=self.problem.rounding())
            total = outcome if total is None else outcome.after(total)
            if outcome.converged and not self.problem.drawing_in and self.problem.draws_in(x):
                self._change(drawing_in=True)
            elif not outcome.converged or not outcome.newton or self.scale <= SCALE_SLACK * self.problem.force_scale(x):
                return total

    def _reynolds(self) -> str:
        """The Reynolds number, for people."""
        problem = self.problem
        if not problem.inertia:
            return ""
        scene, outline = problem.scene, problem.space.outline
        length, words = characteristic_length(scene, outline, stream(scene, outline).along)
        number = problem.fluid.rho * problem.speed * length / problem.fluid.mu
        return f" at a Reynolds number of {number:.3g} ({words}{problem.speed_words})"
