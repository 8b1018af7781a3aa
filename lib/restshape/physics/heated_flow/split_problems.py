"""The two parts of flow with heat, each with what the other has given: a lifted flow, and heat in a known flow."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from restshape.fem import problem as kinds
from restshape.fem.dirichlet import Dirichlet
from restshape.fem.elements import (
    ADVECTED_HEAT,
    LIFTED_FLOW,
    LIFTED_OSEEN_FLOW,
    LIFTED_SLOW_FLOW,
    UNSTEADY_ADVECTED_HEAT,
    UNSTEADY_LIFTED_FLOW,
    UNSTEADY_LIFTED_FLOW_ON_MOVING_MESH,
    UNSTEADY_LIFTED_OSEEN_FLOW,
    UNSTEADY_LIFTED_SLOW_FLOW,
)
from restshape.fem.integral import Integral
from restshape.fem.observer import Observer
from restshape.fem.problem import Fields, SteadyProblem
from restshape.physics.flow.incompressible_flow import IncompressibleFlow
from restshape.physics.heated_flow.heated_flow import HeatedFlow
from restshape.physics.heated_flow.heated_flow_conditions import prescribed_temperatures
from restshape.scene.model import Quantity

STEADY = {"none": LIFTED_SLOW_FLOW, "own": LIFTED_FLOW, "given": LIFTED_OSEEN_FLOW}
IN_TIME = {
    "none": UNSTEADY_LIFTED_SLOW_FLOW,
    "own": UNSTEADY_LIFTED_FLOW,
    "relative": UNSTEADY_LIFTED_FLOW_ON_MOVING_MESH,
    "given": UNSTEADY_LIFTED_OSEEN_FLOW,
}


# More than 15 attributes: those of any flow.
class LiftedFlow(IncompressibleFlow):
    """The momentum and continuity of a `HeatedFlow`, on the same scales, with a temperature that is given.

    Args:
        whole: kept by reference.

    Attributes:
        temperature: (n, 1) [K].
    """

    name = "lifted_flow"
    steady, in_time = STEADY, IN_TIME

    def __init__(self, whole: HeatedFlow) -> None:
        self.whole, self.temperature = whole, np.zeros((len(whole.space.X), 1))
        super().__init__(whole.scene, whole.plan, whole.space)

    @property
    def speed(self) -> float:
        """That of the whole [m/s]."""
        return self.whole.speed

    def update(self) -> None:
        """Take what the whole has."""
        whole = self.whole
        self.step, self.thickening, self.advecting = whole.step, whole.thickening, whole.advecting
        self.drawing_in = whole.drawing_in
        super().update()

    def _parameters(self) -> np.ndarray:
        return np.array([*super()._parameters(), *self.whole.lift, self.whole.neutral])

    def _depends(self) -> tuple[object, ...]:
        # Temperatures change in place.
        return *super()._depends(), object()

    def _given(self) -> list[np.ndarray]:
        return [self.temperature]


# More than 15 attributes: a problem holds what its integrals, conditions and quantities share.
class HeatInFlow(SteadyProblem):
    """The heat of a `HeatedFlow`, on the same scale, with a velocity that is given; linear.

    Args:
        whole: kept by reference.

    Attributes:
        velocity: (n, 2) [m/s].
    """

    name = "heat_in_flow"
    unknowns = (HeatedFlow.unknowns[-1],)
    symmetric = definite = False
    linear = varies = loaded_inside = True

    def __init__(self, whole: HeatedFlow) -> None:
        self.whole, self.scene, self.plan, self.space = whole, whole.scene, whole.plan, whole.space
        self.velocity = np.zeros_like(whole.space.X)
        conditions = [*prescribed_temperatures(self.scene, self.space, 0)]
        self.boundary = Dirichlet((len(self.space.X), 1), conditions, self.scene.parameters, "K")
        self.update()

    @property
    def stiffest(self) -> float:
        """That of the whole."""
        return self.whole.stiffest

    def update(self) -> None:
        """Take what the whole has."""
        self.boundary.values[:] = self.whole.boundary.values[:, 3:]

    def blocks(self) -> list[np.ndarray]:
        """Entities (m, 3) int32 that have a tangent: the cells."""
        return [self.space.cells]

    def integrals(self, kind: str, part: float = 1.0) -> list[Integral]:
        """The integrals of a kind at the present places of the nodes; see `fem.problem.SteadyProblem`."""
        if kind in (kinds.LOADS, kinds.FOLLOWERS):
            return []
        step, parameters = self.whole.step, self.whole.heat_parameters()
        family, velocity = ADVECTED_HEAT, self.velocity if self.whole.advecting is None else self.whole.advecting
        given = [velocity]
        if step is not None:
            family = UNSTEADY_ADVECTED_HEAT
            given = [velocity if step.mesh_velocity is None else velocity - step.mesh_velocity, step.past[:, 2:]]
            times = np.broadcast_to([step.rate, self.whole.stepping], (*parameters.shape[:-1], 2))
            parameters = np.concatenate([parameters, times], axis=-1)
        coefficients = np.ascontiguousarray(np.hstack(given))
        space = self.space
        return [Integral(family[space.cell_type], space.X, space.cells, parameters, coefficients=coefficients)]

    def add_nodal_loads(self, out: np.ndarray, sign: float, cells: np.ndarray | None = None) -> None:
        """Add `sign` times the heat that enters by the border to `out` (n, 1); see `fem.problem.SteadyProblem`."""
        out[:, 0] += sign * self.whole.heat_factor * self.whole.border.loads(cells)

    def fields(self, x: np.ndarray) -> Fields:
        """Temperature [K] of the nodes at x (n, 1)."""
        return {"temperature": x[:, 0]}, {}

    def observer(self, quantities: Mapping[str, Quantity]) -> Observer:
        """What evaluates quantities: none, which are those of the whole."""
        return Observer({})
