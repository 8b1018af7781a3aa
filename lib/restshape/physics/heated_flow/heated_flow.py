"""Incompressible flow with heat as a problem: velocity, pressure and temperature of a scene on one space."""

# More than 15 modules: conditions, elements, sources and quantities make one problem here.
from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np

from restshape.fem.cell_samples import CellValues, Given
from restshape.fem.elements import (
    HEATED_FLOW,
    HEATED_OSEEN_FLOW,
    HEATED_SLOW_FLOW,
    UNSTEADY_HEATED_FLOW,
    UNSTEADY_HEATED_FLOW_ON_MOVING_MESH,
    UNSTEADY_HEATED_OSEEN_FLOW,
    UNSTEADY_HEATED_SLOW_FLOW,
    UNSTEADY_HEATED_SLOW_FLOW_ON_MOVING_MESH,
)
from restshape.fem.family import Family
from restshape.fem.integral import Integral
from restshape.fem.observer import Observer
from restshape.fem.problem import Fields, Unknown
from restshape.fem.space import Space
from restshape.physics.flow.incompressible_flow import IncompressibleFlow
from restshape.physics.heated_flow.border_heat import BorderHeat
from restshape.physics.heated_flow.fluid_heat import heat_properties
from restshape.physics.heated_flow.heated_flow_conditions import HeatedFlowConditions
from restshape.physics.heated_flow.heated_flow_quantities import EdgeHeat, heated_flow_quantity
from restshape.physics.heated_flow.sourced_integral import SourcedIntegral
from restshape.physics.heated_flow.temperature_differences import initial, neutral
from restshape.scene.model import Quantity, Scene
from restshape.scene.plan import Plan

STEADY = {"none": HEATED_SLOW_FLOW, "own": HEATED_FLOW, "given": HEATED_OSEEN_FLOW}
IN_TIME = {
    "none": UNSTEADY_HEATED_SLOW_FLOW,
    "own": UNSTEADY_HEATED_FLOW,
    "relative": UNSTEADY_HEATED_FLOW_ON_MOVING_MESH,
    "given": UNSTEADY_HEATED_OSEEN_FLOW,
    "mesh": UNSTEADY_HEATED_SLOW_FLOW_ON_MOVING_MESH,
}
"""Elements by what advects the velocity."""


STILL = 1e-9
"""Of the speed at which friction spreads over a cell, a velocity that is none."""
SMALLEST = 1e-9
"""Part of a temperature that is no difference."""


@dataclass(frozen=True)
class Scales:
    """What residuals of a usual node are measured against.

    Args:
        momentum: flux of momentum, friction and lift [N/m].
        volume: what flows through a cell [m^2/s].
        heat: what is advected and conducted, and what enters [W/m].
    """

    momentum: float
    volume: float
    heat: float


def _mean(values: np.ndarray) -> float:
    """The root of the mean square."""
    return float(np.sqrt(np.mean(values**2)))


