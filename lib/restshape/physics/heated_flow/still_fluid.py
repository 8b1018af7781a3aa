"""Heat in a fluid that does not flow: conduction as a problem of a scene on one space."""

# More than 15 modules: conditions, sources, border and quantities make one problem here.

from collections.abc import Mapping
from contextlib import AbstractContextManager, nullcontext

import numpy as np

from restshape.fem import problem as kinds
from restshape.fem.cell_samples import CellValues, Given
from restshape.fem.dirichlet import Dirichlet
from restshape.fem.elements import CONDUCTION
from restshape.fem.error_estimate import RecoveryEstimate
from restshape.fem.integral import Integral
from restshape.fem.observer import Function, Observer, area_at
from restshape.fem.problem import Fields, Inertia, TransientProblem, Unknown
from restshape.fem.space import Space
from restshape.physics.heat.conduction import CAPACITIES, HeatConduction
from restshape.physics.heated_flow.border_heat import BorderHeat
from restshape.physics.heated_flow.fluid_heat import heat_properties
from restshape.physics.heated_flow.heated_flow_conditions import prescribed_temperatures
from restshape.physics.heated_flow.heated_flow_quantities import EdgeHeat, heat_quantity, isothermal_quantity
from restshape.physics.heated_flow.temperature_differences import initial, uniform
from restshape.scene.model import Quantity, Scene
from restshape.scene.plan import Plan


