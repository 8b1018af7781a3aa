"""The order of layers: which panels lie outside of which, seen from the bodies, and panels put into that order."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from restshape import _kernels
from restshape.mesh.mesh import Mesh
from restshape.physics.cloth.contact.collision_surface import CollisionSurface
from restshape.physics.cloth.contact.out_of_bodies import Bodies
from restshape.physics.cloth.self_contact.lines_through import lines_through
from restshape.scene.model import Scene
from restshape.scene.panels import panels_of

ROOM = 1.5
"""Distance at which layers are put, over that at which contact begins between them."""
ROUNDS, WIDER, WIDENINGS = 40, 1.5, 6
"""Rounds in which nodes are moved at most, factor of the distance where layers still cross, and how often."""
ASIDE = 0.1
"""Part of the way between two places of the cloth by which their distances from the bodies may miss it."""
EVEN = 1e-9
"""Part of the least distance between layers by which they may miss it."""
SIDED = 0.5
"""Part of a panel, less the part that is the other way round, from which on one of its faces is its outer one."""


@dataclass(frozen=True, eq=False)
class LayerOrder:
    """Which layer each panel is of.

    Args:
        node_layer: (n,) of the nodes of a mesh, not a number where the panel has none.
        names: of the panels; node_panel: (n,) number of the panel of each node.
        side: (n,) 1 where the face of a node's panel looks outwards, where it begins, -1 inwards, 0 unknown.
    """

    node_layer: np.ndarray
    names: tuple[str, ...]
    node_panel: np.ndarray
    side: np.ndarray

    @classmethod
    def of(cls, scene: Scene, mesh: Mesh, placed: np.ndarray, bodies: Sequence[_kernels.Body]) -> LayerOrder | None:
        """The order that a scene asks for; None where fewer than two layers are named.

        Args:
            mesh: of the cloth; placed: (n, 3) where its nodes are placed [m]; bodies: that it lies on.
        """
        panels = panels_of(scene)
        layers = np.array([np.nan if one.layer is None else one.layer for one in panels.values()])
        if len(np.unique(layers[np.isfinite(layers)])) < 2:
            return None
        side = outer_sides(placed, mesh.cells, mesh.node_piece, bodies)[mesh.node_piece]
        return cls(layers[mesh.node_piece], tuple(panels), mesh.node_piece, side)

    def ranks(self) -> dict[str, int]:
        """Which one from the inside the layer of each panel is, of those that have one."""
        panel, first = np.unique(self.node_panel, return_index=True)
        layers = self.node_layer[first]
        known = np.isfinite(layers)
        rank = np.unique(layers[known], return_inverse=True)[1]
        return dict(zip([self.names[number] for number in panel[known]], rank.tolist()))

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
        """Whether nodes (n,) at x (n, 3) [m] lie below cloth of a layer that they should lie above."""
        found = np.zeros(len(x), bool)
        found[self.below(x)[0]] = True
        return found

    def below(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Nodes (k,) at x (n, 3) [m], and the triangles (k,) that they lie below and should lie above.

        Beside seams layers meet at an angle, and none lies above the other one. What shows its outer face to a node,
        as the overhanging side of a fold does, has it on the right side: the nearest triangle outwards decides.
        """
        sewn_nodes = self.surface.sewn_nodes
        sewn, beside = sewn_nodes[self.cells].any(axis=1), sewn_nodes.copy()
        beside[self.cells[sewn]] = True
        faces, side = _faces(x, self.cells), self.order.side[self.cells[:, 0]]
        found = [np.zeros((2, 0), np.int64)]
        for upper, lower in self.order.steps():
            node, cell, way = self._hits(x, upper, lower)
            nearest = np.lexsort((way, node))
            nearest = nearest[way[nearest] > 0.0]
            nearest = nearest[np.unique(node[nearest], return_index=True)[1]]
            node, cell = node[nearest], cell[nearest]
            turned = side[cell] * np.einsum("ka,ka->k", faces[cell], self._outwards(x, lower)[node]) < 0.0
            kept = ~turned & ~(beside[node] & sewn[cell]) & ~sewn_nodes[node]
            found.append(np.array([node[kept], cell[kept]]))
        node, cell = np.concatenate(found, axis=1)
        return node, cell

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

    def in_order(self, x: np.ndarray, movable: np.ndarray, gap: float) -> tuple[np.ndarray, bool]:
        """Places (n, 3) [m] at which each layer lies outside of those below, and whether no node had to go on.

        Args:
            x: (n, 3) where the cloth is placed.
            movable: (n,) whether nothing holds a node.
            gap: the least distance between layers [m].
        """
        x, ended = x.copy(), True
        for upper, lower in self.order.steps():
            for _ in range(ROUNDS):
                lift = np.where(movable, self._lift(x, upper, lower, gap), 0.0)
                if not (lift > EVEN * gap).any():
                    break
                x += lift[:, None] * self._outwards(x, lower)
            else:
                ended = False
        return x, ended

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
        outwards = self._outwards(x, lower)
        ways = outwards[start]
        node, cell, way = lines_through(x[start], ways, x[self.cells[cells]])
        if not self.bodies:
            # On the far side of a tube outwards is the other way.
            there = outwards[self.cells[cells[cell]]].sum(axis=1)
            kept = np.einsum("ka,ka->k", there, ways[node]) > 0.0
        else:
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
        """Unit vectors (n, 3) outwards at x (n, 3): away from bodies, else along the face of what is nearest below."""
        if self.bodies:
            return Bodies(self.bodies).distance(x)[1]
        cells = self.cells[lower[self.cells].all(axis=1)]
        own = np.unique(cells)
        face = _at_nodes(_faces(x, cells), cells, len(x))[own]
        length = np.linalg.norm(face, axis=1)
        face /= np.where(length > 0.0, length, 1.0)[:, None]
        return face[cKDTree(x[own]).query(x)[1]]


