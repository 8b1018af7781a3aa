"""Predictions of steady solutions by their design derivative."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np

from restshape.algebra.work_counts import linear_counts, linear_seconds, pass_seconds
from restshape.analysis.correction import correction
from restshape.errors import ReplayProblem
from restshape.fem.error_estimate import RecoveryEstimate
from restshape.fem.observer import Observer
from restshape.fem.problem import SteadyProblem
from restshape.fem.residuals import residual_norm, unconstrained_residual
from restshape.sensitivity.steady_derivative import design_derivative

if TYPE_CHECKING:
    from restshape.algebra.linear import LinearSolver
    from restshape.analysis.analysis import Alignment, Context

INEXACT = 1e-2
"""Residual of a Newton step over that of the prediction."""
GROWS = 10.0
"""Times that a step may make the residual of a prediction larger."""
EXPECTED = 4
"""Iterations of a first step."""
RESIDUALS = 3
"""Passes over all elements of a step besides those of its iterations."""
WORTH = 30.0
"""Tolerances by which a step must have changed the unknowns for another one to pay: it leaves about a hundredth."""


class FrameSystem(Protocol):
    """What a frame is solved with; `rows` are this rank's of all n f unknowns."""

    @property
    def rows(self) -> slice: ...


class Predictable(Protocol):
    """A state that knows whether it is a prediction, and what evaluates its quantities."""

    @property
    def predicted(self) -> bool: ...
    @property
    def observer(self) -> Observer: ...
    @property
    def system(self) -> FrameSystem: ...


class Steady(Protocol):
    """What is predicted: an analysis whose state has unknowns `x` (n, f), a `problem`, and reports a prediction."""

    @property
    def state(self) -> Predictable: ...
    @property
    def problem(self) -> SteadyProblem: ...
    @property
    def x(self) -> np.ndarray: ...
    @property
    def tolerance(self) -> float: ...
    @property
    def error_estimate(self) -> RecoveryEstimate | None: ...
    @property
    def context(self) -> Context: ...
    @property
    def solver(self) -> LinearSolver: ...

    def observe(self) -> dict[str, float]:
        """The quantities of interest at the unknowns."""

    def missing(self) -> np.ndarray | None:
        """About what predicted unknowns (n, f) lack to be the solution; None where that is not known."""

    def cold_unknowns(self) -> np.ndarray:
        """The unknowns (n, f) of a cold solve on the space as it lies."""

    def linear_solve(self, rhs: np.ndarray, tolerance: float) -> np.ndarray:
        """s (n, f) with (dR/dx) s = rhs (n, f) at free unknowns, 0 at prescribed ones, by the kept preconditioner."""

    def set_values(self, x: np.ndarray) -> None:
        """Take unknowns x (n, f) for those of the space as it lies now, without a solve."""