# More than 15 attributes: a problem holds what its integrals, conditions and quantities share.
class StillFluid(TransientProblem):
    """C dT/dt = k laplace T + s of the fluid of one scene on one space; a `fem.problem.TransientProblem`.

    Args:
        scene: fluid, boundaries and sources.
        plan: which effects are on.
        space: kept by reference; its nodes may move and its edges may flip, its nodes and cells keep their number.

    Source: docs/theory/heat.md.
    """

    name = "still_fluid"
    unknowns = (Unknown("temperature", "K", ("temperature",)),)
    symmetric = linear = varies = True
    time_step_key = "effects.storage.time_step"

    def __init__(self, scene: Scene, plan: Plan, space: Space) -> None:
        self.scene, self.plan, self.space, self.neutral = scene, plan, space, uniform(scene)
        self.capacity, self.conductivity = heat_properties(scene)
        given = [Given(f"heat.{name}.source", one.on, one.source) for name, one in scene.heat.items()]
        self.sources, self.border = CellValues(space, given, scene.parameters), BorderHeat(scene, space)
        self.mass: Inertia | None = None
        self.heats: dict[str, EdgeHeat] = {}
        conditions = [*prescribed_temperatures(scene, space, 0)]
        self.boundary = Dirichlet((len(space.X), 1), conditions, scene.parameters | {"t": 0.0}, "K")
        self.update()

    def start(self) -> np.ndarray:
        """The temperature (n, 1) [K] that everything has where none differs."""
        return np.full(self.boundary.mask.shape, self.neutral)

    @property
    def stiffest(self) -> float:
        """The conductivity [W/(m K)]."""
        return self.conductivity

    @property
    def loaded_inside(self) -> bool:
        """Whether heat enters by a source, or by the border."""
        return bool(self.sources.given) or self.border.largest > 0.0

    def update(self) -> None:
        """Evaluate again what depends on the place of the nodes."""
        self.boundary.evaluate(self.space.X)
        self._source = self.sources() if self.sources.given else np.zeros((1, 1))

    def blocks(self) -> list[np.ndarray]:
        """Entities (m, 3) int32 that have a tangent: the cells."""
        return [self.space.cells]

    def integrals(self, kind: str, part: float = 1.0) -> list[Integral]:
        """The integrals of a kind at the present places of the nodes; see `fem.problem.SteadyProblem`."""
        if kind in (kinds.LOADS, kinds.FOLLOWERS):
            return []
        if kind in (kinds.MASS, kinds.LUMPED, kinds.CONSISTENT):
            wanted = f"{self.plan.settings('storage').capacity} mass" if kind == kinds.MASS else kind
            capacity = CAPACITIES[wanted][self.space.cell_type]
            return [Integral(capacity, self.space.X, self.space.cells, np.array([self.capacity]))]
        inside = kind == kinds.INTERNAL
        source = self._source if inside else np.zeros((1, 1))
        parameters = np.insert(source, 0, [[self.conductivity], [1.0]], axis=1)
        if len(parameters) == 1:
            parameters = parameters[0]
        rate = self._source_rate if inside and self.sources.varies else None
        space = self.space
        return [Integral(CONDUCTION[space.cell_type], space.X, space.cells, parameters, rate=rate)]

    def _source_rate(self, dX: np.ndarray) -> np.ndarray:
        return np.insert(self.sources.rates(dX), 0, [[0.0], [1.0]], axis=1)

    def add_nodal_loads(self, out: np.ndarray, sign: float, cells: np.ndarray | None = None) -> None:
        """Add `sign` times the heat that enters by the border to `out` (n, 1); see `fem.problem.SteadyProblem`."""
        out[:, 0] += sign * self.border.loads(cells)

    def add_nodal_load_rates(self, dX: np.ndarray, out: np.ndarray) -> None:
        """Take the rates of this heat, when nodes move with rates dX (n, 2), from `out` (n, 1)."""
        out[:, 0] -= self.border.rates(dX)

    def initial(self) -> np.ndarray:
        """The temperature (n, 1) [K] at time 0."""
        return np.full(self.boundary.mask.shape, initial(self.scene))

    time_integration = staticmethod(HeatConduction.time_integration)

    def fields(self, x: np.ndarray) -> Fields:
        """Temperature [K] of the nodes at x (n, 1)."""
        return {"temperature": x[:, 0]}, {}

    def observer(self, quantities: Mapping[str, Quantity], mass: Inertia | None = None) -> Observer:
        """What evaluates quantities of a temperature x (n, 1); in time with what the capacity `mass` takes up."""
        self.mass = mass
        return Observer({name: self._function(name, one) for name, one in quantities.items()})

    motion_observer = observer

    def _function(self, name: str, quantity: Quantity) -> Function:
        if quantity.kind == "area":
            return area_at(self.space, name, quantity)
        if not (self.plan.on("temperature_difference") or self.plan.on("storage")):
            return isothermal_quantity(self.neutral, name, quantity)
        return heat_quantity(self, name, quantity)

    def flux(self, x: np.ndarray, points: np.ndarray | None = None) -> np.ndarray:
        """Heat fluxes x, y, 0, 0 [W/m^2]: (ne, 4) at centroids, or (ne, m, 4) at reference points (m, 2)."""
        own = self.integrals(kinds.STIFFNESS)[0].stress(x, points)
        return np.concatenate([own, np.zeros_like(own)], axis=-1)

    def energy_moduli(self) -> np.ndarray:
        """0, half of the conductivity [W/(m K)], and a depth of 1 m, (3,): of k |grad T|^2 by area."""
        return np.array([0.0, 0.5 * self.conductivity, 1.0])

    def error_estimate(self) -> RecoveryEstimate:
        """The recovery-based estimate in the norm of the fluxes' dissipation."""
        resistance = np.diag([1.0, 1.0, 0.0, 0.0]) / self.conductivity
        return RecoveryEstimate(self.space, self.flux, resistance[None], self.stiffest)

    def unmoved(self, nodes: np.ndarray) -> AbstractContextManager[None]:
        """Nothing is left out: the temperature of a fluid that does not flow knows no velocity of the mesh."""
        return nullcontext()

    def heat_residual(self, rest: np.ndarray) -> np.ndarray:
        """The heat (n,) [W/m] that a residual (n, 1) of the equation lacks at the nodes."""
        return rest[:, 0]
