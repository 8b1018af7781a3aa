"""Elastic solids in the plane as a problem: integrals, supports, loads and stresses of a scene on one space."""

# More than 15 modules: laws, loads, supports, stresses and quantities make one problem here.

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from functools import cached_property

import numpy as np
from petsc4py import PETSc

from restshape.algebra.reuse.traits import Traits
from restshape.errors import UserError
from restshape.fem.elements import LINEAR_ELASTIC, LINEAR_ELASTIC_DILATATION, LUMPED_MASS, STVK, STVK_DILATATION
from restshape.fem.elements import MASS as MASS_ELEMENTS
from restshape.fem.error_estimate import RecoveryEstimate
from restshape.fem.facets import SHAPES
from restshape.fem.integral import Integral
from restshape.fem.observer import Observer
from restshape.fem.part_space import pays
from restshape.fem.problem import (
    CONSISTENT,
    FOLLOWERS,
    INTERNAL,
    LOADS,
    LUMPED,
    MASS,
    REFERENCE,
    STIFFNESS,
    Fields,
    Inertia,
    TransientProblem,
    Unknown,
)
from restshape.fem.region_materials import by_cell, table_by_region
from restshape.fem.space import Space
from restshape.fem.supports import dirichlet_of
from restshape.fem.time_integration import Newmark, Rayleigh, TimeIntegration
from restshape.physics.elasticity.base_excitation import base_excitation
from restshape.physics.elasticity.body_load import require_density
from restshape.physics.elasticity.elasticity_quantities import MotionQuantities, PlaneQuantities
from restshape.physics.elasticity.loads import PlaneLoads
from restshape.physics.elasticity.nodal_stress import NodalStress, blank_stress
from restshape.physics.elasticity.rigid_body_modes import check_rigid_body_modes
from restshape.physics.elasticity.shared_solid import EXTREMES, SharedSolid
from restshape.physics.elasticity.stiffness import lame
from restshape.physics.elasticity.stress import PlaneStresses, plane_compliance
from restshape.scene.model import Quantity, Scene
from restshape.scene.plan import Plan

MASSES = {CONSISTENT: MASS_ELEMENTS, LUMPED: LUMPED_MASS}


