"""Quantities of interest of flow: forces on edges, pressures, speeds, discharges and energy."""

from collections.abc import Callable, Mapping
from typing import Protocol

import numpy as np

from restshape.errors import UserError
from restshape.fem.edge_reactions import EdgeReactions
from restshape.fem.elements import MASS
from restshape.fem.entity_sets import cells_around, observed_nodes
from restshape.fem.integral import Integral
from restshape.fem.observer import Function, area_at, reduction
from restshape.fem.problem import INTERNAL, SteadyProblem
from restshape.fem.residuals import unconstrained_residual
from restshape.physics.flow.flow_conditions import FlowConditions
from restshape.physics.flow.flow_declaration import Fluid
from restshape.scene.model import Quantity

AXES = {"drag": 0, "lift": 1}


class ObservedFlow(SteadyProblem, Protocol):
    """What quantities see of a flow.

    Attributes:
        fluid: of the scene; conditions: at the border of the space; forces: on edges, by their names.
    """

    fluid: Fluid
    conditions: FlowConditions
    forces: "dict[str, EdgeForce]"

    def pressure(self, x: np.ndarray) -> np.ndarray:
        """Pressures (n,) [Pa] of the unknowns x (n, 3)."""


class EdgeForce:
    """The force of the fluid on an edge [N/m]: what the residual of its nodes lacks.

    Args:
        problem: on the space whose nodes are looked at.
        edge: an entity on the border.

    Source: P. M. Gresho, R. L. Lee, R. L. Sani, M. K. Maslanik and B. E. Eaton, Int. J. Numer. Methods Fluids 7 (1987)
    1111: the consistent flux.
    """

    def __init__(self, problem: ObservedFlow, edge: str) -> None:
        self.problem, self.edge = problem, edge
        self._on = EdgeReactions(problem.space, edge, problem.conditions.constrained_edges)
        self._slips = problem.conditions.slips_at(edge)
        self._around: tuple[int, np.ndarray] = -1, self._on.nodes
        self._known: tuple[list[Integral], np.ndarray, np.ndarray, np.ndarray] | None = None

    def __call__(self, x: np.ndarray) -> np.ndarray:
        """Both components (2,) at unknowns x (n, 3); those of the last state are kept, for drag and lift."""
        X, integrals = self.problem.space.X, self.problem.integrals(INTERNAL)
        known = self._known
        if known is None or known[0] is not integrals or not (known[1] == x).all() or not (known[2] == X).all():
            self._known = known = integrals, x.copy(), X.copy(), self._evaluate(x)
        return known[3]

    def _evaluate(self, x: np.ndarray) -> np.ndarray:
        problem, space, on = self.problem, self.problem.space, self._on
        if self._around[0] != space.topology:
            self._around = space.topology, cells_around(space, on.nodes)
        force = -on.parts() @ unconstrained_residual(problem, x, self._around[1])[on.nodes, :2]
        return force + problem.fluid.mu * problem.conditions.normal_friction(self.edge, x) if self._slips else force


def flow_quantity(problem: ObservedFlow, name: str, quantity: Quantity) -> Function:
    """The function of the unknowns x (n, 3) that a quantity of this name is.

    Args:
        problem: on the space whose nodes are looked at.
        name, quantity: as the scene has them.

    Raises:
        UserError: there is nothing where it is asked for.
    """
    space, kind = problem.space, quantity.kind
    if kind == "area":
        return area_at(space, name, quantity)
    if kind == "kinetic":
        return _kinetic(problem)
    if kind == "flux":
        return flux(problem, quantity.at)
    if kind == "pressure_drop":
        return _pressure_drop(problem, name, quantity)
    axis = AXES.get(kind.removesuffix("_coefficient"))
    if axis is not None:
        return _force(problem, name, quantity, axis)
    if kind == "strouhal":
        # Of one state there is none: `FlowInTimeAnalysis` knows how the lift has swung.
        return lambda x: np.nan
    nodes = observed_nodes(space, name, quantity)
    reduce = reduction(space, quantity, nodes)
    if kind == "pressure":
        return lambda x: reduce(problem.pressure(x)[nodes])
    return lambda x: reduce(lengths(x[nodes]))


def swinging_lifts(problem: ObservedFlow, quantities: Mapping[str, Quantity]) -> dict[str, Function]:
    """The coefficients of lift, functions of the unknowns x (n, 3), by the names of quantities that count its swings.

    Raises:
        UserError: there is nothing where one is asked for.
    """
    return {
        name: _force(problem, name, one, AXES["lift"]) for name, one in quantities.items() if one.kind == "strouhal"
    }


def _unit(problem: ObservedFlow, quantity: Quantity) -> float:
    """What a force is counted in [N]: 1, or of a coefficient rho speed^2 length depth / 2."""
    if quantity.kind in AXES:
        return 1.0
    of = getattr(quantity, quantity.kind)
    return 0.5 * problem.fluid.rho * of.speed**2 * of.length * problem.fluid.depth


def _force(problem: ObservedFlow, name: str, quantity: Quantity, axis: int) -> Callable[[np.ndarray], float]:
    """The force of the fluid on an edge along an axis, in its unit."""
    edge, factor = quantity.at, problem.fluid.depth / _unit(problem, quantity)
    if any(problem.conditions.is_outflow(k) for k in problem.space.outline.entity(edge).edges):
        what = f"the fluid leaves by {edge!r}, so that there is no force on it"
        raise UserError(what, f"quantities.{name}.at", "name a wall")
    if edge not in problem.forces:
        problem.forces[edge] = EdgeForce(problem, edge)
    force = problem.forces[edge]
    return lambda x: factor * float(force(x)[axis])


def flux(problem: ObservedFlow, edge: str) -> Callable[[np.ndarray], float]:
    """What leaves by an edge [m^3/s]."""
    space = problem.space
    facets = space.facets_of(edge)
    return lambda x: problem.fluid.depth * float(problem.conditions.fluxes(space.facets[facets], x[:, :2]).sum())


def _pressure_drop(problem: ObservedFlow, name: str, quantity: Quantity) -> Callable[[np.ndarray], float]:
    """The mean pressure of one place less that of another [Pa]."""
    space, ends = problem.space, quantity.pressure_drop
    parts = []
    for place in (ends.start, ends.to):
        here = quantity.model_copy(update={"at": place, "reduce": "mean"})
        nodes = observed_nodes(space, name, here)
        parts.append((nodes, reduction(space, here, nodes)))
    (first, mean), (last, other) = parts
    return lambda x: mean(x[first, 2]) - other(x[last, 2])


def _kinetic(problem: ObservedFlow) -> Callable[[np.ndarray], float]:
    """The kinetic energy [J] of all of the fluid."""
    space, fluid = problem.space, problem.fluid
    density = np.array([fluid.rho * fluid.depth])

    def energy(x: np.ndarray) -> float:
        mass = Integral(MASS[space.cell_type], space.X, space.cells, density)
        return float(mass.energies(np.ascontiguousarray(x[:, :2])).sum())

    return energy


def lengths(x: np.ndarray) -> np.ndarray:
    """Of velocities, the first two columns of x (n, f): (n,); a third of the time of `numpy.linalg.norm`."""
    u, v = x[:, 0], x[:, 1]
    return np.sqrt(u * u + v * v)
