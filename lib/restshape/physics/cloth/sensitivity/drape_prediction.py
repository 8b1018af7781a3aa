"""Drapes of the frames of a drag without a relaxation: by their derivatives, on the pattern as it lies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Protocol

import numpy as np

from restshape.algebra.solve_counts import SolveCounts
from restshape.algebra.weak_calls import weak_call
from restshape.algebra.work_counts import pass_seconds
from restshape.analysis.frame import Frame
from restshape.physics.cloth.prescribed_places import PrescribedPlaces
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport
from restshape.physics.cloth.relaxation.state import RelaxationState
from restshape.physics.cloth.sensitivity.drape_derivative import DrapeDerivative
from restshape.physics.cloth.sensitivity.drape_distance import USUAL, Accuracy, missing_way, stabilised_step
from restshape.physics.cloth.sensitivity.postponed import Postponed

if TYPE_CHECKING:
    from restshape.analysis.analysis import Alignment, Context

TOLERANCE = 1e-6
"""Of derivatives, relative to their right sides."""
EXPECTED = 10
"""Iterations of a first step."""
PASSES = 3
"""Passes over all elements of a step besides one for each of its iterations: more steps in a frame do not predict
better."""
GROWS = 10.0
"""Times that a step may make the residual of a prediction larger."""
WORTH = 1e-3
"""Of the size of the cloth, the way of a step after which another one pays."""


class PredictedDrape(Protocol):
    """What is predicted: an analysis of cloth, its state, and what its solves have cost."""

    state: RelaxationState
    counts: SolveCounts
    context: Context

    @property
    def x(self) -> np.ndarray:
        """Unknowns (n, 3) of the state."""

    @property
    def rest(self) -> RelaxationState:
        """The equilibrium that is shown, or that the prediction is from."""

    @property
    def predicted(self) -> bool:
        """Whether a prediction is shown."""

    @property
    def postponed(self) -> bool:
        """Whether the state of the prediction that is shown is not made yet."""

    def postpone(self, shown: Postponed) -> None:
        """Show a prediction whose state is made where it is asked for."""

    def derivative(self, motion: np.ndarray, tolerance: float) -> DrapeDerivative:
        """Derivatives of the last equilibrium along the hand's directions."""

    def observe(self) -> dict[str, float]:
        """The scene's quantities of interest at the state."""

    def moved(self, state: RelaxationState) -> RelaxationState:
        """An equilibrium whose problem has taken in where the nodes of its mesh are now in the material."""

    def beside(self) -> PredictedDrape:
        """Another analysis of the same scene, which starts from this state."""

    def solve(self, frame: Frame) -> object:
        """Bring the state up to date with a frame."""


