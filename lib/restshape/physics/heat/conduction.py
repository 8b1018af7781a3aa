"""Conduction of heat as a problem: integrals, boundary conditions, fluxes and estimate of a scene on one space."""

# More than 15 modules: materials, loads, supports and quantities make one problem here.
from collections.abc import Mapping

import numpy as np

from restshape.fem import problem as kinds
from restshape.fem.cell_samples import CellValues, Given
from restshape.fem.elements import CONDUCTION, HEAT_CAPACITY, LUMPED_HEAT_CAPACITY
from restshape.fem.error_estimate import RecoveryEstimate
from restshape.fem.integral import Integral
from restshape.fem.observer import Observer
from restshape.fem.problem import Fields, Inertia, TransientProblem, Unknown
from restshape.fem.region_materials import by_cell, table_by_region
from restshape.fem.space import Space
from restshape.fem.supports import scalar_dirichlet_of
from restshape.fem.time_integration import Theta, TimeIntegration
from restshape.physics.heat.heat_quantities import heat_quantity
from restshape.physics.heat.surface import SurfaceHeat
from restshape.scene.model import Quantity, Scene
from restshape.scene.plan import Plan

CAPACITIES = {kinds.CONSISTENT: HEAT_CAPACITY, kinds.LUMPED: LUMPED_HEAT_CAPACITY}


