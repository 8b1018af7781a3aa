"""Reactions of a scalar that pass through single edges, such as heat that leaves where a temperature is fixed."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from restshape.errors import UserError
from restshape.fem.averages import facet_weights
from restshape.fem.space import PlaneSpace
from restshape.scene.model import Scene
from restshape.shape.outline import Outline


class EdgeReactions:
    """Which nodes have reactions that pass through an edge, and which part of each.

    Only sides on which supports prescribe the unknown pass a reaction. A node where several of them meet has one
    reaction. Each edge has what the next node of its own says that passes through it by a length there, and of the rest
    of the reaction as much as it has of the lengths that stand for the node. So what passes through all edges is the
    sum of all reactions, also where an edge is one facet, whose next node is its other corner.

    Args:
        space: whose nodes may move.
        edge: an entity on the border.
        supported: entities on which supports prescribe the unknown.
        where: for messages.

    Attributes:
        nodes: (k,) whose reactions count.

    Raises:
        UserError: the edge is not on the border, so that nothing leaves there.
    """

    def __init__(self, space: PlaneSpace, edge: str, supported: Iterable[str], where: str = "at") -> None:
        require_border(space.outline, edge, where)
        sides = [space.facets_of(name) for name in supported]
        fixed = np.unique(np.concatenate(sides)) if sides else np.empty(0, dtype=np.int32)
        own = np.intersect1d(fixed, space.facets_of(edge))
        self.space = space
        self._own, self._others = space.facets[own], space.facets[np.setdiff1d(fixed, own)]
        self._met = np.intersect1d(self._own, self._others)
        self._near = [(node, *(self._nearest(node, one) for one in (self._own, self._others))) for node in self._met]
        beside = [node for _, *ends in self._near for node in ends]
        self.nodes = np.unique(np.concatenate([self._own.ravel(), np.array(beside, dtype=np.int32)]))

    def parts(self) -> np.ndarray:
        """The part (k,) of each node's reaction, on the mesh as it lies."""
        own, others = (self._lengths(sides) for sides in (self._own, self._others))
        fixed, parts = own + others, np.zeros(len(self.space.X))
        parts[self._own] = 1.0
        parts[self._met] = own[self._met] / fixed[self._met]
        for node, mine, another in self._near:
            share = own[node] / fixed[node]
            # By all lengths there: the other end of an edge of one facet is a corner, too.
            parts[mine] += (1.0 - share) * own[node] / fixed[mine]
            parts[another] -= share * others[node] / fixed[another]
        return parts[self.nodes]

    def _nearest(self, node: int, sides: np.ndarray) -> int:
        """The node beside one on the first of the sides that it is on: the middle of a facet that has one."""
        facet = sides[np.flatnonzero((sides == node).any(axis=1))[0]]
        return int(facet[2] if len(facet) == 3 and facet[2] != node else facet[facet != node][0])

    def _lengths(self, sides: np.ndarray) -> np.ndarray:
        """Lengths (n,) that stand for the nodes of sides."""
        return np.bincount(sides.ravel(), facet_weights(self.space.X, sides).ravel(), len(self.space.X))


def require_border(outline: Outline, edge: str, where: str) -> None:
    """Refuses an entity with an edge that is not on the border.

    Args:
        outline: the shape; edge: an entity of it; where: for messages.

    Raises:
        UserError: nothing leaves there.
    """
    border = {index for loop in outline.loops if loop.kind != "region" for index, _ in loop.edges}
    if not border.issuperset(outline.entity(edge).edges):
        raise UserError(f"nothing leaves the body at {edge!r}, which lies inside", where, "name an edge of the border")


def check_heat_flows(scene: Scene, outline: Outline) -> None:
    """Makes sure that heat can leave where quantities ask how much does.

    Raises:
        UserError: one asks at an edge inside the body.
    """
    for name, quantity in scene.quantities.items():
        if quantity.kind == "heat_flow" and quantity.at:
            try:
                require_border(outline, quantity.at, f"quantities.{name}.at")
            except UserError as error:
                raise scene.located(error) from error
