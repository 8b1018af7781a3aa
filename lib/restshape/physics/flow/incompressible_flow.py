"""Incompressible flow as a problem: integrals, conditions and quantities of a scene on one space."""

# More than 15 modules: conditions, elements and quantities make one problem here.
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from restshape.algebra.reuse.traits import Traits
from restshape.fem import problem as kinds
from restshape.fem.averages import node_weights
from restshape.fem.elements import (
    BACKFLOW,
    BACKFLOW_ON_MOVING_MESH,
    BACKFLOW_ON_MOVING_MESH_WITH_HEAT,
    BACKFLOW_WITH_HEAT,
    CURVED_SLIP,
    CURVED_SLIP_WITH_HEAT,
    FLOW,
    OSEEN_FLOW,
    SLOW_FLOW,
    UNSTEADY_FLOW,
    UNSTEADY_FLOW_ON_MOVING_MESH,
    UNSTEADY_OSEEN_FLOW,
    UNSTEADY_SLOW_FLOW,
)
from restshape.fem.family import Family
from restshape.fem.integral import Integral
from restshape.fem.observer import Observer, area
from restshape.fem.problem import Fields, SteadyProblem, Unknown
from restshape.fem.space import Space
from restshape.physics.flow.flow_conditions import FlowConditions
from restshape.physics.flow.flow_quantities import EdgeForce, flow_quantity
from restshape.scene.model import Quantity, Scene
from restshape.scene.plan import Plan

STEADY = {"none": SLOW_FLOW, "own": FLOW, "given": OSEEN_FLOW}
IN_TIME = {
    "none": UNSTEADY_SLOW_FLOW,
    "own": UNSTEADY_FLOW,
    "relative": UNSTEADY_FLOW_ON_MOVING_MESH,
    "given": UNSTEADY_OSEEN_FLOW,
}
"""Elements by what advects the velocity."""
ROUNDING = 1e-13
"""Residual over the largest terms in it below which it is rounding."""


@dataclass(frozen=True, eq=False)
class TimeStep:
    """What a step of a backward difference adds to the equations.

    Args:
        time: at its end [s].
        rate: the factor of the velocity in its rate [1/s]; dt: of the step [s].
        past: (n, h) what older values add to the rates of the fields with a history: [m/s^2] of velocities.
        mesh_velocity: (n, 2) [m/s]; None: the mesh stands still.
    """

    time: float
    rate: float
    dt: float
    past: np.ndarray
    mesh_velocity: np.ndarray | None = None


