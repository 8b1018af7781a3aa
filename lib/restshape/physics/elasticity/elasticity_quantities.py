"""Quantities of interest of plane solids: functions of the displacement, and of the motion."""

# More than 15 modules: quantities of all kinds meet here, each kind of a module of its own.

from __future__ import annotations

from typing import Protocol

import numpy as np

from restshape.errors import UserError
from restshape.fem.assembled import Assembled
from restshape.fem.derivative import Derivative, Differentiable, nodal_quantity, reaction_lift
from restshape.fem.entity_sets import cells_around, observed_nodes
from restshape.fem.observer import Function, area_at, cells_at, column_reduced, reduction
from restshape.fem.positions import position_quantity
from restshape.fem.problem import FOLLOWERS, INTERNAL, LOADS, STIFFNESS, SteadyProblem
from restshape.fem.residuals import unconstrained_residual
from restshape.physics.elasticity.elasticity_scene_checks import elsewhere
from restshape.physics.elasticity.goal import Goal
from restshape.physics.elasticity.local_stress import at_few, local_stress
from restshape.physics.elasticity.nodal_stress import NodalStress
from restshape.physics.elasticity.shared_solid import KineticEnergies, SharedSolid
from restshape.physics.elasticity.stress import PlaneStresses
from restshape.physics.elasticity.target_curves import CurveDistances, GoalDistance
from restshape.scene.model import Quantity


class ObservedSolid(SteadyProblem, Protocol):
    """What quantities need of a solid in the plane beside a problem.

    Attributes:
        nodal_stress: of the nodes; stresses: of the cells; stiffness_params: of the cells.
        shared: what ranks observe together; None: each of them observes the whole.
    """

    nodal_stress: NodalStress
    stresses: PlaneStresses
    stiffness_params: np.ndarray
    shared: SharedSolid | None

    def energies(self, x: np.ndarray) -> np.ndarray:
        """Strain energies (ne,) [J] of the cells at the displacement x (n, 2) [m]."""


