"""Quantities of interest of heat in a fluid: temperatures, heat that passes edges, Nusselt numbers."""

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from typing import Protocol

import numpy as np

from restshape.fem.edge_reactions import EdgeReactions
from restshape.fem.entity_sets import cells_around, observed_nodes
from restshape.fem.integral import Integral
from restshape.fem.observer import Function, reduction
from restshape.fem.problem import INTERNAL, Inertia, SteadyProblem
from restshape.fem.residuals import unconstrained_residual
from restshape.fem.space import PlaneSpace
from restshape.fem.time_integration import Motion
from restshape.physics.flow.flow_quantities import ObservedFlow, flow_quantity
from restshape.physics.heated_flow.border_heat import BorderHeat
from restshape.physics.heated_flow.heated_flow_conditions import check_edge, warm_edges
from restshape.scene.model import Quantity

KINDS = ("temperature", "bulk_temperature", "heat_flow", "nusselt")


# More than 15 attributes: those of any problem, and of heat.
class ObservedHeat(SteadyProblem, Protocol):
    """What quantities see of heat in a fluid, whose temperature is the last column of the unknowns.

    Attributes:
        capacity: by volume [J/(m^3 K)]; conductivity: [W/(m K)]; neutral: temperature from which advected heat counts.
        border: given heat fluxes; heats: heat through edges by their names, as quantities have asked for it.
        mass: what takes heat up besides the integrals, in time; None: nothing.
    """

    capacity: float
    conductivity: float
    neutral: float
    border: BorderHeat
    heats: "dict[str, EdgeHeat]"
    mass: Inertia | None

    def unmoved(self, nodes: np.ndarray) -> AbstractContextManager[None]:
        """Leave out what the motion of these nodes (k,) adds to the residual, while this lasts."""

    def heat_residual(self, rest: np.ndarray) -> np.ndarray:
        """The heat (n,) [W/m] that a residual (n, f) of the equations lacks at the nodes."""


# More than 15 attributes: a flow has its own, and those of heat.
class ObservedHeatedFlow(ObservedHeat, ObservedFlow, Protocol):
    """What quantities see of a flow that carries heat."""


def heated_flow_quantity(problem: ObservedHeatedFlow, name: str, quantity: Quantity) -> Function:
    """The function of the unknowns x (n, 4) that a quantity of this name is; arguments as of `flow_quantity`.

    Raises:
        UserError: there is nothing where it is asked for.
    """
    if quantity.kind not in KINDS:
        return flow_quantity(problem, name, quantity)
    if quantity.kind == "bulk_temperature":
        check_edge(problem.scene, problem.space.outline, name, quantity)
        return _bulk_temperature(problem, quantity.at)
    if quantity.kind != "heat_flow":
        return heat_quantity(problem, name, quantity)
    conducted, advected = heat_quantity(problem, name, quantity), _advected(problem, quantity.at)
    return lambda x: conducted(x) + advected(x)


def heat_quantity(problem: ObservedHeat, name: str, quantity: Quantity) -> Function:
    """Likewise, of the temperature in the last column of x, and of heat that is conducted alone."""
    space = problem.space
    if quantity.kind == "temperature":
        return _temperature(space, name, quantity)
    check_edge(problem.scene, space.outline, name, quantity)
    if quantity.at not in problem.heats:
        problem.heats[quantity.at] = EdgeHeat(problem, quantity.at)
    leaving = problem.heats[quantity.at]
    if quantity.kind == "heat_flow":
        return lambda x, *motion: problem.scene.fluid.depth * leaving(x, *motion)
    of, facets = quantity.nusselt, space.facets[space.facets_of(quantity.at)]
    factor = -of.length / problem.conductivity
    if of.against is None:
        return lambda x, *motion: factor * leaving(x, *motion) / (_length(space.X, facets) * of.difference)
    here, there = (
        _temperature(space, name, quantity.model_copy(update={"at": at, "reduce": "mean"}))
        for at in (quantity.at, of.against)
    )

    def number(x: np.ndarray, *motion: Motion) -> float:
        warmer = here(x) - there(x)
        return factor * leaving(x, *motion) / (_length(space.X, facets) * warmer) if warmer else np.nan

    return number