class SteadyPredictor:
    """An `analysis.Predictor` of the unknowns.

    Args:
        analysis: that is predicted.
    """

    transferable = True

    def __init__(self, analysis: Steady) -> None:
        self.analysis = analysis
        self._applied = EXPECTED

    def derivative(self, motion: np.ndarray, tolerance: float) -> np.ndarray:
        """Derivatives (2, n, f) of the unknowns along the hand's two directions; see `analysis.Predictor`."""
        return design_derivative(self.analysis, motion, tolerance)

    def values(self) -> np.ndarray:
        """The unknowns (n, f) at the last solution or prediction."""
        return self.analysis.x

    def set_values(self, values: np.ndarray) -> None:
        """Take predicted unknowns (n, f) for those of the space as it lies now, without a solve."""
        self.analysis.set_values(values)

    @property
    def prediction(self) -> np.ndarray | None:
        """The prediction that the analysis holds; None where it holds a solution."""
        return self.analysis.x if self.analysis.state.predicted else None

    def error(self, predicted: np.ndarray) -> float:
        """The relative distance of predicted unknowns (n, f) on this space from the solution, in the energy norm.

        Not a number where the problem has no estimate, which knows that norm.
        """
        return self._distance(predicted, self.analysis.x)

    def compare_cold(self) -> float:
        """The distance of the predicted unknowns from those of a cold solve on the space as it lies; as `error`."""
        return self._distance(self.analysis.x, self.analysis.cold_unknowns())

    def quantity_distances(self) -> dict[str, float]:
        """Estimated distances of the quantities of the prediction that the analysis holds from those of the solution.

        They are the changes of quantities by what the prediction lacks, each with all that it depends on.
        """
        missing = self.analysis.missing()
        if missing is None:
            return {}
        shown, mended = self.analysis.observe(), self.analysis.state.observer(self.analysis.x + missing)
        return {name: abs(mended[name] - value) for name, value in shown.items() if name in mended}

    def counted(self) -> tuple[int, ...]:
        """Counts of all linear solves so far."""
        return linear_counts(self.analysis.solver)

    def seconds_since(self, before: tuple[int, ...]) -> float:
        """Seconds by the calibration of the solves since there were these counts."""
        return linear_seconds(self.analysis.solver, before, self.analysis.context.calibration)

    def step_seconds(self) -> float:
        """Seconds that `step` costs, with as many iterations as the last one had."""
        kept, known = self.analysis.solver.kept, self.analysis.context.calibration
        if not kept.ready:
            return np.inf
        each = kept.price().iteration + pass_seconds(kept.size.nonzeros, known)
        return self._applied * each + RESIDUALS * pass_seconds(kept.size.nonzeros, known)

    def step(self) -> bool:
        """Take one of Newton's steps, inexact, on the kept preconditioner; whether another one pays."""
        analysis, before = self.analysis, self.analysis.x
        missing = self._newton_step() if not analysis.problem.linear else self._conjugate_steps()
        if missing is None or not np.isfinite(missing).all():
            return False
        after = before + missing
        analysis.set_values(after)
        return float(np.linalg.norm(missing)) > WORTH * analysis.tolerance * float(np.linalg.norm(after))

    def _conjugate_steps(self) -> np.ndarray:
        """What a prediction of a linear problem lacks (n, f), but for about a hundredth."""
        analysis, self._applied = self.analysis, 0
        return correction(analysis.problem, analysis.x, analysis.solver, analysis.state.system.rows, self._count)

    def _newton_step(self) -> np.ndarray | None:
        """A step (n, f) with the tangent of the prediction; None where there is none, or it leads away.

        Bodies that turn have a larger residual on the way: on the cantilever steps that must lower it end up to 3 %
        off, those that may raise it tenfold within 1e-4.
        """
        analysis, counted = self.analysis, self.counted()
        problem, x = analysis.problem, analysis.x
        rest = -unconstrained_residual(problem, x)
        problem.boundary.zero(rest)
        try:
            step = analysis.linear_solve(rest, INEXACT)
        except ReplayProblem:
            step = None
        self._applied = self.counted()[1] - counted[1]
        size = float(np.linalg.norm(rest))
        return step if step is not None and residual_norm(problem, x + step) < GROWS * size else None

    def _count(self) -> None:
        self._applied += 1

    def in_basis(self) -> np.ndarray:
        """As `values`: unknowns are those of nodes."""
        return self.values()

    def mixable(self) -> SteadyPredictor:
        """Itself."""
        return self

    def alignment(self, before: np.ndarray) -> Alignment:
        """The identity: unknowns are those of nodes."""
        return np.asarray

    def nodal_fields(self, rows: np.ndarray, nodes: int) -> np.ndarray | None:
        """The unknowns (count, n, f) themselves; None at seams and in mixed spaces, where they are of other nodes."""
        return rows if rows.shape[1] == nodes else None

    def with_nodal_fields(self, rows: np.ndarray, fields: np.ndarray) -> np.ndarray:
        """The fields (count, n, f) themselves."""
        return fields

    def set_mixed(self, values: np.ndarray) -> None:
        """As `set_values`."""
        self.set_values(values)

    def _distance(self, predicted: np.ndarray, exact: np.ndarray) -> float:
        estimate = self.analysis.error_estimate
        return float("nan") if estimate is None else estimate.distance(predicted, exact)