class PlaneQuantities:
    """Makes the functions of the displacement x (n, 2) [m] that quantities of a scene are.

    Stresses are recovered at nodes; at a node between materials each side has its own, and a quantity of a region takes
    that region's.

    Args:
        solid: on the space whose nodes are looked at.
    """

    def __init__(self, solid: ObservedSolid) -> None:
        self.solid, self.space = solid, solid.space
        self._around: dict[str, tuple[int, np.ndarray, list[str]]] = {}
        self._rest = np.empty((0, 2))
        self._goals: dict[tuple[str, str], tuple[Goal, int, CurveDistances]] = {}

    def __call__(self, name: str, quantity: Quantity) -> Function:
        """The function that a quantity of this name is.

        Raises:
            UserError: it has no meaning, or none where it is asked for.
        """
        if quantity.area:
            return area_at(self.space, name, quantity)
        if quantity.energy:
            cells = cells_at(self.space, name, quantity)
            energy = self.energy(quantity.energy, cells)
            return Differentiable(energy, lambda x: Derivative(self._internal_forces(x, cells), energy=cells))
        if quantity.distance:
            return self._distance(name, quantity)
        if (missing := elsewhere(quantity)) is not None:
            why, key, do = missing
            raise UserError(why, ".".join(("quantities", name, *key)), do)
        if quantity.position:
            return position_quantity(self.space, name, quantity, "xy".index(quantity.position))
        nodes = observed_nodes(self.space, name, quantity)
        if quantity.reaction:
            column = "xy".index(quantity.reaction)
            value = self.reaction(name, nodes, column)
            return Differentiable(
                value,
                lambda x: Derivative(np.zeros_like(x), reaction_lift(self.solid.boundary.mask, nodes, column)),
                lambda: np.unique(self.space.cells[self._cells(name, nodes)]),
            )
        if quantity.stress:
            return self._stress(quantity, nodes)
        reduce = reduction(self.space, quantity, nodes)
        if quantity.displacement == "magnitude":
            columns = [0, 1]
            return nodal_quantity(
                self.space, quantity, nodes, columns, lambda x, *_: reduce(np.hypot(x[nodes, 0], x[nodes, 1]))
            )
        column = "xy".index(quantity.displacement)
        return nodal_quantity(self.space, quantity, nodes, [column], column_reduced(reduce, nodes, column))

    def energy(self, kind: str, cells: np.ndarray | slice) -> Function:
        """The energy of that kind in the cells; a static solid has one kind only."""
        return self._strain(cells)

    def _strain(self, cells: np.ndarray | slice) -> Function:
        """The strain energy [J] of cells."""
        if self.solid.shared:
            return self.solid.shared.energy(cells)
        return lambda x, *_: self.solid.energies(x)[cells].sum()

    def reaction(self, name: str, nodes: np.ndarray, column: int) -> Function:
        """The component of the force [N] of supports at the nodes (k,): the residual there."""

        def force(x: np.ndarray, *_: object) -> float:
            if self._rest.shape != x.shape:
                self._rest = np.zeros(x.shape)
            # What was left at other nodes is never read: all of them again would take as long as the cells around few.
            self._rest[nodes] = 0.0
            cells, kinds = self._forces_at(name, nodes)
            return unconstrained_residual(self.solid, x, cells, self._rest, kinds)[nodes, column].sum()

        return force

    def _internal_forces(self, x: np.ndarray, cells: np.ndarray | slice) -> np.ndarray:
        """The derivative (n, 2) [N] of the strain energy of cells."""
        subset = None if isinstance(cells, slice) else np.asarray(cells, dtype=np.int32)
        return Assembled(self.solid.integrals(STIFFNESS)).residual(x, None, subset)

    def _stress(self, quantity: Quantity, nodes: np.ndarray | slice) -> Function:
        component, nodal = quantity.stress, self.solid.nodal_stress
        cells = self.space.cells_of(quantity.at) if quantity.at else np.empty(0, dtype=np.int32)
        if self.solid.shared:
            return self.solid.shared.extreme(component, str(quantity.reduce), nodes, cells)
        if not isinstance(nodes, slice) and at_few(self.solid, nodes):
            return local_stress(self.solid, quantity, nodes, cells)
        rows = nodal.recovery.rows(nodes, cells)
        reduce = reduction(self.space, quantity, nodal.recovery.nodes[rows])
        return lambda x, *_: reduce(nodal.component(component, x)[rows])

    def _distance(self, name: str, quantity: Quantity) -> Function:
        """The distance between a target curve and the deformed edges."""
        at = quantity.at or "outline"
        facets = self.space.facets[self.space.facets_of(at)]
        if len(facets) == 0:
            raise UserError(f"{at!r} has no edge", f"quantities.{name}.at", "name an edge, a hole or a group of them")
        distance = GoalDistance(self._distances(quantity.distance, at, facets), quantity.reduce)
        return lambda x, *_: distance(self.space.X + x)

    def _distances(self, name: str, at: str, facets: np.ndarray) -> CurveDistances:
        """The distances between a goal and the facets of an entity, the same for all quantities of both."""
        goal, topology = self.solid.scene.goal[name], self.space.topology
        known = self._goals.get((name, at))
        if known is None or known[:2] != (goal, topology):
            known = self._goals[name, at] = goal, topology, CurveDistances(goal, facets)
        return known[2]

    def _cells(self, name: str, nodes: np.ndarray) -> np.ndarray:
        """The cells around the nodes of a quantity, found once a topology."""
        return self._forces_at(name, nodes)[0]

    def _forces_at(self, name: str, nodes: np.ndarray) -> tuple[np.ndarray, list[str]]:
        """These cells, and the kinds of integrals with facets at the nodes: others take longer than the cells."""
        known = self._around.get(name)
        if known is None or known[0] != self.space.topology:
            # Flips leave facets as they are.
            kinds = self._kinds_at(nodes) if known is None else known[2]
            known = self._around[name] = (self.space.topology, cells_around(self.space, nodes), kinds)
        return known[1:]

    def _kinds_at(self, nodes: np.ndarray) -> list[str]:
        """The kinds of integrals over entities with any of the nodes."""
        on_facets = {kind: self.solid.integrals(kind) for kind in (LOADS, FOLLOWERS)}
        at = np.zeros(len(self.space.X), dtype=bool)
        at[nodes] = True
        touching = [kind for kind, some in on_facets.items() if any(at[one.entities].any() for one in some)]
        return [INTERNAL, *touching]


class MotionQuantities(PlaneQuantities):
    """Makes the functions of displacement x (n, 2) [m] and `Motion` that quantities of a solid that moves are.

    Args:
        solid: on the space whose nodes are looked at.
        kinetic: of the cells.
    """

    def __init__(self, solid: ObservedSolid, kinetic: KineticEnergies) -> None:
        super().__init__(solid)
        self.kinetic = kinetic

    def __call__(self, name: str, quantity: Quantity) -> Function:
        """The function that a quantity of this name is, frequencies included.

        Raises:
            UserError: it has no meaning, or none where it is asked for.
        """
        rank = quantity.number("frequency")
        if rank is None:
            return super().__call__(name, quantity)
        return lambda x, motion: next(iter(motion.eigenfrequencies[rank - 1 : rank]), np.nan)

    def reaction(self, name: str, nodes: np.ndarray, column: int) -> Function:
        """The component of the force [N] of supports at the nodes (k,), with their inertia and damping."""
        of_supports = super().reaction(name, nodes, column)
        return lambda x, motion: of_supports(x) + motion.inertia_and_damping[nodes, column].sum()

    def energy(self, kind: str, cells: np.ndarray | slice) -> Function:
        """The energy of that kind in the cells; what edits and new meshes did is that of the whole body."""
        strain, kinetic = self._strain(cells), self._kinetic(cells)
        functions: dict[str, Function] = {
            "strain": strain,
            "kinetic": kinetic,
            "total": lambda x, motion: strain(x, motion) + kinetic(x, motion),
            "edit": lambda x, motion: motion.edit,
            "remesh": lambda x, motion: motion.remesh,
        }
        return functions[kind]

    def _kinetic(self, cells: np.ndarray | slice) -> Function:
        """The kinetic energy [J] of cells."""
        if self.solid.shared:
            return self.solid.shared.kinetic_energy(self.kinetic, cells)
        return lambda x, motion: self.kinetic(motion.v, slice(None))[cells].sum()
