"""Nodes, facets and cells of a space that a list of names addresses."""

from collections.abc import Sequence

import numpy as np

from restshape import _kernels
from restshape.errors import UserError
from restshape.fem.space import PlaneSpace, Space
from restshape.scene.model import Quantity


def _union(parts: list[np.ndarray]) -> np.ndarray:
    return parts[0] if len(parts) == 1 else np.unique(np.concatenate(parts))


def nodes_on(space: Space, names: Sequence[str]) -> np.ndarray:
    """Indices (k,) of the nodes on the named entities."""
    return _union([space.nodes_of(name) for name in names])


def facets_on(space: PlaneSpace, names: Sequence[str]) -> np.ndarray:
    """Indices (k,) of the facets on the named edges."""
    return _union([space.facets_of(name) for name in names])


def cells_on(space: Space, names: Sequence[str]) -> np.ndarray:
    """Indices (k,) of the cells in the named regions."""
    return _union([space.cells_of(name) for name in names])


def observed_nodes(space: Space, name: str, quantity: Quantity) -> np.ndarray | slice:
    """Nodes (k,) that a quantity of this name is taken at; all of them where it names no place.

    Args:
        space: whose nodes they are.
        name: of the quantity in the scene.
        quantity: what is asked for.

    Raises:
        UserError: there is no node there.
    """
    if quantity.at is None:
        return slice(None)
    nodes = space.nodes_of(quantity.at)
    if len(nodes) == 0:
        raise UserError(
            f"{quantity.at!r} holds no node of the mesh",
            f"quantities.{name}.at",
            "name a vertex, an edge or a region",
        )
    return nodes


def cells_around(space: Space, nodes: np.ndarray) -> np.ndarray:
    """Cells (k,) int32 of which one of `nodes` (m,) int32 is a node."""
    return _kernels.cells_around(space.cells, nodes, len(space.X))
