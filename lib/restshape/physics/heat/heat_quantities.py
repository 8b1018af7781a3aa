"""Quantities of interest of conduction: temperatures, and heat that flows through edges."""

from collections.abc import Sequence

import numpy as np

from restshape.fem.assembled import Assembled
from restshape.fem.derivative import Differentiable, flow_derivative, nodal_quantity
from restshape.fem.edge_reactions import EdgeReactions
from restshape.fem.entity_sets import cells_around, observed_nodes
from restshape.fem.observer import Function, area_at, reduction
from restshape.fem.problem import STIFFNESS, Inertia, SteadyProblem
from restshape.fem.residuals import unconstrained_residual
from restshape.fem.time_integration import Motion
from restshape.physics.heat.surface import SurfaceHeat
from restshape.scene.model import Quantity


def heat_quantity(
    problem: SteadyProblem, surfaces: Sequence[SurfaceHeat], capacity: Inertia | None, name: str, quantity: Quantity
) -> Function:
    """The function of the temperature x (n, 1) [K] that a quantity of this name is.

    Args:
        problem: on the space whose nodes are looked at; surfaces: its fluxes and convections.
        capacity: of what changes in time; None: it is steady.
        name, quantity: as the scene has them.

    Raises:
        UserError: there is nothing where it is asked for.
    """
    space = problem.space
    if quantity.kind == "area":
        return area_at(space, name, quantity)
    if quantity.kind == "heat_flow":
        return _outflow(problem, surfaces, capacity, name, quantity.at)
    nodes = observed_nodes(space, name, quantity)
    reduce = reduction(space, quantity, nodes)
    return nodal_quantity(space, quantity, nodes, [0], lambda x, *_: reduce(x[nodes, 0]))


def _outflow(
    problem: SteadyProblem, surfaces: Sequence[SurfaceHeat], capacity: Inertia | None, name: str, edge: str
) -> Function:
    """Heat [W] that leaves by an edge: by its fluxes and convections, and where temperatures are fixed."""
    index = problem.space.facets_of(edge)
    supported = [on for one in problem.scene.supports.values() if "temperature" in one.fix for on in one.on]
    fixed = EdgeReactions(problem.space, edge, supported, f"quantities.{name}.at")
    parts = [(part, np.flatnonzero(np.isin(part.index, index)).astype(np.int32)) for part in surfaces]
    own = [(part, chosen) for part, chosen in parts if len(chosen)]

    def value(x: np.ndarray, *motion: Motion) -> float:
        out = np.zeros_like(x)
        for part, chosen in own:
            part.integral.add_residual(x, out, chosen)
        if not len(fixed.nodes):
            return out.sum()
        cells = cells_around(problem.space, fixed.nodes)
        if capacity and not motion[0].started:  # how fast heat is stored is not known yet, only what is conducted
            balance = Assembled(problem.integrals(STIFFNESS)[:1]).residual(x, None, cells)
        else:
            balance = unconstrained_residual(problem, x, cells) + (capacity.apply(motion[0].v) if capacity else 0.0)
        return out.sum() - fixed.parts() @ balance[fixed.nodes, 0]

    return Differentiable(value, flow_derivative(problem, fixed, [(p.linear, c) for p, c in own]))
