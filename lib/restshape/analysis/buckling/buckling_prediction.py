"""Load factors of the frames of a drag to first order in the hand, without a solve."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Protocol

import numpy as np

from restshape.algebra.eigenproblems.eigen import EigenReport
from restshape.algebra.work_counts import linear_counts, linear_seconds, pencil_counts, pencil_seconds
from restshape.analysis.buckling.buckling_comparison import load_factors_of
from restshape.analysis.buckling.buckling_matrices import products
from restshape.analysis.buckling.buckling_state import BucklingModes
from restshape.analysis.correction import KeptOperation, correction, largest_values
from restshape.analysis.modal.frequencies import largest_difference
from restshape.analysis.static.steady import SteadyAnalysis
from restshape.fem.problem import PrestressedProblem
from restshape.sensitivity.load_factor_derivative import SolvedBuckling, buckling_derivative, mixed_derivative
from restshape.sensitivity.mode_alignment import turning

if TYPE_CHECKING:
    from restshape.analysis.analysis import Alignment, Predictor


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

    transferable = True

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

    def counted(self) -> tuple[int, ...]:
        """Counts of all solves for displacements, factors and substitutions so far."""
        return *linear_counts(self.analysis.prebuckling.solver), *pencil_counts(self.analysis.solver.pencil)

    def seconds_since(self, before: tuple[int, ...]) -> float:
        """Seconds by the calibration of the work since there were these counts."""
        prebuckling, pencil = self.analysis.prebuckling, self.analysis.solver.pencil
        known, own = prebuckling.context.calibration, len(linear_counts(prebuckling.solver))
        linear = linear_seconds(prebuckling.solver, before[:own], known)
        return linear + pencil_seconds(pencil, before[own:], known)

    def step_seconds(self) -> float:
        """Infinite: there are no steps."""
        return np.inf

    def step(self) -> bool:
        """None is taken."""
        return False

    def in_basis(self) -> np.ndarray:
        """As `values`."""
        return self.values()

    def alignment(self, before: np.ndarray) -> Alignment | None:
        """None: `mixable` knows modes besides, which can be mixed."""

    def nodal_fields(self, rows: np.ndarray, nodes: int) -> np.ndarray | None:
        """None: `mixable` knows modes besides, which are mixed with their displacement."""
        return None

    def with_nodal_fields(self, rows: np.ndarray, fields: np.ndarray) -> np.ndarray:
        """The rows themselves."""
        return rows

    def set_mixed(self, values: np.ndarray) -> None:
        """As `set_values`."""
        self.set_values(values)

    def mixable(self) -> Predictor:
        """What knows modes besides, in whose basis matrices can be mixed."""
        return MixedBuckling(self.analysis)

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
        basis = np.concatenate([modes, list(map(KeptOperation(solver, rows), lacking))])
        stiff, loaded = products(problem, basis, u, state.sign)
        found = largest_values(basis @ loaded.T, basis @ stiff.T, len(state.modes.load_factors))
        return largest_difference(state.modes.load_factors, np.sort(1.0 / found[found > 0.0]))


class MixedBuckling(BucklingPrediction):
    """A `BucklingPrediction` whose values can be mixed from those of several solutions.

    They are (2 n + k k + k 2 n,): the displacement, a matrix whose eigenvalues are the load factors, and the k modes
    that it is seen by.

    Args:
        analysis: whose state it reads and replaces.

    Source: docs/theory/buckling.md.
    """

    def __init__(self, analysis: Buckling) -> None:
        super().__init__(analysis)
        self._solved: BucklingModes | None = None

    def derivative(self, motion: np.ndarray, tolerance: float) -> np.ndarray:
        """Derivatives (2, 2 n + k k + k 2 n) of `values`; arguments as in `mixed_derivative`."""
        return mixed_derivative(self.analysis, motion, tolerance)

    def values(self) -> np.ndarray:
        """What is predicted, at the last solution or prediction."""
        return np.concatenate([super().values(), self.analysis.state.modes.vectors.ravel()])

    def alignment(self, before: np.ndarray) -> Alignment | None:
        """What brings `values` and derivatives of solutions before to the modes of the last solution."""
        modes = self.analysis.state.modes
        if before.shape != self.values().shape:
            return None
        if not len(modes.vectors):
            return np.asarray
        turn = turning(modes.mass_products, self._parts(before)[2])
        if turn is None:
            return None

        def aligned(one: np.ndarray) -> np.ndarray:
            u, small, rows = self._parts(one)
            return np.concatenate([u, (turn @ small @ turn.T).ravel(), (turn @ rows).ravel()])

        return aligned

    def nodal_fields(self, rows: np.ndarray, nodes: int) -> np.ndarray:
        """The displacement and the modes (count (1 + k), n, 2) of rows (count, 2 n + k k + k 2 n)."""
        # The number k of modes is the positive root of k k + 2 n k = length - 2 n.
        n = 2 * nodes
        k = round(float(np.sqrt((0.5 * n) ** 2 + rows.shape[1] - n)) - 0.5 * n)
        return np.concatenate([rows[:, :n], rows[:, n + k * k :]], axis=1).reshape(-1, nodes, 2)

    def with_nodal_fields(self, rows: np.ndarray, fields: np.ndarray) -> np.ndarray:
        """Rows (count, 2 m + k k + k 2 m) with displacement and modes (count (1 + k), m, 2) at other nodes."""
        parts = fields.reshape(len(rows), -1, fields[0].size)
        k = parts.shape[1] - 1
        n = (rows.shape[1] - k * k) // (1 + k)
        modes = parts[:, 1:].reshape(len(rows), -1)
        return np.concatenate([parts[:, 0], rows[:, n : n + k * k], modes], axis=1)

    def set_values(self, values: np.ndarray) -> None:
        """Take predicted values for those of the mesh as it lies now: the eigenvectors of the matrix mix the modes."""
        state = self.analysis.state
        if not state.predicted or self._solved is None:
            self._solved = state.modes
        u, small, rows = self._parts(values)
        super().set_values(np.concatenate([u, small.ravel()]))
        if len(rows):
            self.analysis.state = replace(self.analysis.state, modes=self._turned(self._solved, small, rows))

    def _turned(self, solved: BucklingModes, small: np.ndarray, rows: np.ndarray) -> BucklingModes:
        """The modes by rank, with the ids and signs of those of the last solution that they are mostly of."""
        turn = np.linalg.eigh(0.5 * (small + small.T))[1]
        order = np.argmax(np.abs(turn), axis=0)
        turn = turn * np.sign(turn[order, np.arange(len(order))])
        ids = solved.ids.reordered(order) if len(set(order)) == len(order) else solved.ids
        factors = self.analysis.state.modes.load_factors
        return BucklingModes(factors, turn.T @ rows, solved.mass_products, ids)

    def _parts(self, values: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Displacement (2 n,), matrix (k, k) and modes (k, 2 n) of values."""
        n = self.analysis.state.prebuckling.x.size
        k = len(self.analysis.state.modes.load_factors)
        return values[:n], values[n : n + k * k].reshape(k, k), values[n + k * k :].reshape(k, n)