# More than 15 attributes: a problem holds what its integrals, conditions and quantities share.
class IncompressibleFlow(SteadyProblem):
    """rho (du/dt + u . grad u) = -grad p + mu laplace u, div u = 0 of one scene on one space; a `SteadyProblem`.

    Args:
        scene: fluid and boundaries.
        plan: which effects are on.
        space: kept by reference; its nodes may move and its edges may flip, its nodes and cells keep their number.

    Attributes:
        step: of a flow in time; None: it is steady.
        conditions: at the border.
        thickening: times the fluid's viscosity, the one that counts: above 1 on the way to a steady flow.
        drawing_in: outflows may draw fluid in, which is held there; see `draws_in`.
        advecting: (n, 2) velocity that advects, in place of the flow's own; None: that one.
        forces: on edges that quantities ask for, by their names.

    Source: docs/theory/flow.md.
    """

    name = "flow"
    unknowns = (Unknown("velocity", "m/s", ("x", "y")), Unknown("pressure", "Pa", ("p",)))
    symmetric = definite = linear = False
    varies = loaded_inside = True
    backend = "bcsr"
    steady, in_time = STEADY, IN_TIME
    relaxation = 1.0
    """Part of a velocity in the one that advects in the next step of Picard's method."""
    history: tuple[int, ...] = (0, 1)
    """Columns of the unknowns that have rates, so that a flow in time goes on from their past; the velocity's first."""

    def __init__(self, scene: Scene, plan: Plan, space: Space) -> None:
        self.scene, self.plan, self.space, self.fluid = scene, plan, space, scene.fluid
        self.inertia = plan.on("convection")
        self.step: TimeStep | None = None
        self.thickening, self.advecting, self.drawing_in = 1.0, None, False
        self.forces: dict[str, EdgeForce] = {}
        self._kept: tuple[tuple[object, ...], list[Integral]] | None = None
        self.conditions = self._conditions()
        self.boundary = self.conditions.dirichlet
        self.update()

    @property
    def size(self) -> float:
        """The length of a side of a cell [m], one for all of them."""
        return float(np.sqrt(2.0 * self._area / len(self.space.cells)))

    @property
    def stiffest(self) -> float:
        """The largest of the coefficients of momentum [Pa s], with that of a step."""
        inertia = 0.0 if self.step is None else self.fluid.rho * self.step.rate * self.size**2
        return self.fluid.mu + inertia + self.continuity * self.size

    @property
    def speed(self) -> float:
        """The largest velocity that is prescribed, or was there before the step [m/s]."""
        given = float(np.abs(self.boundary.values[:, :2]).max(initial=0.0))
        before = 0.0 if self.step is None else float(np.abs(self.step.past[:, :2]).max(initial=0.0)) / self.step.rate
        return max(given, before)

    @property
    def speed_words(self) -> str:
        """Where `speed` is from, for people, as it goes on from the length of a Reynolds number; empty where given."""
        return ""

    @property
    def stepping(self) -> float:
        """2 over the step [1/s] as far as it counts in tau: at most the rate at which a mean cell is passed.

        With a tau that goes to 0 with the step nothing would keep the pressure smooth: docs/theory/flow.md.
        """
        viscosity = self.fluid.mu / self.fluid.rho
        return min(2.0 / self.step.dt, (2.0 * self.speed + 4.0 * viscosity / self.size) / self.size)

    @property
    def continuity(self) -> float:
        """The factor of continuity [kg/(m^2 s)] that makes its residual one of forces."""
        inertia = self.fluid.rho * self.speed if self.inertia else 0.0
        return inertia + self.fluid.mu / self.size

    def remembered(self, x: np.ndarray) -> np.ndarray:
        """The fields (n, h) with a history, of unknowns x (n, f); a copy."""
        return x[:, list(self.history)]

    def initial(self) -> np.ndarray:
        """The unknowns (n, f) at time 0: the fluid is at rest, but where it is driven."""
        return self.boundary.values.copy()

    @classmethod
    def traits(cls, plan: Plan) -> Traits:
        """Matrices of steps in time have a rate term."""
        return replace(super().traits(plan), rate=plan.settings("flow").time_step is not None)

    def take(self, step: TimeStep) -> None:
        """Take up another time step; `update` evaluates what depends on the time."""
        self.step = step

    def update(self) -> None:
        """Evaluate again what depends on the place of the nodes, and on the time."""
        self._kept = None
        self._area = area(self.space)
        self.conditions.evaluate(0.0 if self.step is None else self.step.time)

    def blocks(self) -> list[np.ndarray]:
        """Entities (m, k) int32 that have a tangent: the cells, and facets of the border with terms of their own."""
        return [self.space.cells, *self._sides().values()]

    def integrals(self, kind: str, part: float = 1.0) -> list[Integral]:
        """The integrals of a kind at the present places of the nodes; see `fem.problem.SteadyProblem`."""
        if kind in (kinds.LOADS, kinds.FOLLOWERS):
            return []
        # Newton's method, drag and lift ask for the same ones.
        depends = self._depends()
        if self._kept is None or any(a is not b for a, b in zip(self._kept[0], depends)):
            self._kept = depends, self._integrals()
        return self._kept[1]

    def _depends(self) -> tuple[object, ...]:
        """What the integrals change with from one `update` to the next, compared by identity."""
        return self.step, self.thickening, self.advecting, self.drawing_in

    def _integrals(self) -> list[Integral]:
        """Those of the flow with the present values."""
        advecting, given = self._advecting()
        if self.step is not None:
            given = [*given, self.step.past[:, : len(self.history)]]
        family = (self.steady if self.step is None else self.in_time)[advecting]
        return [self._integral(family, self._parameters(), [*given, *self._given()]), *self._slip(), *self._backflow()]

    def _conditions(self) -> FlowConditions:
        """The conditions at the border."""
        return FlowConditions(self.scene, self.space)

    def _parameters(self) -> np.ndarray:
        """Those (p,) of all cells, or (ne, p); those of flow come first."""
        step, always = self.step, [self.fluid.rho, self.fluid.mu * self.thickening, 0.0, 0.0, self.continuity]
        return np.array(always if step is None else [*always, step.rate, self.stepping])

    def _given(self) -> list[np.ndarray]:
        """Further nodal coefficients (n, c) of the elements."""
        return []

    def _integral(self, family: Family, parameters: np.ndarray, given: Sequence[np.ndarray]) -> Integral:
        """Of all cells, with parameters (p,) or (ne, p), and nodal coefficients that are given (n, c)."""
        coefficients = np.ascontiguousarray(np.hstack(given)) if given else None
        space = self.space
        return Integral(family[space.cell_type], space.X, space.cells, parameters, coefficients=coefficients)

    def _slip(self) -> list[Integral]:
        """What friction lacks on edges with slip that turn."""
        if "slip" not in self._sides():
            return []
        family = CURVED_SLIP if self.conditions.columns == 3 else CURVED_SLIP_WITH_HEAT
        return [self._on_sides("slip", family, self.fluid.mu * self.thickening)]

    def _backflow(self) -> list[Integral]:
        """What holds the fluid that outflows draw in."""
        if not self.drawing_in:
            return []
        moving, heat = None if self.step is None else self.step.mesh_velocity, self.conditions.columns == 4
        if moving is None or not np.any(moving[self.conditions.outflow]):
            return [self._on_sides("outflow", BACKFLOW_WITH_HEAT if heat else BACKFLOW, self.fluid.rho)]
        family = BACKFLOW_ON_MOVING_MESH_WITH_HEAT if heat else BACKFLOW_ON_MOVING_MESH
        return [self._on_sides("outflow", family, self.fluid.rho, moving)]

    def _sides(self) -> dict[str, np.ndarray]:
        """Facets (k, 2) int32 of the border with terms of their own, in the order of the blocks after the cells."""
        found = {"slip": self.conditions.curved_slip, "outflow": self.conditions.outflow}
        return {name: facets for name, facets in found.items() if len(facets)}

    def _on_sides(self, name: str, family: Family, value: float, given: np.ndarray | None = None) -> Integral:
        """The integral of a family over facets of one of these names, with a parameter, and coefficients (n, c)."""
        sides = self._sides()
        block, parameters = 1 + list(sides).index(name), np.array([value])
        return Integral(family["edge2"], self.space.X, sides[name], parameters, block=block, coefficients=given)

    def draws_in(self, x: np.ndarray) -> bool:
        """Whether outflows draw fluid in anywhere, at unknowns x (n, f): then `drawing_in` must be set."""
        if not (self.inertia and len(self.conditions.outflow)):
            return False
        moving = None if self.step is None else self.step.mesh_velocity
        return self.conditions.enters(x[:, :2] if moving is None else x[:, :2] - moving)

    def _advecting(self) -> tuple[str, list[np.ndarray]]:
        """How the velocity is advected, and by which nodal velocity (n, 2) where that is no unknown."""
        moving = None if self.step is None else self.step.mesh_velocity
        if self.inertia and self.advecting is None:
            return ("own", []) if moving is None else ("relative", [moving])
        own = self.advecting if self.inertia else None
        if own is None and moving is None:
            return "none", []
        return "given", [-moving if own is None else own if moving is None else own - moving]

    def force_scale(self, x: np.ndarray) -> float:
        """What residuals at x (n, 3) are measured against [N/m]: flux of momentum, and friction, of a usual node.

        Not of all nodes together: residuals of smooth errors are the smaller the more nodes there are.
        """
        u, v = x[:, 0], x[:, 1]
        square = u * u + v * v
        forces = self.fluid.mu / self.size * np.sqrt(square)
        if self.inertia:
            forces += self.fluid.rho * square
        return self.size * float(np.sqrt(forces @ forces / len(forces)))

    def rounding(self) -> float:
        """Residual a unit of the largest unknown below which one that steps do not lower any more is rounding."""
        return ROUNDING * self.stiffest

    def pressure(self, x: np.ndarray) -> np.ndarray:
        """Pressures (n,) [Pa] of the unknowns x (n, 3); of mean 0 where there is no outflow."""
        if not self.conditions.closed:
            return x[:, 2]
        return x[:, 2] - self._mean(x[:, 2])

    def _mean(self, values: np.ndarray) -> float:
        weights = node_weights(self.space, None, slice(None))()
        return float(weights @ values / weights.sum())

    def fields(self, x: np.ndarray) -> Fields:
        """Velocity [m/s], pressure [Pa] and speed [m/s] of the nodes, at x (n, 3)."""
        velocity = x[:, :2]
        return {"velocity": velocity, "pressure": self.pressure(x), "speed": np.linalg.norm(velocity, axis=1)}, {}

    @classmethod
    def blank_fields(cls, space: Space) -> Fields:
        """The same fields, all NaN, on a space that has not been solved on."""
        n = len(space.X)
        return {
            name: np.full(shape, np.nan) for name, shape in (("velocity", (n, 2)), ("pressure", n), ("speed", n))
        }, {}

    def observer(self, quantities: Mapping[str, Quantity]) -> Observer:
        """What evaluates quantities of the unknowns x (n, 3)."""
        return Observer({name: flow_quantity(self, name, quantity) for name, quantity in quantities.items()})
