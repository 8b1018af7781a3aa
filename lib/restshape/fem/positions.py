"""Positions of nodes after deformation as quantities: rest position and displacement."""

from __future__ import annotations

from typing import cast

import numpy as np

from restshape.fem.derivative import Derivative, Differentiable, reduction_weights
from restshape.fem.entity_sets import observed_nodes
from restshape.fem.observer import reduction
from restshape.fem.space import PlaneSpace, Space
from restshape.scene.model import Quantity


def position_quantity(space: PlaneSpace, name: str, quantity: Quantity, column: int) -> Differentiable:
    """A coordinate [m] of nodes that are displaced by the unknowns x (n, f) [m], with its derivative.

    Args:
        space: of the nodes.
        name, quantity: where it is taken, and how values become one.
        column: 0 for x, 1 for y.

    Raises:
        UserError: there is no node there.
    """
    nodes = observed_nodes(space, name, quantity)
    reduce, weights = reduction(space, quantity, nodes), reduction_weights(space, quantity, nodes)

    def positions(x: np.ndarray) -> np.ndarray:
        return space.X[nodes, column] + x[nodes, column]

    def value_on(other: Space, x: np.ndarray) -> float:
        return position_quantity(cast(PlaneSpace, other), name, quantity, column)(x)

    def derivative(x: np.ndarray) -> Derivative:
        load = np.zeros_like(x)
        load[nodes, column] = weights(positions(x))
        return Derivative(load, value_on=value_on)

    return Differentiable(lambda x, *_: reduce(positions(x)), derivative)
