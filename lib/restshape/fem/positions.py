"""Positions of nodes after deformation as quantities: rest position and displacement."""

from restshape.fem.entity_sets import observed_nodes
from restshape.fem.observer import Function, reduction
from restshape.fem.space import PlaneSpace
from restshape.scene.model import Quantity


def position_quantity(space: PlaneSpace, name: str, quantity: Quantity, column: int) -> Function:
    """A coordinate [m] of nodes that are displaced by the unknowns x (n, f) [m].

    Args:
        space: of the nodes.
        name, quantity: where it is taken, and how values become one.
        column: 0 for x, 1 for y.

    Raises:
        UserError: there is no node there.
    """
    nodes = observed_nodes(space, name, quantity)
    reduce = reduction(space, quantity, nodes)
    return lambda x, *_: reduce(space.X[nodes, column] + x[nodes, column])