# More than 15 attributes: a problem holds what its integrals, loads and quantities share.
class PlaneSolid(TransientProblem):
    """Elasticity of one scene on one space, a `fem.problem.TransientProblem`.

    The law is linear, or that of St. Venant and Kirchhoff under the effect `large_deformation`: pressures then act on
    the deformed boundary; all other loads are dead.

    Args:
        scene: materials, loads and supports.
        plan: which effects are on.
        space: kept by reference; its nodes may move and its edges may flip, its nodes and cells keep their number.

    Attributes:
        element: of the law; small: of linear elasticity with the same parameters.
        materials: (regions + 1, 4) lambda, mu [Pa], thickness [m], density [kg/m^3].
        stiffness_params: lambda, mu, thickness, 0, 0 of the cells, (5,) or (ne, 5).
        loads: on points, edges and the volume.
        shared: what ranks observe together; None: each of them observes the whole.
        stresses: of the cells; nodal_stress: of the nodes.

    Raises:
        UserError: the supports leave the body free to move, or a part of it has no material.

    Source: docs/theory/solids.md.
    """

    name, name_in_time, time_step_key = "solid", "motion", "effects.dynamics.time_step"
    unknowns = (Unknown("displacement", "m", ("x", "y")),)
    rigid_motions = True

    def __init__(self, scene: Scene, plan: Plan, space: Space) -> None:
        shape, model = SHAPES[space.cells.shape[1]][0], plan.settings("solid").model
        self.scene, self.space, self.plan = scene, space, plan
        self.linear = not plan.on("large_deformation")
        self.averaged = plan.settings("solid").element == "mean_dilatation"
        small, large = (LINEAR_ELASTIC_DILATATION, STVK_DILATATION) if self.averaged else (LINEAR_ELASTIC, STVK)
        self.small, self.element = small[shape], (small if self.linear else large)[shape]
        stress = model == "plane_stress"
        self.materials = table_by_region(scene, space, lambda m: (*lame(m, stress), m.thickness, m.rho))
        self.gravity = np.array(plan.settings("gravity").g) if plan.on("gravity") else None
        self._made: dict[str, list[Integral]] = {}
        self._made_at: np.ndarray | None = None
        self.loads = PlaneLoads(scene, space, self.materials[:, 2], not self.linear)
        self.params, self.stiffness_params = self._cell_params()
        self.stresses = PlaneStresses(space, self.element, self.stiffness_params, not self.linear, stress)
        self.nodal_stress = NodalStress(self.stresses)
        require_density(scene, self.gravity)
        self.boundary = dirichlet_of(scene, space, self.unknowns)
        check_rigid_body_modes(space.X, self.boundary.mask, scene)
        self.boundary.evaluate(space.X)
        self.symmetric = not self.loads.followers
        self.shared: SharedSolid | None = None

    # --- a problem -------------------------------------------------------------------------------------------------

    @property
    def varies(self) -> bool:
        """Whether a value changes when nodes move."""
        return self.loads.varies or self.boundary.varies

    @property
    def nested(self) -> PlaneSolid:
        """Without the dilatation where elements take its mean: those of smaller triangles are others."""
        if not self.averaged:
            return self
        part = copy(self)
        part._made = {}
        part.params, part.stiffness_params = self.params.copy(), self.stiffness_params.copy()
        for params in (part.params, part.stiffness_params):
            params[..., 0] = 0.0
        return part

    @cached_property
    def stiffest(self) -> float:
        """The largest modulus times thickness [N/m] of the materials."""
        lame, shear, thickness, _ = self.materials.T
        return float(np.nanmax((lame + 2.0 * shear) * thickness))

    @property
    def load_steps(self) -> int:
        """Steps of load that are tried at most where the law is not linear."""
        return self.plan.settings("large_deformation").load_steps

    @property
    def loaded(self) -> bool:
        """Whether there is any load."""
        return self.gravity is not None or bool(self.scene.loads)

    @property
    def loaded_inside(self) -> bool:
        """Whether there is a load on the volume."""
        return self.gravity is not None or bool(self.loads.body.of_cells)

    def update(self) -> None:
        """Evaluate again what depends on the place of the nodes; nothing where all values are constant."""
        if self.varies:
            self.params, self.stiffness_params = self._cell_params()
            self._made.clear()
            self.boundary.evaluate(self.space.X)
            self.loads.update()

    def blocks(self) -> list[np.ndarray]:
        """Entities (m, k) int32 that have a tangent: the cells, and the facets of each pressure that follows."""
        return [self.space.cells, *(part.facets for part in self.loads.followers)]

    def integrals(self, kind: str, part: float = 1.0) -> list[Integral]:
        """The integrals of a kind at the present places of the nodes; see `fem.problem.SteadyProblem`.

        Raises:
            UserError: inertia of a material without density.
        """
        if kind == FOLLOWERS:
            return self.loads.follower(part)
        # Made once: they have places, cells and parameters by reference.
        if self._made_at is not self.space.X:
            self._made_at = self.space.X
            self._made.clear()
        known = self._made.get(kind)
        if known is None:
            known = self._made[kind] = self._integrals(kind)
        return known

    def _integrals(self, kind: str) -> list[Integral]:
        """Those integrals that do not grow with a part of the load."""
        X, cells = self.space.X, self.space.cells
        if kind == INTERNAL:
            rate = self._body_rate if self.loads.body.of_cells else None
            return [Integral(self.element, X, cells, self.params, rate=rate)]
        if kind == LOADS:
            return self.loads.on_edges()
        if kind == STIFFNESS:
            return [Integral(self.element, X, cells, self.stiffness_params)]
        if kind == REFERENCE:
            return [Integral(self.small, X, cells, self.stiffness_params)]
        return [self._mass(f"{self.plan.settings('dynamics').mass} mass" if kind == MASS else kind)]

    def _mass(self, kind: str) -> Integral:
        """The integral of the mass of the cells, `CONSISTENT` or `LUMPED`.

        Lumped by the sums of rows; of second order, where those of corners are 0, by the diagonal scaled to the mass.

        Raises:
            UserError: a material has no density.
        """
        region = self.space.cell_region
        thickness, density = self.materials[:, 2], self.materials[:, 3]
        # Regions that fill the shape leave no cell to row 0, whose material may not exist.
        if not np.all(density[np.flatnonzero(np.bincount(region))] > 0):
            raise UserError(
                "a body without density cannot vibrate",
                "material",
                'give each material its rho, e.g. rho = "2400 kg/m^3"',
            )
        element = MASSES[kind][SHAPES[self.space.cells.shape[1]][0]]
        return Integral(element, self.space.X, self.space.cells, by_cell((density * thickness)[:, None], region))

    def add_nodal_loads(self, out: np.ndarray, sign: float, cells: np.ndarray | None = None) -> None:
        """Add `sign` times the loads that no integral gives to `out` (n, 2) [N]; see `fem.problem`."""
        self.loads.add_nodal(out, sign, cells)

    def add_nodal_load_rates(self, dX: np.ndarray, out: np.ndarray) -> None:
        """Take the rates of these loads, when nodes move with rates dX (n, 2), from `out` (n, 2) [N]."""
        self.loads.add_nodal_rates(dX, out)

    def share(self, comm: PETSc.Comm) -> None:
        """Let ranks share quantities and estimates, where that is faster; see `fem.problem.SteadyProblem`."""
        wanted = [q.reduce for q in self.scene.quantities.values() if q.stress]
        if pays(comm, self.space) and all(how in EXTREMES for how in wanted):
            self.shared = SharedSolid(comm, self)

    def objection(self, x: np.ndarray) -> str:
        """What is wrong with a displacement x (n, 2) [m] that cells cannot bear; empty where nothing is."""
        return self.stresses.objection(x)

    # --- what is observed ------------------------------------------------------------------------------------------

    def fields(self, x: np.ndarray) -> Fields:
        """Displacement [m], recovered stresses [Pa] and what is asked for at x (n, 2) [m]: `NodalStress.fields`."""
        points, cells = self.nodal_stress.fields(x, self.scene.quantities, self.scene.recording.fields)
        return {"displacement": x, **points}, cells

    @classmethod
    def blank_fields(cls, space: Space) -> Fields:
        """The same fields, all NaN, on a space that has not been solved on."""
        (points, cells), stress = super().blank_fields(space), blank_stress(space)
        return {**points, **stress[0]}, {**cells, **stress[1]}

    def observer(self, quantities: Mapping[str, Quantity]) -> Observer:
        """What evaluates quantities of a displacement x (n, 2) [m].

        Raises:
            UserError: a quantity has no meaning, or none where it is asked for.
        """
        functions = PlaneQuantities(self)
        return Observer({name: functions(name, quantity) for name, quantity in quantities.items()})

    @staticmethod
    def traits(plan: Plan) -> Traits:
        """What it declares of its linear systems under a plan."""
        return Traits(plan.solver.symmetric, rigid_motions=PlaneSolid.rigid_motions)

    @staticmethod
    def time_integration(plan: Plan, before: TimeIntegration | None, now: float) -> TimeIntegration:
        """Newmark's method, Rayleigh damping and the ground's motion, as the plan asks for them."""
        settings, ground = plan.settings("dynamics"), plan.settings("ground")
        scheme = Newmark(settings.beta, settings.gamma, settings.time_step)
        excitation = None
        if ground is not None:
            excitation = base_excitation(ground, before.excitation if before else None, now)
        return TimeIntegration(scheme, settings.steps, Rayleigh.of(plan.settings("damping")), excitation)

    @staticmethod
    def accounts_energy(quantities: Mapping[str, Quantity]) -> bool:
        """Whether one of these quantities is the work of edits, or what new meshes have added."""
        return any(quantity.energy in ("edit", "remesh") for quantity in quantities.values())

    def motion_observer(self, quantities: Mapping[str, Quantity], mass: Inertia) -> Observer:
        """What evaluates quantities of a displacement x (n, 2) [m] and a `fem.time_integration.Motion`.

        Raises:
            UserError: a quantity has no meaning, or none where it is asked for.
        """
        functions = MotionQuantities(self, mass.energies)
        made = {name: functions(name, quantity) for name, quantity in quantities.items()}
        return Observer(made, [name for name, q in quantities.items() if q.reduce == "peak"])

    def energy_moduli(self) -> np.ndarray:
        """lambda, mu [Pa] and thickness [m], (3,) or (ne, 3)."""
        return self.stiffness_params[..., :3]

    def error_estimate(self) -> RecoveryEstimate:
        """The recovery-based estimate in the energy norm, of small or large strains."""
        lame, shear, thickness, _ = self.materials.T
        compliance = plane_compliance(lame, shear, thickness)
        # Of small strains the norm takes the stresses that quantities take, zz apart, which has no part in it.
        if self.shared:
            return self.shared.estimate(compliance, self.stiffest)
        shared = self.nodal_stress if self.linear else None
        return RecoveryEstimate(self.space, self.stresses.of_estimate, compliance, self.stiffest, shared)

    def energies(self, x: np.ndarray) -> np.ndarray:
        """Strain energies (ne,) [J] of the cells at the displacement x (n, 2) [m]; they sum to half of x . K x."""
        found = self.nodal_stress.energies(x)
        return self.integrals(STIFFNESS)[0].energies(x) if found is None else found

    # --- parts -----------------------------------------------------------------------------------------------------

    def _cell_params(self) -> tuple[np.ndarray, np.ndarray]:
        """Parameters lambda, mu, thickness, bx, by with body forces, and without: their potential is no strain energy.

        One row where all cells agree, else one row a cell.
        """
        table = np.zeros((len(self.materials), 5))
        table[:, :3] = self.materials[:, :3]
        stiffness = table.copy()
        if self.gravity is not None:
            table[:, 3:] = self.materials[:, 3:4] * self.gravity
        region = self.space.cell_region
        if not self.loads.body.of_cells and not np.any(region):
            return np.ascontiguousarray(table[0]), np.ascontiguousarray(stiffness[0])
        params = np.ascontiguousarray(table[region])
        self.loads.body.add_to_cells(params)
        return params, np.ascontiguousarray(stiffness[region])

    def _body_rate(self, dX: np.ndarray) -> np.ndarray:
        return self.loads.body.cell_rates(dX, 5)
