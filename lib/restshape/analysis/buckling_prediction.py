"""Load factors of the frames of a drag to first order in the hand, without a solve."""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol

import numpy as np

from restshape.algebra.eigen import EigenReport
from restshape.analysis.buckling_comparison import load_factors_of
from restshape.analysis.buckling_matrices import products
from restshape.analysis.correction import correction, largest_values, preconditioner
from restshape.analysis.frequencies import largest_difference
from restshape.analysis.steady import SteadyAnalysis
from restshape.fem.problem import PrestressedProblem
from restshape.sensitivity.load_factor_derivative import SolvedBuckling, buckling_derivative


class Buckling(SolvedBuckling, Protocol):
    """What a prediction needs of an analysis of buckling.

    Attributes:
        prebuckling: finds the equilibrium.
    """

    prebuckling: SteadyAnalysis[PrestressedProblem]


class BucklingPrediction:
    """The `analysis.analysis.Predictor` of load factors.

    Its values are (2 n + k k,): the displacement, and a matrix whose eigenvalues are the load factors.

    Args:
        analysis: whose state it reads and replaces.

    Source: docs/theory/buckling.md.
    """

    def __init__(self, analysis: Buckling) -> None:
        self.analysis = analysis

    def derivative(self, motion: np.ndarray, tolerance: float) -> np.ndarray:
        """Derivatives (2, 2 n + k k) of `values`; arguments as in `buckling_derivative`."""
        return buckling_derivative(self.analysis, motion, tolerance)

    def values(self) -> np.ndarray:
        """What is predicted, at the last solution or prediction."""
        state = self.analysis.state
        return np.concatenate([state.prebuckling.x.ravel(), np.diag(state.modes.load_factors).ravel()])

    def set_values(self, values: np.ndarray) -> None:
        """Take predicted values for those of the mesh as it lies now; modes stay those of the last solution."""
        analysis, state = self.analysis, self.analysis.state
        n = state.prebuckling.x.size
        analysis.prebuckling.set_values(values[:n].reshape(state.prebuckling.x.shape))
        count = int(np.sqrt(len(values) - n))
        small = values[n:].reshape(count, count)
        # Beyond where the line meets 0 it means nothing.
        load_factors = np.maximum(0.0, np.linalg.eigvalsh(0.5 * (small + small.T)))
        analysis.state = replace(
            state,
            prebuckling=analysis.prebuckling.state,
            modes=replace(state.modes, load_factors=load_factors),
            predicted=True,
            report=EigenReport(0, False, state.report.age, ""),
        )

    @property
    def prediction(self) -> np.ndarray | None:
        """The predicted load factors; None where there are none."""
        state = self.analysis.state
        return state.modes.load_factors if state.predicted else None

    def error(self, predicted: np.ndarray) -> float:
        """The largest relative difference of predicted load factors (k,) from the solved ones of the same rank."""
        return largest_difference(predicted, self.analysis.state.modes.load_factors)

    def quantity_distances(self) -> dict[str, float]:
        """None: all of them are eigenvalues, whose distance `distance` is."""
        return {}

    def compare_cold(self) -> float:
        """The largest relative difference of the predicted load factors from those of a cold solve."""
        state = self.analysis.state
        if not len(state.modes.load_factors):
            return float("nan")
        return largest_difference(
            state.modes.load_factors, load_factors_of(state, self.analysis.prebuckling.cold_system())
        )

    def distance(self) -> float:
        """About the largest relative difference of the predicted load factors from those of the same mesh.

        By a correction of displacement and modes with the kept preconditioner.
        """
        state, solver = self.analysis.state, self.analysis.prebuckling.solver
        problem, rows, x = state.prebuckling.problem, state.prebuckling.system.rows, state.prebuckling.x
        u, modes = x + correction(problem, x, solver, rows), state.modes.vectors
        stiff, loaded = products(problem, modes, u, state.sign)
        values = np.einsum("ki,ki->k", modes, loaded) / np.einsum("ki,ki->k", modes, stiff)
        lacking = loaded - values[:, None] * stiff
        basis = np.concatenate([modes, list(map(preconditioner(solver, rows), lacking))])
        stiff, loaded = products(problem, basis, u, state.sign)
        found = largest_values(basis @ loaded.T, basis @ stiff.T, len(state.modes.load_factors))
        return largest_difference(state.modes.load_factors, np.sort(1.0 / found[found > 0.0]))