def is_another_order(before: LayerOrder | None, after: LayerOrder | None) -> bool:
    """Whether panels that have a layer in both orders lie otherwise in them, or an order is new."""
    if before is None or after is None:
        return after is not None
    known, wanted = before.ranks(), after.ranks()
    both = [name for name in wanted if name in known]
    old, new = (np.unique([ranks[name] for name in both], return_inverse=True)[1] for ranks in (known, wanted))
    return not np.array_equal(old, new)


def outer_sides(
    x: np.ndarray, cells: np.ndarray, node_panel: np.ndarray, bodies: Sequence[_kernels.Body]
) -> np.ndarray:
    """Whether the faces of panels (p,) look outwards, 1, or inwards, -1; 0 where that is not the same all over.

    Args:
        x: (n, 3) where the cloth is placed [m]; cells: (ne, 3) triangles.
        node_panel: (n,) number of the panel of each node.
        bodies: seen from which outwards is; none: it is nowhere known.
    """
    panels = int(node_panel.max()) + 1
    if not bodies:
        return np.zeros(panels)
    ways = Bodies(bodies).distance(x[cells].mean(axis=1))[1]
    outwards = np.einsum("ka,ka->k", _faces(x, cells), ways)
    panel = node_panel[cells[:, 0]]
    net, gross = (np.bincount(panel, part, panels) for part in (outwards, np.abs(outwards)))
    return np.where(np.abs(net) > SIDED * gross, np.sign(net), 0.0)


def _faces(x: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Normals (ne, 3) of triangles (ne, 3) at x (n, 3) [m], twice as long as their areas [m^2]."""
    a, b, c = x[cells].swapaxes(0, 1)
    return np.cross(b - a, c - a)


def _at_nodes(faces: np.ndarray, cells: np.ndarray, n: int) -> np.ndarray:
    """Sums (n, 3) of the normals (ne, 3) of the triangles (ne, 3) around nodes."""
    return np.column_stack([np.bincount(cells.ravel(), np.repeat(part, 3), n) for part in faces.T])
