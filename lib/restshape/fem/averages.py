"""Means over edges by their length, and over regions by their area, however the nodes lie."""

from collections.abc import Callable

import numpy as np

from restshape import _kernels
from restshape.fem.space import PlaneSpace


def mean_over(space: PlaneSpace, at: str | None, nodes: np.ndarray | slice) -> Callable[[np.ndarray], float]:
    """The function that takes the mean of values at nodes over an entity, on the mesh at rest as it then lies.

    Arguments as in `node_weights`.
    """
    weights = node_weights(space, at, nodes)
    return plain_mean if weights is None else weights.mean


class NodeWeights:
    """How much nodes count in a mean over an entity, on the mesh at rest as it then lies.

    Args:
        space: whose nodes they are.
        of: "cells" or "facets".
        chosen: (m,) which of them the entity has; None: all.
        nodes: (k,) of the values, in their order; each of them on the entity.
    """

    def __init__(self, space: PlaneSpace, of: str, chosen: np.ndarray | None, nodes: np.ndarray | slice) -> None:
        self.space, self.of, self.chosen = space, of, chosen
        self.nodes = np.arange(len(space.X), dtype=np.int32)[nodes]
        self._places: tuple[int | None, np.ndarray] = (None, space.cells)

    def __call__(self) -> np.ndarray:
        """The weights (k,): lengths [m], or areas [m^2]."""
        X, places = self.space.X, self._followed()
        weights = _kernels.place_weights(X, places, self.of)
        return np.bincount(places.ravel(), weights.ravel(), len(X))[self.nodes]

    def mean(self, values: np.ndarray) -> float:
        """The mean of values (k,)."""
        return _kernels.mean_at(self.space.X, self._followed(), self.of, self.nodes, values)

    def _followed(self) -> np.ndarray:
        """The nodes of the entity's cells or facets: flips make other cells in the same region."""
        topology, places = self._places
        if topology != self.space.topology:
            every = self.space.cells if self.of == "cells" else self.space.facets
            places = np.ascontiguousarray(every if self.chosen is None else every[self.chosen], dtype=np.int32)
            self._places = (self.space.topology, places)
        return places


def node_weights(space: PlaneSpace, at: str | None, nodes: np.ndarray | slice) -> NodeWeights | None:
    """The weights of nodes in a mean over an entity; None where they are equal.

    Args:
        space: whose nodes they are.
        at: an entity: a region or all (None) counts by area, edges by length, vertices one like the other.
        nodes: of the values, in their order; each of them on the entity.
    """
    if at is None:
        return NodeWeights(space, "cells", None, nodes)
    if len(cells := space.cells_of(at)):
        return NodeWeights(space, "cells", cells, nodes)
    facets = space.facets_of(at)
    return NodeWeights(space, "facets", facets, nodes) if len(facets) else None


def plain_mean(values: np.ndarray) -> float:
    """The mean of values (m,); numpy's own takes five times as long for so few."""
    return values.sum() / len(values)


def facet_weights(X: np.ndarray, facets: np.ndarray) -> np.ndarray:
    """Lengths [m] that stand for the nodes of facets (m, 2) or (m, 3: both ends, middle)."""
    return _kernels.place_weights(X, facets, "facets")