class DrapePrediction:
    """The `analysis.analysis.Predictor` of drapes: its values are the unknowns (n, 3).

    Friction holds what it held at the last equilibrium: its anchors go with the material.

    Args:
        analysis: whose state it reads and replaces.
        accuracy: of Newton steps; second: of the second one of an estimate.

    Source: docs/theory/design-derivative.md.
    """

    transferable = False

    def __init__(self, analysis: PredictedDrape, accuracy: Accuracy = USUAL, second: Accuracy = USUAL) -> None:
        self.analysis, self._accuracy, self._second = analysis, accuracy, second
        self._applied = EXPECTED
        self._missing: tuple[object, np.ndarray] = (None, np.empty(0))
        self._rest: RelaxationState | None = None
        self._tensions = np.empty((0, 3))
        self._prescribed: tuple[RelaxationState | None, Callable[[np.ndarray], np.ndarray]] = (None, np.copy)

    def derivative(self, motion: np.ndarray, tolerance: float) -> np.ndarray:
        """Derivatives (2, n, 3) of the unknowns along the hand's two directions; see `analysis.Predictor`."""
        self._applied = EXPECTED
        found, state = self.analysis.derivative(motion, min(tolerance, TOLERANCE)), self.analysis.state
        if found.note and found.note not in state.notes:
            self.analysis.state = replace(state, notes=(*state.notes, found.note))
        return found.s

    def values(self) -> np.ndarray:
        """The unknowns (n, 3) at the last equilibrium or prediction."""
        return self.analysis.x

    def set_values(self, values: np.ndarray) -> None:
        """Take predicted unknowns (n, 3) for those of the pattern as it lies now."""
        rest = self.analysis.rest
        if rest.problem.mesh.topology == rest.topology:
            # Flips make other triangles than those of the elements.
            self.analysis.state = self._predicted(rest, values)

    def show_values(self, values: np.ndarray, distance: Callable[[], float] | None = None) -> None:
        """The same, of which nothing but positions is made before it is asked for.

        Args:
            values: (n, 3) unknowns.
            distance: of `RelaxationState`.
        """
        rest = self.analysis.rest
        if rest.problem.mesh.topology == rest.topology:
            if self._prescribed[0] is not rest:
                self._prescribed = rest, PrescribedPlaces(rest.scene, rest.problem)
            # Weakly, for the analysis that keeps it is kept by this object.
            make = partial(weak_call(self._predicted), rest, values, distance)
            self.analysis.postpone(Postponed(rest, self._prescribed[1](values), make))

    def _predicted(
        self, rest: RelaxationState, values: np.ndarray, distance: Callable[[], float] | None = None
    ) -> RelaxationState:
        """The state with predicted unknowns (n, 3), from an equilibrium, on the pattern as it lies."""
        problem = rest.problem
        if self._rest is not rest:
            # Its nodes have not moved in the material yet.
            self._rest, self._tensions = rest, problem.tensions(rest.x)
        return replace(
            self.analysis.moved(rest),
            x=problem.constrain(values),
            place=problem.place,
            friction=problem.contact.history if problem.contact else None,
            layers=problem.self_contact.history if problem.self_contact else None,
            report=ConvergenceReport(),
            geometry=-1,
            notes=(),
            doubts=(),
            rest=rest,
            distance=distance,
        )

    @property
    def prediction(self) -> np.ndarray | None:
        """The predicted unknowns; None where the analysis holds an equilibrium."""
        return self.analysis.x if self.analysis.predicted else None

    def error(self, predicted: np.ndarray) -> float:
        """The distance of predicted unknowns (n, 3) on this mesh from the drape, over its size."""
        return self.share(predicted - self.analysis.state.x)

    def compare_cold(self) -> float:
        """The same distance of the prediction from the drape that a new relaxation finds from there."""
        state = self.analysis.state
        other = self.analysis.beside()
        none = np.empty(0, dtype=np.int32)
        other.solve(Frame(state.problem.mesh, none, None, state.scene, (None, (0.0, 0.0))))
        return self.share(other.state.x - state.x)

    def quantity_distances(self) -> dict[str, float]:
        """Estimated distances of the quantities of the prediction from those of the drape."""
        state = self.analysis.state
        if not state.predicted:
            return {}
        shown, mended = self.analysis.observe(), state.observer(state.x + self.missing())
        return {name: abs(mended[name] - value) for name, value in shown.items() if name in mended}

    def distance(self) -> float:
        """About the distance of the prediction from the drape on the same mesh, over its size.

        That of Newton steps, or the way on which friction would let the cloth slide there, whichever is longer.
        """
        return max(self.share(self.missing()), self.slide())

    def missing(self) -> np.ndarray:
        """About what a prediction (n, 3) lacks to be the drape, found once a prediction; see `missing_way`."""
        state = self.analysis.state
        if self._missing[0] is not state:
            accuracy = self._accuracy, self._second
            self._missing = state, missing_way(state.solver, state.x, self._tensions, accuracy)
        return self._missing[1]

    # --- mixed from several drapes ------------------------------------------------------------------------------------

    def counted(self) -> tuple[int, ...]:
        """Counts of all solves so far."""
        counts = self.analysis.counts
        return counts.matrices, counts.iterations, counts.factors

    def seconds_since(self, before: tuple[int, ...]) -> float:
        """Seconds by the calibration of the solves since there were these counts; 0 without a factor."""
        solver = self.analysis.rest.solver
        linear = None if solver is None else solver.linear
        if linear is None or not linear.kept.ready:
            return 0.0
        matrices, iterations, factors = (now - then for now, then in zip(self.counted(), before))
        price, known = linear.kept.price(), self.analysis.context.calibration
        passes = pass_seconds(linear.kept.size.nonzeros, known)
        return matrices * passes + iterations * price.iteration + factors * price.refresh

    def step_seconds(self) -> float:
        """Seconds that `step` costs, with as many iterations as the last one had."""
        linear = self.analysis.rest.solver.linear
        if linear is None or not linear.kept.ready:
            return np.inf
        passes = pass_seconds(linear.kept.size.nonzeros, self.analysis.context.calibration)
        return self._applied * (linear.kept.price().iteration + passes) + PASSES * passes

    def step(self) -> bool:
        """Take a Newton step from the prediction, as far as nothing is passed; whether another one pays."""
        state = self.analysis.state
        problem, solver, x = state.problem, state.solver, state.x
        self._applied = 0
        way = stabilised_step(solver, x, None, self._accuracy, self._counted)
        if not np.isfinite(way).all():
            return False
        after = x + problem.step_share(x, way) * way
        if not solver.residual_norm(after) < GROWS * solver.residual_norm(x):
            return False
        self.analysis.state = replace(state, x=after)
        return self.share(way) > WORTH

    def in_basis(self) -> np.ndarray:
        """As `values`: unknowns are those of nodes."""
        return self.values()

    def mixable(self) -> DrapePrediction:
        """Itself."""
        return self

    def alignment(self, before: np.ndarray) -> Alignment | None:
        """The identity, of drapes of the same mesh."""
        return np.asarray if before.shape == self.analysis.state.x.shape else None

    def nodal_fields(self, rows: np.ndarray, nodes: int) -> np.ndarray | None:
        """The positions (count, nodes, 3) of corners; None on several ranks, where those of Morley's are elsewhere."""
        morley = self.analysis.state.problem.morley is not None
        return None if morley and self.analysis.context.comm.size > 1 else rows[:, :nodes]

    def with_nodal_fields(self, rows: np.ndarray, fields: np.ndarray) -> np.ndarray:
        """Unknowns (count, m, 3) with such positions: slopes at sides are means of those of the triangles beside."""
        morley = self.analysis.state.problem.morley
        return fields if morley is None else np.stack([morley.spanned(one) for one in fields])

    def set_mixed(self, values: np.ndarray) -> None:
        """As `set_values`."""
        self.set_values(values)

    def _counted(self) -> None:
        self._applied += 1

    def slide(self) -> float:
        """The longest way on which what friction holds would slide if it followed, over the size of the cloth."""
        state = self.analysis.state
        contact, corners = state.problem.contact, state.problem.corners(state.x)
        if contact is None:
            return 0.0
        kept = contact.history
        try:
            way = contact.update_friction(contact.place(corners))
        finally:
            contact.history = kept
        return way * float(np.sqrt(len(corners)) / np.linalg.norm(corners - corners.mean(axis=0)))

    def share(self, way: np.ndarray) -> float:
        """The norm of ways (n, 3) of all corners over that of their distances from their middle."""
        # A state that is not made yet needs not be.
        problem, corners = self.analysis.rest.problem, self.analysis.rest.problem.corners(self.analysis.x)
        return float(np.linalg.norm(problem.corners(way)) / np.linalg.norm(corners - corners.mean(axis=0)))
