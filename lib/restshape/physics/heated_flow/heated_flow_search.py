"""The search for a steady flow with heat, whose temperatures answer more strongly than residuals show."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from restshape.algebra.nonlinear.newton import Newton
from restshape.algebra.nonlinear.newton_convergence import Outcome
from restshape.analysis.static.residual_equations import ResidualEquations
from restshape.physics.flow.flow_search import FlowSearch
from restshape.physics.heated_flow.heated_flow import HeatedFlow

ROUNDS = 2
"""Times that the search goes on at most: the second one where the first factor was too old to tell how far."""
SHARE = 0.5
"""Of the tolerance, that fields may lack: a factor of some frames ago shows a third of it."""


class HeatedFlowSearch(FlowSearch):
    """As `FlowSearch`; goes on where a kept factor shows that a field lacks more than the tolerance.

    What advection carries keeps the error that it has had upstream: temperatures of water at cells of large Peclet
    numbers are off by up to a hundred times the residual.

    Args:
        problem, equations, newton, goal: as of `FlowSearch`.
        tolerance: of each field, over its range.
        missing: gives about what unknowns (n, 4) lack; None where no complete factor is kept.

    Source: docs/theory/flow.md.
    """

    def __init__(
        self,
        problem: HeatedFlow,
        equations: ResidualEquations,
        newton: Newton,
        goal: Callable[[], float],
        tolerance: float,
        missing: Callable[[np.ndarray], np.ndarray | None],
    ) -> None:
        super().__init__(problem, equations, newton, lambda: min(goal(), self._aim))
        self._heated, self._tolerance, self._missing, self._aim = problem, SHARE * tolerance, missing, np.inf

    def find(self, guess: np.ndarray, start: np.ndarray, _: bool = False) -> tuple[Outcome, np.ndarray]:
        """The steady flow (n, 4) near a guess (n, 4); as of `FlowSearch`."""
        self._aim = np.inf
        outcome, x = super().find(guess, start)
        for _round in range(ROUNDS):
            beyond = self._lacking(x) / self._tolerance
            if beyond <= 1.0:
                break
            self._aim = SHARE * outcome.norm / (beyond * self.scale)
            nearer = x.copy()
            more = self._together(nearer)
            if not more.converged:
                # Rounding may be in the way: the flow is within the tolerance of residuals.
                break
            outcome, x = more.after(outcome), nearer
        return outcome, x

    def _together(self, x: np.ndarray) -> Outcome:
        """The flow and its heat in one system from x (n, 4), which is changed."""
        return super()._solve(x)

    def _lacking(self, x: np.ndarray) -> float:
        """About how far the worst field of x (n, 4) is from the flow, over its range; 0 where that is not known."""
        missing, worst, start = self._missing(x), 0.0, 0
        if missing is None or not np.isfinite(missing).all():
            return 0.0
        for columns, usual in self._heated.usual(x):
            own = slice(start, start + columns)
            worst = max(worst, float(np.abs(missing[:, own]).max()) / max(float(np.ptp(x[:, own])), usual))
            start += columns
        return worst
