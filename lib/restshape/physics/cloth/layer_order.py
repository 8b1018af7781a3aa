"""The order of layers: which panels lie outside of which, seen from the bodies, and panels put into that order."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from restshape import _kernels
from restshape.mesh.mesh import Mesh
from restshape.physics.cloth.collision_surface import CollisionSurface
from restshape.physics.cloth.out_of_bodies import Bodies
from restshape.scene.model import Scene
from restshape.scene.panels import panels_of

ROOM = 1.5
"""Distance at which layers are put, over that at which contact begins between them."""
ROUNDS, WIDER, WIDENINGS = 40, 1.5, 6
"""Rounds in which nodes are moved at most, factor of the distance where layers still cross, and how often."""
ASIDE = 0.1
"""Part of the way between two places of the cloth by which their distances from the bodies may miss it."""
CHUNK = 1_000_000
"""Pairs of nodes and triangles that are looked at at once."""
ROUNDING = 1e-9
"""Part of a triangle's side beyond it that is still on it."""


@dataclass(frozen=True, eq=False)
class LayerOrder:
    """Which layer each panel is of.

    Args:
        node_layer: (n,) of the nodes of a mesh, not a number where the panel has none.
        names: of the panels; node_panel: (n,) number of the panel of each node.
    """

    node_layer: np.ndarray
    names: tuple[str, ...]
    node_panel: np.ndarray

    @classmethod
    def of(cls, scene: Scene, mesh: Mesh) -> LayerOrder | None:
        """The order that a scene asks for; None where fewer than two layers are named."""
        panels = panels_of(scene)
        layers = np.array([np.nan if one.layer is None else one.layer for one in panels.values()])
        if len(np.unique(layers[np.isfinite(layers)])) < 2:
            return None
        return cls(layers[mesh.node_piece], tuple(panels), mesh.node_piece)

    def steps(self) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """From the innermost layer on, whether nodes (n,) are of a layer, and whether (n,) they are of one below."""
        layers = np.unique(self.node_layer[np.isfinite(self.node_layer)])
        for layer in layers[1:]:
            yield self.node_layer == layer, self.node_layer < layer


