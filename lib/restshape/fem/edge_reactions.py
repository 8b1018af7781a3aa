"""Reactions of a scalar that pass through single edges, such as heat that leaves where a temperature is fixed."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from restshape.errors import UserError
from restshape.fem.averages import facet_weights
from restshape.fem.space import PlaneSpace


class EdgeReactions:
    """Which nodes have reactions that pass through an edge, and which part of each.

    Only sides on which supports prescribe the unknown pass a reaction. A node where several of them meet has one
    reaction: each edge has as much of it as it has of the lengths that stand for the node, so that what passes through
    all edges is the sum of all reactions.

    Args:
        space: whose nodes may move.
        edge: an entity on the border.
        supported: entities on which supports prescribe the unknown.

    Raises:
        UserError: the edge is not on the border, so that nothing leaves there.
    """

    def __init__(self, space: PlaneSpace, edge: str, supported: Iterable[str]) -> None:
        _require_border(space, edge)
        sides = [space.facets_of(name) for name in supported]
        fixed = np.unique(np.concatenate(sides)) if sides else np.empty(0, dtype=np.int32)
        self.space = space
        self._fixed, self._own = space.facets[fixed], space.facets[np.intersect1d(fixed, space.facets_of(edge))]
        self.nodes = np.unique(self._own)

    def parts(self) -> np.ndarray:
        """The part (k,) of each node's reaction, on the mesh as it lies."""
        mine, all_of_it = (
            np.bincount(sides.ravel(), facet_weights(self.space.X, sides).ravel(), len(self.space.X))[self.nodes]
            for sides in (self._own, self._fixed)
        )
        return mine / all_of_it


def _require_border(space: PlaneSpace, edge: str) -> None:
    outline = space.outline
    border = {index for loop in outline.loops if loop.kind != "region" for index, _ in loop.edges}
    if not border.issuperset(outline.entity(edge).edges):
        raise UserError(f"nothing leaves the body at {edge!r}, which lies inside", "at", "name an edge of the border")