def _temperature(space: PlaneSpace, name: str, quantity: Quantity) -> Function:
    """The temperature [K] of an entity, reduced as the quantity says."""
    nodes = observed_nodes(space, name, quantity)
    reduce = reduction(space, quantity, nodes)
    return lambda x, *_: reduce(x[nodes, -1])


def _bulk_temperature(problem: ObservedHeatedFlow, edge: str) -> Callable[[np.ndarray], float]:
    """The mean temperature [K] of what flows through an edge: weighted by the velocity across it."""
    space = problem.space
    facets = space.facets[space.facets_of(edge)]

    def mean(x: np.ndarray) -> float:
        along = space.X[facets[:, 1]] - space.X[facets[:, 0]]
        across = x[facets, 0] * along[:, 1, None] - x[facets, 1] * along[:, 0, None]
        weights = (across + across.sum(axis=1, keepdims=True)) / 6.0
        through = float(weights.sum())
        return float((weights * x[facets, -1]).sum()) / through if through else np.nan

    return mean


def isothermal_quantity(temperature: float, name: str, quantity: Quantity) -> Function:
    """The value of a quantity of heat where no temperature differs from another."""
    value = temperature if quantity.kind in ("temperature", "bulk_temperature") else 0.0
    if quantity.kind == "nusselt" and quantity.nusselt.against is not None:
        value = np.nan
    return lambda *_: value


def _length(X: np.ndarray, facets: np.ndarray) -> float:
    return float(np.linalg.norm(X[facets[:, 1]] - X[facets[:, 0]], axis=1).sum())


class EdgeHeat:
    """Heat [W/m] that leaves by an edge into what is beyond: by its fluxes, and where its temperature is prescribed.

    Args:
        problem: on the space whose nodes are looked at.
        edge: an entity on the border.

    Source: P. M. Gresho, R. L. Lee, R. L. Sani, M. K. Maslanik and B. E. Eaton, Int. J. Numer. Methods Fluids 7 (1987)
    1111: the consistent flux.
    """

    def __init__(self, problem: ObservedHeat, edge: str) -> None:
        self.problem, self._facets = problem, problem.space.facets_of(edge)
        self._on = EdgeReactions(problem.space, edge, _on_border(problem, warm_edges(problem.scene)))
        self._around: tuple[int, np.ndarray] = -1, self._on.nodes
        self._known: tuple[Sequence[Integral], np.ndarray, np.ndarray, float] | None = None

    def __call__(self, x: np.ndarray, *motion: Motion) -> float:
        """The heat at unknowns x (n, f), and their rates; that of the last flow is kept, for Nusselt numbers too."""
        if motion:
            return self._evaluate(x, *motion)
        X, integrals, known = self.problem.space.X, self.problem.integrals(INTERNAL), self._known
        if known is None or known[0] is not integrals or not (known[1] == x).all() or not (known[2] == X).all():
            self._known = known = integrals, x.copy(), X.copy(), self._evaluate(x)
        return known[3]

    def _evaluate(self, x: np.ndarray, *motion: Motion) -> float:
        problem, space, on = self.problem, self.problem.space, self._on
        given = float(problem.border.loads(facets=self._facets).sum())
        if not len(on.nodes):
            return -given
        if self._around[0] != space.topology:
            self._around = space.topology, cells_around(space, on.nodes)
        with problem.unmoved(on.nodes):
            rest = problem.heat_residual(unconstrained_residual(problem, x, self._around[1]))
        if problem.mass and motion and motion[0].started:
            rest += problem.mass.apply(motion[0].v)[:, 0]
        return -(given + float(on.parts() @ rest[on.nodes]))


def _on_border(problem: ObservedHeat, edges: Sequence[str]) -> list[str]:
    """Edges that have facets on this space."""
    return [edge for edge in edges if len(problem.space.facets_of(edge))]


def _advected(problem: ObservedHeatedFlow, edge: str) -> Callable[[np.ndarray], float]:
    """Heat [W] that fluid carries out by an edge, counted from the neutral temperature."""
    space, depth = problem.space, problem.fluid.depth
    facets = space.facets[space.facets_of(edge)]

    def leaving(x: np.ndarray) -> float:
        out = problem.conditions.fluxes(facets, x[:, :2])
        warmer = x[facets, -1].mean(axis=1) - problem.neutral
        return depth * problem.capacity * float(out @ warmer)

    return leaving