@dataclass(frozen=True, eq=False)
class Layers:
    """Cloth in space whose layers have an order.

    Args:
        order: that is wanted.
        surface: triangles, and what is sewn together.
        bodies: seen from which layers lie outside of each other; none: seen from the back of what lies below.
    """

    order: LayerOrder
    surface: CollisionSurface
    bodies: Sequence[_kernels.Body]

    def under(self, x: np.ndarray) -> np.ndarray:
        """Whether nodes (n,) at x (n, 3) [m] lie below cloth of a layer that they should lie above.

        Beside seams layers meet at an angle, and none lies above the other one.
        """
        found, nodes = np.zeros(len(x), bool), self.surface.sewn_nodes
        sewn, beside = nodes[self.cells].any(axis=1), nodes.copy()
        beside[self.cells[sewn]] = True
        for upper, lower in self.order.steps():
            node, cell, way = self._hits(x, upper, lower)
            found[node[(way > 0.0) & ~(beside[node] & sewn[cell])]] = True
        return found & ~nodes

    @property
    def cells(self) -> np.ndarray:
        """Triangles (ne, 3) int32."""
        return self.surface.cells

    def notes(self, x: np.ndarray) -> list[str]:
        """What there is to say of nodes at x (n, 3) [m] that lie below what they should lie above."""
        under = np.bincount(self.order.node_panel[self.under(x)], minlength=len(self.order.names))
        return [
            f"{count} node{'s' if count > 1 else ''} of {name} lie{'' if count > 1 else 's'} under a lower layer"
            for name, count in zip(self.order.names, under.tolist())
            if count
        ]

    def in_order(self, x: np.ndarray, movable: np.ndarray, gap: float) -> np.ndarray:
        """Places (n, 3) [m] at which each layer lies outside of those below.

        Args:
            x: (n, 3) where the cloth is placed.
            movable: (n,) whether nothing holds a node.
            gap: the least distance between layers [m].
        """
        x = x.copy()
        for upper, lower in self.order.steps():
            for _ in range(ROUNDS):
                lift = np.where(movable, self._lift(x, upper, lower, gap), 0.0)
                if not (lift > ROUNDING * gap).any():
                    break
                x += lift[:, None] * self._outwards(x, lower)
        return x

    def _lift(self, x: np.ndarray, upper: np.ndarray, lower: np.ndarray, gap: float) -> np.ndarray:
        """How far nodes (n,) of the upper layer must go outwards [m]."""
        lift = np.zeros(len(x))
        node, _, way = self._hits(x, upper, lower)
        np.maximum.at(lift, node, way + gap)
        # Nodes of the lower one that would be outside of an upper triangle.
        _, cell, way = self._hits(x, lower, upper)
        np.maximum.at(lift, self.cells[cell], (gap - way)[:, None])
        return np.where(upper, lift, 0.0)

    def _hits(self, x: np.ndarray, nodes: np.ndarray, others: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Where lines outwards, and inwards, from nodes meet triangles of others.

        Args:
            x: (n, 3) [m].
            nodes, others: (n,) of which the nodes, and the triangles' nodes, are.

        Returns: nodes (k,), triangles (k,), and the ways (k,) [m] from one to the other, positive outwards.
        """
        lower = nodes if self._is_below(nodes, others) else others
        start, cells = np.flatnonzero(nodes), np.flatnonzero(others[self.cells].all(axis=1))
        ways = self._outwards(x, lower)[start]
        node, cell, way = lines_through(x[start], ways, x[self.cells[cells]])
        kept = np.ones(len(node), bool)
        if self.bodies:
            places = x[start[node]] + way[:, None] * ways[node]
            # On the far side of what lies between two bodies, or two parts of one, outwards is something else.
            union = Bodies(self.bodies)
            off = union.distance(places)[0] - union.distance(x[start[node]])[0] - way
            kept = np.abs(off) <= ASIDE * np.abs(way)
        return start[node[kept]], cells[cell[kept]], way[kept]

    def _is_below(self, nodes: np.ndarray, others: np.ndarray) -> bool:
        """Whether nodes (n,) are of lower layers than others (n,)."""
        return bool(self.order.node_layer[nodes].max() < self.order.node_layer[others].min())

    def _outwards(self, x: np.ndarray, lower: np.ndarray) -> np.ndarray:
        """Unit vectors (n, 3) outwards at x (n, 3): away from bodies, else along the face of what lies below."""
        if self.bodies:
            return Bodies(self.bodies).distance(x)[1]
        corners = x[self.cells[lower[self.cells].all(axis=1)]]
        face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]).sum(axis=0)
        length = float(np.linalg.norm(face))
        return np.broadcast_to(face / length if length > 0.0 else face, x.shape)


def lines_through(
    start: np.ndarray, ways: np.ndarray, corners: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Which lines meet which triangles, and how far from their starts.

    Args:
        start, ways: (n, 3) places [m] and unit vectors of lines; corners: (ne, 3, 3) of triangles [m].

    Returns: lines (k,), triangles (k,), and ways (k,) [m], negative against the vectors.

    Source: Möller and Trumbore, Journal of Graphics Tools 2(1), 1997, 21.
    """
    middle = corners.mean(axis=1)
    reach = np.linalg.norm(corners - middle[:, None], axis=2).max(axis=1, initial=0.0)
    found = [np.zeros((0, 2), np.int64)]
    part = max(1, CHUNK // max(1, len(corners)))
    for first in range(0, len(start), part):
        own = slice(first, first + part)
        off = middle - start[own, None]
        along = np.einsum("nma,na->nm", off, ways[own])
        near = np.einsum("nma,nma->nm", off, off) - along**2 <= reach**2 * (1.0 + ROUNDING)
        found.append(np.argwhere(near) + np.array([first, 0]))
    line, cell = np.concatenate(found).T
    a, b, c = corners[cell].transpose(1, 0, 2)
    u, v, way, off = b - a, c - a, ways[line], start[line] - a
    normal = np.cross(way, v)
    volume = np.einsum("ka,ka->k", u, normal)
    flat = np.abs(volume) <= ROUNDING * reach[cell] ** 2
    scale = np.where(flat, np.inf, volume)
    turned = np.cross(off, u)
    s = np.einsum("ka,ka->k", off, normal) / scale
    t = np.einsum("ka,ka->k", way, turned) / scale
    hit = ~flat & (np.minimum.reduce([s, t, 1.0 - s - t]) >= -ROUNDING)
    return line[hit], cell[hit], (np.einsum("ka,ka->k", v, turned) / scale)[hit]