# More than 15 attributes: a problem holds what its integrals, loads and quantities share.
class HeatConduction(TransientProblem):
    """rho c dT/dt = div(k grad T) + source of one scene on one space, a `fem.problem.TransientProblem`.

    Args:
        scene: materials, supports and loads.
        plan: which effects are on.
        space: kept by reference; its nodes may move and its edges may flip, its nodes and cells keep their number.

    Attributes:
        materials: (regions + 1, 4) conductivity [W/(m K)], thickness [m], density [kg/m^3], specific heat [J/(kg K)].
        params, bare: of the cells, with sources and without; surfaces: fluxes and convections on edges.

    Raises:
        UserError: a part of the body has no material.

    Source: Lewis, Nithiarasu and Seetharamu, Fundamentals of the Finite Element Method for Heat and Fluid Flow (2004).
    """

    name = "heat"
    unknowns = (Unknown("temperature", "K", ("temperature",)),)
    cell_scalars = ("heat_flux",)
    symmetric = linear = True

    def __init__(self, scene: Scene, plan: Plan, space: Space) -> None:
        self.scene, self.plan, self.space = scene, plan, space
        self.materials = table_by_region(scene, space, lambda m: (m.conductivity, m.thickness, m.rho, m.specific_heat))
        given = [Given(f"loads.{key}.source", load.on, load.source) for key, load in scene.loads.items() if load.source]
        self.sources, self.surfaces = CellValues(space, given, scene.parameters), []
        thickness, blocks = self.materials[space.cell_region[space.facet_cell], 1], 0
        for key, load in scene.loads.items():
            blocks += load.kind == "convection"
            if load.kind != "source":
                self.surfaces.append(SurfaceHeat(key, scene, space, thickness, blocks))
        self.boundary = scalar_dirichlet_of(scene, space, self.unknowns[0])
        self.boundary.evaluate(space.X)
        self.bare = by_cell(np.pad(self.materials[:, :2], ((0, 0), (0, self.sources.points))), space.cell_region)
        self.params = self._with_sources()

    @property
    def varies(self) -> bool:
        """Whether a value changes when nodes move."""
        return any(part.varies for part in (self.sources, self.boundary, *self.surfaces))

    @property
    def stiffest(self) -> float:
        """The largest conductivity times thickness [W/K] of the materials."""
        return float(np.nanmax(self.materials[:, 0] * self.materials[:, 1]))

    @property
    def loaded_inside(self) -> bool:
        """Whether it enters by a source or by convection."""
        return bool(self.sources.given) or any(part.block for part in self.surfaces)

    def update(self) -> None:
        """Evaluate again what depends on the place of the nodes; nothing where all values are constant."""
        if self.varies:
            self.params = self._with_sources()
            self.boundary.evaluate(self.space.X)
            for part in self.surfaces:
                part.update()

    def blocks(self) -> list[np.ndarray]:
        """Entities (m, k) int32 that have a tangent: the cells, and the facets of each convection."""
        return [self.space.cells, *(part.facets for part in self.surfaces if part.block)]

    def integrals(self, kind: str, part: float = 1.0) -> list[Integral]:
        """The integrals of a kind at the present places of the nodes; see `fem.problem.SteadyProblem`."""
        if kind == kinds.FOLLOWERS:
            return []
        if kind == kinds.LOADS:
            return [one.integral for one in self.surfaces if not one.block]
        if kind in (kinds.MASS, kinds.LUMPED, kinds.CONSISTENT):
            return [self._capacity(f"{self.plan.settings('storage').capacity} mass" if kind == kinds.MASS else kind)]
        inside = kind == kinds.INTERNAL
        rate = self._source_rate if inside and self.sources.varies else None
        params, element = self.params if inside else self.bare, CONDUCTION[self.space.cell_type]
        conducted = Integral(element, self.space.X, self.space.cells, params, rate=rate)
        return [conducted, *((one.integral if inside else one.linear) for one in self.surfaces if one.block)]

    def _capacity(self, kind: str) -> Integral:
        capacity = by_cell(self.materials[:, 1:].prod(axis=1)[:, None], self.space.cell_region)
        return Integral(CAPACITIES[kind][self.space.cell_type], self.space.X, self.space.cells, capacity)

    def _with_sources(self) -> np.ndarray:
        """Parameters of the cells: one row where all agree, else one row a cell."""
        if not self.sources.given:
            return self.bare
        params = np.array(np.broadcast_to(self.bare, (len(self.space.cells), self.bare.shape[-1])))
        params[:, 2:] = self.sources()
        return params

    def _source_rate(self, dX: np.ndarray) -> np.ndarray:
        params = self.params * (np.arange(self.params.shape[1]) == 1)
        params[:, 2:] = self.sources.rates(dX)
        return params

    def initial(self) -> np.ndarray:
        """The temperature (n, 1) [K] at time 0."""
        return np.full(self.boundary.mask.shape, self.plan.settings("storage").initial)

    @staticmethod
    def time_integration(plan: Plan, before: TimeIntegration | None, now: float) -> TimeIntegration:
        """The theta method, as the plan asks for it."""
        settings = plan.settings("storage")
        return TimeIntegration(Theta(settings.theta, settings.time_step), settings.steps)

    def flux(self, x: np.ndarray, points: np.ndarray | None = None) -> np.ndarray:
        """Heat fluxes x, y, 0, 0 [W/m^2]: (ne, 4) at centroids, or (ne, m, 4) at reference points (m, 2)."""
        own = self.integrals(kinds.STIFFNESS)[0].stress(x, points)
        return np.concatenate([own, np.zeros_like(own)], axis=-1)

    def fields(self, x: np.ndarray) -> Fields:
        """Temperature [K] of the nodes, size of the heat flux [W/m^2] of the cells, at x (n, 1) [K]."""
        return {"temperature": x[:, 0]}, {"heat_flux": np.linalg.norm(self.flux(x), axis=1)}

    def observer(self, quantities: Mapping[str, Quantity], mass: Inertia | None = None) -> Observer:
        """What evaluates quantities of a temperature x (n, 1) [K]; in time with what the capacity `mass` takes up."""
        made = {name: heat_quantity(self, self.surfaces, mass, name, quantity) for name, quantity in quantities.items()}
        return Observer(made, peaks=[name for name, q in quantities.items() if mass and q.reduce == "peak"])

    motion_observer = observer

    def energy_moduli(self) -> np.ndarray:
        """0, half of the conductivity [W/(m K)], and thickness [m], (ne, 3): of k |grad T|^2 by area."""
        return np.insert(self.materials[:, :2] * (0.5, 1.0), 0, 0.0, axis=1)[self.space.cell_region]

    def error_estimate(self) -> RecoveryEstimate:
        """The recovery-based estimate in the norm of the fluxes' dissipation."""
        resistance = (self.materials[:, 1] / self.materials[:, 0])[:, None, None] * np.diag([1.0, 1.0, 0.0, 0.0])
        return RecoveryEstimate(self.space, self.flux, resistance, self.stiffest)
