"""Predictions of steady solutions by their design derivative."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from restshape.fem.error_estimate import RecoveryEstimate
from restshape.fem.observer import Observer
from restshape.fem.problem import SteadyProblem
from restshape.sensitivity.steady_derivative import design_derivative


class Predictable(Protocol):
    """A state that knows whether it is a prediction, and what evaluates its quantities."""

    @property
    def predicted(self) -> bool: ...
    @property
    def observer(self) -> Observer: ...


class Steady(Protocol):
    """What is predicted: an analysis whose state has unknowns `x` (n, f), a `problem`, and reports a prediction."""

    @property
    def state(self) -> Predictable: ...
    @property
    def problem(self) -> SteadyProblem: ...
    @property
    def x(self) -> np.ndarray: ...
    @property
    def error_estimate(self) -> RecoveryEstimate | None: ...

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

    def __init__(self, analysis: Steady) -> None:
        self.analysis = analysis

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

    def _distance(self, predicted: np.ndarray, exact: np.ndarray) -> float:
        estimate = self.analysis.error_estimate
        return float("nan") if estimate is None else estimate.distance(predicted, exact)
