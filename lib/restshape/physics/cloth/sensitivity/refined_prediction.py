"""Drapes of the frames of a drag from a coarse mesh, shown on the fine one that is nested in it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Protocol

import numpy as np

from restshape.algebra.weak_calls import weak_call
from restshape.analysis.frame import Frame
from restshape.errors import ReplayProblem
from restshape.mesh.advance import NO_CELLS
from restshape.physics.cloth.relaxation.refinement import Refinement
from restshape.physics.cloth.sensitivity.drape_prediction import DrapePrediction, PredictedDrape
from restshape.physics.cloth.sensitivity.fine_correction import FineCorrection

if TYPE_CHECKING:
    from restshape.analysis.analysis import Alignment
    from restshape.scene.model import Scene

ACCURACY, SECOND = (1, 0.1), (2, 0.03)
"""Steps of conjugate gradients of the coarse cloth end after one that gains less than a share of the squared energy; in
the second step of an estimate after two of them."""
NO_HAND = (None, (0.0, 0.0))


class NestedDrape(PredictedDrape, Protocol):
    """An analysis of cloth on the finest of nested meshes."""

    def entered(self) -> object:
        """The state that a solve begins with."""

    def on(self) -> NestedDrape:
        """Another analysis of the same cloth that goes on from this state, on whatever mesh its frames have."""


class RefinedPrediction:
    """The `analysis.refining_predictor.RefiningPredictor` of drapes.

    Its values are the unknowns (n, 3) of a coarse mesh, which is solved and differentiated by an analysis of its own;
    the analysis of the fine one shows them with a correction, and is the one that is recorded and released.

    Args:
        analysis: of the finest mesh.
        levels: nested meshes from the coarse one to the finest.

    Attributes:
        correction: (n, 3) of the fine cloth, that is shown.
        waits: nothing is shown before `show`, for more is to come.
        lean: of what is shown positions alone are made before more is asked for.

    Source: docs/theory/design-derivative.md; 5.3.5 of the thesis.
    """

    transferable = False

    def __init__(self, analysis: NestedDrape, fine: DrapePrediction, levels: int) -> None:
        self.analysis, self.fine, self.levels = analysis, fine, levels
        self.correction, self.waits = np.empty((0, 3)), False
        self.lean = False
        self._kept = self.correction
        self._coarse: NestedDrape | None = None
        self._own: DrapePrediction | None = None
        self._map: FineCorrection | None = None
        self._refinement: Refinement | None = None
        self._step: float | None = None
        self._counted = 0, 0, 0

    # --- the coarse cloth ---------------------------------------------------------------------------------------------

    @property
    def coarse(self) -> NestedDrape:
        """The analysis of the coarse mesh."""
        if self._coarse is None:
            raise ReplayProblem("the coarse mesh has no drape yet")
        return self._coarse

    @property
    def own(self) -> DrapePrediction:
        """What predicts the coarse cloth."""
        if self._own is None:
            raise ReplayProblem("the coarse mesh has no drape yet")
        return self._own

    @property
    def map(self) -> FineCorrection:
        """Between both meshes."""
        if self._map is None:
            raise ReplayProblem("the coarse mesh has no drape yet")
        return self._map

    def begin(self) -> None:
        """Relax the coarse cloth from where the fine one is at rest, its friction included.

        Raises:
            ReplayProblem: it comes to no rest.
        """
        state = self.analysis.state
        self.leave()
        if self._coarse is not None:
            self._counted = self.counted()[:3]
        nested = state.problem.mesh.hierarchy
        self._map = FineCorrection(nested, self.levels, state.problem.morley)
        self._coarse = self.analysis.on()
        self._own = DrapePrediction(self._coarse, ACCURACY, SECOND)
        self.settle(state.scene)
        if len(self.correction) != len(state.x):
            self._kept = self.correction = self.map.of(self._corners(), state.x)

    def settle(self, scene: Scene) -> None:
        """Relax the coarse cloth on its mesh as it lies.

        Raises:
            ReplayProblem: it comes to no rest.
        """
        self.coarse.solve(Frame(self.map.coarse, NO_CELLS, None, scene, NO_HAND))
        report = self.coarse.state.report
        if not report.converged:
            raise ReplayProblem(f"the cloth on the coarse mesh does not come to rest: {report.why}")
        if self.analysis.predicted:
            self._show()

    @property
    def settled(self) -> bool:
        """Whether the coarse cloth is at rest on its mesh as it lies."""
        return self._coarse is not None and not self._coarse.predicted

    @property
    def sparse(self) -> bool:
        """Whether positions alone have been made of the fine cloth that is shown."""
        return self.analysis.postponed

    def derivative(self, motion: np.ndarray, tolerance: float) -> np.ndarray:
        """Derivatives (2, n, 3) of the coarse unknowns; motion (2, corners, 2) is of the fine mesh's nodes."""
        return self.own.derivative(self.map.restricted(motion), tolerance)

    def values(self) -> np.ndarray:
        """The coarse unknowns (n, 3) at the last equilibrium or prediction."""
        return self.own.values()

    def set_values(self, values: np.ndarray) -> None:
        """Take predicted coarse unknowns (n, 3) for those of the pattern as it lies now, and show them."""
        self.leave()
        if self.lean:
            self.own.show_values(values)
        else:
            self.own.set_values(values)
        self._step = None
        self._show()

    def step(self) -> bool:
        """Take a Newton step of the coarse cloth, and show it; whether another one pays."""
        before = self.own.values()
        again = self.own.step()
        self._step = self.own.share(self.own.values() - before)
        self._show()
        return again

    def step_seconds(self) -> float:
        """Seconds that `step` costs, by the calibration."""
        return self.own.step_seconds()

    @property
    def distance_known(self) -> bool:
        """Whether the coarse cloth is at rest, or has taken a step, so that `coarse_distance` takes none."""
        return self.settled or self._step is not None

    def coarse_distance(self) -> float:
        """About the distance of the coarse cloth from its drape, over its size: of the last step, or of one that is
        missing."""
        if self.settled:
            return 0.0
        return self.own.distance() if self._step is None else max(self._step, self.own.slide())

    # --- the fine cloth -----------------------------------------------------------------------------------------------

    def fine_correction(self, motion: np.ndarray, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
        """The correction (n, 3) where both cloths are at rest, and its derivatives (2, n, 3) along the hand.

        Raises:
            ReplayProblem: one of them has no derivative.
        """
        slopes = self.derivative(motion, tolerance), self.fine.derivative(motion, tolerance)
        coarse, fine = self._corners(), self.analysis.state.x
        corners = np.stack([self.coarse.state.problem.corners(s) for s in slopes[0]])
        self._kept = self.map.of(coarse, fine)
        return self._kept, self.map.rates(coarse, fine, (corners, slopes[1]))

    @property
    def prediction(self) -> np.ndarray | None:
        """The fine unknowns that are shown; None where they are at rest."""
        return self.fine.prediction

    def error(self, predicted: np.ndarray) -> float:
        """The distance of fine unknowns (n, 3) from the drape, over its size."""
        return self.fine.error(predicted)

    def compare_cold(self) -> float:
        """The same of what is shown from the drape that a new relaxation finds from there."""
        return self.fine.compare_cold()

    def distance(self) -> float:
        """About the distance of what is shown from the fine drape, over its size.

        That of the coarse cloth from its own, and the way of the correction since the last fine drape.
        """
        return self.coarse_distance() + self.way(self.correction)

    def way(self, correction: np.ndarray) -> float:
        """Of a correction (n, 3) since the last fine drape, over the size of the cloth."""
        return self.fine.share(correction - self._kept)

    def quantity_distances(self) -> dict[str, float]:
        """None: what the coarse cloth has says nothing of quantities on the fine one."""
        return {}

    def refine(self) -> bool:
        """Take a step of the fine cloth towards its drape, beside what is shown; whether another one is needed."""
        if self._refinement is None:
            self._refinement = Refinement(self.analysis, self.analysis.state.plan.settings("drape").steps)
        return self._refinement.advance()

    def reached(self) -> np.ndarray | None:
        """The correction (n, 3) that steps of `refine` have led to; None where that is no better than what is shown."""
        steps = self._refinement
        return self.map.of(self._corners(), steps.reached) if steps is not None and steps.better else None

    def take(self) -> None:
        """Let the fine analysis solve from where `refine` has come to."""
        if self._refinement is not None:
            self._refinement.take()
        self.leave()

    def leave(self) -> None:
        """Forget the steps of `refine`."""
        self._refinement = None

    def _show(self) -> None:
        """The same, unless more is to come in the frame."""
        if not self.waits:
            self.show()

    def show(self) -> None:
        """Let the fine analysis hold the coarse cloth with the correction."""
        values = self.map.joined(self._corners(), self.correction)
        if self.lean:
            self.fine.show_values(values, weak_call(self.distance))
            return
        self.fine.set_values(values)
        state = self.analysis.state
        if state.predicted:
            self.analysis.state = replace(state, distance=weak_call(self.distance))

    def _corners(self) -> np.ndarray:
        """Positions (n_coarse, 3) of the coarse mesh's nodes."""
        return self.coarse.rest.problem.corners(self.coarse.x)

    # --- mixed from several drapes ------------------------------------------------------------------------------------

    def counted(self) -> tuple[int, ...]:
        """Counts of all solves so far: of the coarse mesh, and of the fine one."""
        own = self._own.counted() if self._own else (0, 0, 0)
        return (*(a + b for a, b in zip(self._counted, own)), *self.fine.counted())

    def seconds_since(self, before: tuple[int, ...]) -> float:
        """Seconds by the calibration of the solves since there were these counts."""
        own = self.own.seconds_since(tuple(a - b for a, b in zip(before[:3], self._counted))) if self._own else 0.0
        return own + self.fine.seconds_since(before[3:])

    def in_basis(self) -> np.ndarray:
        """As `values`."""
        return self.values()

    def mixable(self) -> RefinedPrediction:
        """Itself."""
        return self

    def alignment(self, before: np.ndarray) -> Alignment | None:
        """The identity, of drapes of the same coarse mesh."""
        return self.own.alignment(before)

    def nodal_fields(self, rows: np.ndarray, nodes: int) -> None:
        """None: values are of a coarse mesh."""

    def with_nodal_fields(self, rows: np.ndarray, fields: np.ndarray) -> np.ndarray:
        """The rows themselves."""
        return rows

    def set_mixed(self, values: np.ndarray) -> None:
        """As `set_values`."""
        self.set_values(values)