# More than 15 attributes: a problem holds what its integrals, conditions and quantities share.
class HeatedFlow(IncompressibleFlow):
    """Flow with a temperature T that it carries and that may lift it: the equations of Boussinesq.

    Those of `IncompressibleFlow` with the force -rho beta (T - T0) g, and C (dT/dt + u . grad T) = k laplace T + s.
    Arguments as there.

    Attributes:
        capacity: C [J/(m^3 K)]; conductivity: k [W/(m K)].
        lift: (2,) force by temperature, -rho beta g [N/(m^3 K)]; 0 without buoyancy.
        border: given heat fluxes.

    Source: docs/theory/flow.md.
    """

    name = "heated_flow"
    unknowns = (*IncompressibleFlow.unknowns, Unknown("temperature", "K", ("temperature",)))
    history = (0, 1, 3)
    steady, in_time, relaxation = STEADY, IN_TIME, 0.5

    def __init__(self, scene: Scene, plan: Plan, space: Space) -> None:
        self.capacity, self.conductivity = heat_properties(scene)
        given = [Given(f"heat.{name}.source", one.on, one.source) for name, one in scene.heat.items()]
        self.sources, self.border = CellValues(space, given, scene.parameters), BorderHeat(scene, space)
        self.lift, self.neutral = np.zeros(2), neutral(scene)
        if plan.on("buoyancy"):
            self.lift = -scene.fluid.rho * scene.fluid.expansion * np.array(plan.settings("gravity").g)
        self.mass = None
        self.heats: dict[str, EdgeHeat] = {}
        self._pull = float(np.linalg.norm(self.lift))
        super().__init__(scene, plan, space)

    def start(self) -> np.ndarray:
        """The unknowns (n, 4) from which a search begins that knows nothing: at rest, at the temperature at time 0."""
        x = np.zeros_like(self.boundary.values)
        x[:, 3] = initial(self.scene)
        self.boundary.apply(x)
        return x

    initial = start

    def update(self) -> None:
        """Evaluate again what depends on the place of the nodes, and on the time."""
        super().update()
        self.border.time = 0.0 if self.step is None else self.step.time
        self._source = self.sources() if self.sources.given else np.zeros((1, 1))
        entering, width = float(np.abs(self._source).max()), float(np.sqrt(self._area))
        self._entering = self.size * (self.border.largest + self.size * entering)
        self._span = self._known_span()
        flux = self.border.largest + width * entering
        self._fastest = max(super().speed, self._buoyant_speed(flux, width))
        conducted, advected = flux * width / self.conductivity, flux / self.capacity
        span = self._span + (min(conducted, advected / self._fastest) if self._fastest > 0.0 else conducted)
        self.heat_factor = self._heat_factor(span)

    @property
    def speed(self) -> float:
        """The largest velocity that is prescribed, was there before the step, or buoyancy may bring about [m/s]."""
        return self._fastest

    @property
    def speed_words(self) -> str:
        """As of `IncompressibleFlow`: that buoyancy may be what moves the fluid fastest."""
        return f", and {self.speed:.3g} m/s that buoyancy may bring about" if self.speed > super().speed else ""

    @property
    def stiffest(self) -> float:
        """The largest of the coefficients of momentum and of heat [Pa s], with those of a step."""
        stored = 0.0 if self.step is None else self.capacity * self.step.rate * self.size**2
        return max(super().stiffest, self.heat_factor * (self.conductivity + stored))

    def add_nodal_loads(self, out: np.ndarray, sign: float, cells: np.ndarray | None = None) -> None:
        """Add `sign` times the heat that enters by the border to `out` (n, 4); see `fem.problem.SteadyProblem`."""
        out[:, 3] += sign * self.heat_factor * self.border.loads(cells)

    def add_nodal_load_rates(self, dX: np.ndarray, out: np.ndarray) -> None:
        """Take the rates of this heat, when nodes move with rates dX (n, 2), from `out` (n, 4)."""
        out[:, 3] -= self.heat_factor * self.border.rates(dX)

    def force_scale(self, x: np.ndarray) -> float:
        """What residuals at x (n, 4) are measured against [N/m]: the least of the three scales, each as forces.

        So each equation is solved on its own scale, whatever their factors were taken from.
        """
        scales = self.scales(x)
        return min(scales.momentum, self.continuity * scales.volume, self.heat_factor * scales.heat)

    def scales(self, x: np.ndarray) -> Scales:
        """What the residuals of the three equations at x (n, 4) are measured against."""
        speed, size = np.sqrt(x[:, 0] ** 2 + x[:, 1] ** 2), self.size
        span = max(self._span, float(np.ptp(x[:, 3])))
        pull = self._pull * np.abs(x[:, 3] - self.neutral) * size
        dynamic = self.fluid.rho * speed**2 if self.inertia else 0.0
        forces = dynamic + self.fluid.mu / size * speed + pull
        flows = self.capacity * speed + self.conductivity / size
        momentum, heat = size * _mean(forces), size * span * _mean(flows) + self._entering
        return Scales(momentum, momentum / self.continuity, heat)

    def usual(self, x: np.ndarray) -> list[tuple[int, float]]:
        """Of velocity [m/s], pressure [Pa] and temperature [K] at x (n, 4) the columns, and what is usual of each.

        Where nothing moves the fluid velocities are rounding, and as small beside that at which friction spreads.
        """
        scales, size, mu = self.scales(x), self.size, self.fluid.mu
        speed = max(scales.volume / size, STILL * mu / (self.fluid.rho * size))
        pressure = max(scales.momentum / size, mu / size * speed)
        return [(2, speed), (1, pressure), (1, max(self._span, SMALLEST * self.neutral))]

    def fields(self, x: np.ndarray) -> Fields:
        """Velocity [m/s], pressure [Pa], speed [m/s] and temperature [K] of the nodes, at x (n, 4)."""
        points, cells = super().fields(x)
        return {**points, "temperature": x[:, 3]}, cells

    @classmethod
    def blank_fields(cls, space: Space) -> Fields:
        """The same fields, all NaN, on a space that has not been solved on."""
        points, cells = super().blank_fields(space)
        return {**points, "temperature": np.full(len(space.X), np.nan)}, cells

    def observer(self, quantities: Mapping[str, Quantity]) -> Observer:
        """What evaluates quantities of the unknowns x (n, 4)."""
        return Observer({name: heated_flow_quantity(self, name, quantity) for name, quantity in quantities.items()})

    @contextmanager
    def unmoved(self, nodes: np.ndarray) -> Iterator[None]:
        """Leave out the rate of a step and the velocity of its mesh where it moves these nodes (k,), while this lasts.

        Nodes of a wall take its temperature along, though the fluid that they pass has another one: at the wall these
        terms are heat of fluid that the wall sweeps, and none that passes it.
        """
        step, kept = self.step, self._kept
        if step is not None and step.mesh_velocity is not None and np.any(step.mesh_velocity[nodes]):
            self.step = replace(step, rate=0.0, past=np.zeros_like(step.past), mesh_velocity=None)
        try:
            yield
        finally:
            self.step, self._kept = step, kept

    def heat_residual(self, rest: np.ndarray) -> np.ndarray:
        """The heat (n,) [W/m] that a residual (n, 4) of the equations lacks at the nodes."""
        return rest[:, 3] / self.heat_factor

    def heat_parameters(self) -> np.ndarray:
        """Those (4,) of the equation of heat of all cells, or (ne, 4) with sources: capacity, conductivity, ..."""
        always = np.array([self.capacity, self.conductivity, self.heat_factor])
        rows = np.hstack([np.broadcast_to(always, (len(self._source), 3)), self._source])
        return rows if len(rows) > 1 else rows[0]

    # --- parts --------------------------------------------------------------------------------------------------------

    def _integral(self, family: Family, parameters: np.ndarray, given: Sequence[np.ndarray]) -> Integral:
        made = super()._integral(family, parameters, given)
        if not self.sources.varies:
            return made
        known = (made.element, made.X, made.entities, made.parameters)
        return SourcedIntegral(*known, coefficients=made.coefficients, source_rate=self.sources.rates)

    def _conditions(self) -> HeatedFlowConditions:
        return HeatedFlowConditions(self.scene, self.space)

    def _advecting(self) -> tuple[str, list[np.ndarray]]:
        """How the velocity is advected, and by which nodal velocity (n, 2) where that is no unknown."""
        moving = None if self.step is None else self.step.mesh_velocity
        return super()._advecting() if self.inertia or moving is None else ("mesh", [moving])

    def _parameters(self) -> np.ndarray:
        heat = self.heat_parameters()
        always = np.array([*super()._parameters(), *self.lift, self.neutral])
        return np.concatenate([np.broadcast_to(always, (*heat.shape[:-1], len(always))), heat], axis=-1)

    def _known_span(self) -> float:
        """The largest difference of temperatures that are prescribed, lift nothing, or were there before [K]."""
        known = [self.boundary.values[self.boundary.mask[:, 3] > 0, 3]]
        if self._pull:
            known.append(np.array([self.neutral]))
        if self.step is not None:
            known.append(-self.step.past[:, 2] / self.step.rate)
        values = np.concatenate(known)
        return float(np.ptp(values)) if len(values) else 0.0

    def _buoyant_speed(self, flux: float, width: float) -> float:
        """The velocity [m/s] that known temperatures, or a heat flux [W/m^2], may bring about over a width [m].

        That of free fall, or that of slow flow where it is smaller. Source of the one of a flux:
        J. W. Deardorff, J. Atmos. Sci. 27 (1970) 1211: that at which rising fluid takes the heat along.
        """
        lift, slow = self._pull / self.fluid.rho, width**2 * self.fluid.rho / self.fluid.mu
        of_span = min((lift * self._span * width) ** 0.5, lift * self._span * slow)
        rising = (lift * flux * width / self.capacity) ** (1.0 / 3.0)
        return max(of_span, min(rising, lift * flux * width / self.conductivity * slow))

    def _heat_factor(self, span: float) -> float:
        """The factor of the equation of heat [Pa m/(W/m)] that makes its residual one of forces; span [K] drives it."""
        speed, size = self._fastest, self.size
        dynamic = self.fluid.rho * speed**2 if self.inertia else 0.0
        lifted = self._pull * span * size
        force = size * (dynamic + self.fluid.mu / size * speed + lifted)
        heat = size * span * (self.capacity * speed + self.conductivity / size) + self._entering
        return force / heat if force > 0.0 and heat > 0.0 else self.fluid.mu / self.conductivity
