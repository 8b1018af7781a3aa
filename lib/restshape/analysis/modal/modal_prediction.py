"""Modes of the frames of a drag to first order in the hand, without a solve."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from restshape.algebra.eigenproblems.eigen import EigenReport
from restshape.algebra.work_counts import pencil_counts, pencil_seconds
from restshape.analysis.correction import largest_values
from restshape.analysis.modal.frequencies import largest_difference
from restshape.analysis.modal.modal_comparison import cold_frequencies
from restshape.analysis.modal.modal_matrices import products
from restshape.analysis.modal.modal_state import ModalState, Modes, frequencies
from restshape.analysis.modal.mode_search import ModeSearch
from restshape.analysis.modal.tone_quantities import TONES, tone_error
from restshape.analysis.settings import modal_settings
from restshape.first_use import made
from restshape.sensitivity.frequency_derivative import SolvedModes, known_modes, modal_derivative
from restshape.sensitivity.mode_alignment import turning

if TYPE_CHECKING:
    from restshape.analysis.analysis import Alignment, Predictor


class ModalPrediction:
    """The `analysis.analysis.Predictor` of modes.

    Its values are (k, k + n f): the stiffness that the modes see, which is diagonal at a solution, beside the modes.

    Args:
        analysis: whose state it reads and replaces.

    Source: docs/theory/free-vibrations.md.
    """

    transferable = True

    def __init__(self, analysis: SolvedModes) -> None:
        self.analysis = analysis

    def derivative(self, motion: np.ndarray, tolerance: float) -> np.ndarray:
        """Derivatives (2, k, k + n f) of `values`; arguments as in `modal_derivative`."""
        return modal_derivative(self.analysis, motion, tolerance)

    def values(self) -> np.ndarray:
        """What is predicted, at the last solution or prediction."""
        modes = self.analysis.state.modes
        return np.column_stack([np.diag(modes.values), modes.vectors])

    def set_values(self, values: np.ndarray) -> None:
        """Take predicted values for those of the mesh as it lies now: the eigenvectors of the stiffness mix the modes.

        Args:
            values: (k, k + n f), the stiffness symmetric but for rounding.
        """
        state, count = self.analysis.state, len(values)
        small = values[:, :count]
        eigenvalues, turn = np.linalg.eigh(0.5 * (small + small.T))
        order = np.argmax(np.abs(turn), axis=0)
        turn = turn * np.sign(turn[order, np.arange(count)])
        modes = self._reordered(state, order)
        modes = replace(modes, values=eigenvalues, basis=values[:, count:], turn=turn)
        report = EigenReport(0, False, state.report.age, state.report.method)
        self.analysis.state = replace(state, modes=modes, report=report)

    @property
    def prediction(self) -> np.ndarray | None:
        """The predicted frequencies; None where there are none."""
        return self.analysis.state.frequencies if self.analysis.state.predicted else None

    def error(self, predicted: np.ndarray) -> float:
        """The largest relative difference of predicted frequencies (modes,) from the solved ones."""
        return largest_difference(predicted, self.analysis.state.frequencies)

    def quantity_distances(self) -> dict[str, float]:
        """Those of cents and ratios from the `distance` of frequencies, which it is of all others."""
        state = self.analysis.state
        tones = {name: one for name, one in state.scene.quantities.items() if one.kind in TONES}
        if not tones:
            return {}
        shares = np.full(len(state.ids), self.distance())
        return {name: tone_error(one, shares, state.frequencies, state.ids) for name, one in tones.items()}

    def compare_cold(self) -> float:
        """The largest relative difference of the predicted frequencies from those of a cold solve."""
        analysis = self.analysis
        return largest_difference(
            analysis.state.frequencies, cold_frequencies(analysis.state, analysis.context, analysis.make)
        )

    def distance(self) -> float:
        """About the largest relative difference of the predicted frequencies from those of the same mesh.

        From the frequencies that the matrices of this shape give in the space of the predicted modes and what these
        lack, by the kept factor.
        """
        state, solver = self.analysis.state, self.analysis.solver
        body, vectors = state.body, state.modes.vectors
        body.follow(np.empty(0, dtype=np.int32))
        free = body.boundary.mask.ravel() == 0

        def weighed(rows: np.ndarray) -> np.ndarray:
            """K phi and M phi (2, k, n f) of rows (k, n f), at free unknowns."""
            return np.where(free, products(body, rows), 0.0)

        stiff, mass_products = weighed(vectors)
        values = np.einsum("ki,ki->k", vectors, stiff) / np.einsum("ki,ki->k", vectors, mass_products)
        share = solver.pencil.share
        missing = solver.pencil.auxiliary_solve(
            share.own(np.ascontiguousarray(values[:, None] * mass_products - stiff))
        )
        # The rigid motions are those of the last solve: what is left of them is of higher order.
        solver.deflation.clean(missing)
        missing = share.whole(missing)
        space = np.concatenate([vectors, missing])
        stiff, mass_products = (np.concatenate(pair) for pair in zip((stiff, mass_products), weighed(missing)))
        values = np.sort(1.0 / largest_values(space @ mass_products.T, space @ stiff.T, len(vectors)))
        return largest_difference(state.frequencies, frequencies(values[state.modes.chosen]))

    # --- mixed from several solutions ---------------------------------------------------------------------------------

    def counted(self) -> tuple[int, ...]:
        """Counts of all factors and substitutions so far."""
        return pencil_counts(self.analysis.solver.pencil)

    def seconds_since(self, before: tuple[int, ...]) -> float:
        """Seconds by the calibration of the work since there were these counts."""
        return pencil_seconds(self.analysis.solver.pencil, before, self.analysis.context.calibration)

    def step_seconds(self) -> float:
        """Infinite: a step on modes that lack much makes frequencies worse (docs/theory/free-vibrations.md)."""
        return np.inf

    def step(self) -> bool:
        """None is taken."""
        return False

    def in_basis(self) -> np.ndarray:
        """The values (k, k + n f) that the analysis holds, in the basis of the last solution."""
        modes = self.analysis.state.modes
        if modes.turn is None:
            return self.values()
        return np.column_stack([(modes.turn * modes.values) @ modes.turn.T, modes.basis])

    def mixable(self) -> Predictor:
        """What knows of modes that have converged alone, of which there are as many in each solution."""
        return MixedModes(self.analysis)

    def alignment(self, before: np.ndarray) -> Alignment | None:
        """What brings `values` and derivatives of solutions before to the modes of the last solution.

        Args:
            before: (k, k + n f) values of one of them.
        """
        count = len(before)
        turn = turning(made(self.analysis.state.solved).mass_products[: len(self.values())], before[:, count:])
        if turn is None:
            return None
        return lambda one: np.column_stack([turn @ one[:, :count] @ turn.T, turn @ one[:, count:]])

    def nodal_fields(self, rows: np.ndarray, nodes: int) -> np.ndarray:
        """The modes (count k, n2, columns) by plane nodes of rows (count, k, k + n f)."""
        count, k = rows.shape[:2]
        return rows[:, :, k:].reshape(count * k, nodes, -1)

    def with_nodal_fields(self, rows: np.ndarray, fields: np.ndarray) -> np.ndarray:
        """Rows (count, k, k + m f) with modes (count k, m2, columns) by other plane nodes."""
        count, k = rows.shape[:2]
        return np.concatenate([rows[:, :, :k], fields.reshape(count, k, -1)], axis=2)

    def set_mixed(self, values: np.ndarray) -> None:
        """As `set_values`: the mixed stiffness knows more of frequencies than Rayleigh's quotients of mixed modes."""
        self.set_values(values)

    def _reordered(self, state: ModalState, order: np.ndarray) -> Modes:
        """The modes with the ids of the last solution where mode k is what was order[k] there.

        Where the prediction leaves and comes back, the order is that of the solution again.
        """
        if len(set(order)) != len(order):
            return state.modes
        settings, solved = modal_settings(state.plan), made(state.solved)
        participation = solved.participation[order]
        # By rank, as a solve chooses; what had not converged is not predicted.
        search = ModeSearch(self.analysis.solver, state.body, settings.modes, settings.in_plane)
        chosen = search.choose(participation, order < state.count)
        return replace(state.modes, participation=participation, ids=solved.ids.reordered(order), chosen=chosen)


class MixedModes(ModalPrediction):
    """A `ModalPrediction` of the modes that have converged alone, whose values are mixed from several solutions."""

    def derivative(self, motion: np.ndarray, tolerance: float) -> np.ndarray:
        """Derivatives (2, k, k + n f) of `values`; arguments as in `modal_derivative`."""
        return np.stack([self._known(one) for one in super().derivative(motion, tolerance)])

    def values(self) -> np.ndarray:
        """What is predicted, at the last solution or prediction."""
        return self._known(super().values())

    def _known(self, values: np.ndarray) -> np.ndarray:
        """Of values, or a derivative, (m, m + n f) what belongs to the known modes."""
        known, count = len(known_modes(self.analysis)), len(values)
        return np.column_stack([values[:known, :known], values[:known, count:]])
