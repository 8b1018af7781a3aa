"""Cloth that passes through itself in few places, moved apart there: contours of that are made shorter until gone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from restshape.physics.cloth.contact.collision_surface import CollisionSurface
from restshape.physics.cloth.contact.out_of_bodies import Bodies

STEP = 0.05
"""What the node that moves most moves by in one step, over the mean length of edges."""
STEPS = 200
"""Steps at most."""
SPREAD = 2
"""Rounds in which each node takes on the mean motion of its neighbours: cloth moves smoothly."""
GRAZING = 0.1
"""Least sine of the angle between an edge and a triangle: flatter ones count as if they had it."""
FEW = 64
"""Triangles that are crossed at most: where more are, whole parts lie through each other, not places."""


@dataclass(frozen=True, eq=False)
class Piercings:
    """Where edges pass through triangles.

    Args:
        edge: (k,) numbers of edges; cell: (k,) of the triangles that they pass through.
        share: (k,) of the way along the edge; weights: (k, 3) of the triangle's corners there.
    """

    edge: np.ndarray
    cell: np.ndarray
    share: np.ndarray
    weights: np.ndarray


class Untangling:
    """Cloth that is moved apart where it passes through itself.

    Each contour along which two parts pass through each other is made shorter until it is gone, or slips over a border.

    Args:
        surface: of the cloth.
        bodies: that no node comes deeper into; None: there are none. clear: distance from them that is enough [m].

    Source: Volino and Magnenat-Thalmann, Resolving surface collisions through intersection contour minimization,
    ACM TOG 25(3), 2006, 1154.
    """

    def __init__(self, surface: CollisionSurface, bodies: Bodies | None = None, clear: float = 0.0) -> None:
        self.bodies, self.clear = bodies, clear
        self.surface, self.edges, self.cells = surface, surface.edges, surface.cells
        count = len(surface.flat)
        self.numbers, pairs = surface.sewn or (np.arange(count), np.empty((0, 2), np.int32))
        most = int(self.numbers.max()) + 1
        self.most, self.pairs = most, np.unique(np.concatenate([pairs @ [most, 1], pairs @ [1, most]]))
        self.opposite = _opposite(self.edges, self.cells)

    def apart(self, x: np.ndarray, movable: np.ndarray) -> np.ndarray | None:
        """Places (n, 3) [m] at which the cloth does not cross itself any more; None where none are found.

        Args:
            x: (n, 3) where it does; movable: (n,) whether nothing holds a node.
        """
        x, least = x.copy(), np.minimum(self.bodies.distance(x)[0], self.clear) if self.bodies else None
        length = float(np.linalg.norm(x[self.edges[:, 1]] - x[self.edges[:, 0]], axis=1).mean())
        for _ in range(STEPS):
            crossed = self.surface.crossed(x)
            if not len(crossed):
                return None if self.surface.crosses(x) else x
            if len(crossed) > FEW:
                return None
            motion = self._spread(self.shortening(x, self.piercings(x, crossed)))
            motion[~movable] = 0.0
            most = float(np.linalg.norm(motion, axis=1).max())
            if most == 0.0:
                return None
            x += STEP * length / most * motion
            if self.bodies:
                distance, away = self.bodies.distance(x)
                x += np.where(movable, np.maximum(least - distance, 0.0), 0.0)[:, None] * away
        return None

    def piercings(self, x: np.ndarray, crossed: np.ndarray) -> Piercings:
        """Where edges pass through the triangles crossed (m,) at x (n, 3) [m]."""
        ends, corners = x[self.edges], x[self.cells[crossed]]
        low, high = ends.min(axis=1)[:, None], ends.max(axis=1)[:, None]
        near = ((low <= corners.max(axis=1)) & (high >= corners.min(axis=1))).all(axis=2)
        edge, number = np.nonzero(near)
        cell = crossed[number]
        apart = ~self._joined(self.edges[edge], self.cells[cell])
        edge, cell = edge[apart], cell[apart]
        start, way = x[self.edges[edge, 0]], x[self.edges[edge, 1]] - x[self.edges[edge, 0]]
        a, b, c = (x[self.cells[cell, k]] for k in range(3))
        matrix = np.stack([b - a, c - a, -way], axis=2)
        regular = np.abs(np.linalg.det(matrix)) > 0.0
        edge, cell = edge[regular], cell[regular]
        solved = np.linalg.solve(matrix[regular], (start - a)[regular][:, :, None])[:, :, 0]
        weights = np.column_stack([1.0 - solved[:, 0] - solved[:, 1], solved[:, :2]])
        through = (weights > 0.0).all(axis=1) & (solved[:, 2] > 0.0) & (solved[:, 2] < 1.0)
        return Piercings(edge[through], cell[through], solved[through, 2], weights[through])

    def shortening(self, x: np.ndarray, at: Piercings) -> np.ndarray:
        """The motion (n, 3) along which contours through x (n, 3) [m] get shorter fastest."""
        start, end = (x[self.edges[at.edge, k]] for k in range(2))
        along = _unit(end - start)
        place = start + at.share[:, None] * (end - start)
        corners = x[self.cells[at.cell]]
        normal = _unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
        ways = np.zeros_like(place)
        for side in range(2):
            third = self.opposite[at.edge, side]
            inwards = x[third] - place
            inwards -= _dot(inwards, along)[:, None] * along
            way = _unit(np.cross(normal, np.cross(along, inwards)))
            way *= np.sign(_dot(way, inwards))[:, None]
            ways += np.where(third >= 0, 1.0, 0.0)[:, None] * way
        steep = _dot(along, normal)
        steep = np.where(steep < 0.0, -1.0, 1.0) * np.maximum(np.abs(steep), GRAZING)
        lift = (_dot(along, ways) / steep)[:, None] * normal
        motion = np.zeros_like(x)
        for k, weight in enumerate((1.0 - at.share, at.share)):
            np.add.at(motion, self.edges[at.edge, k], weight[:, None] * (ways - lift))
        for k in range(3):
            np.add.at(motion, self.cells[at.cell, k], at.weights[:, k, None] * lift)
        return motion

    def _spread(self, motion: np.ndarray) -> np.ndarray:
        """The motion (n, 3) spread to neighbours; nodes that are sewn together have one motion."""
        first, second = self.numbers[self.edges].T
        whole = np.zeros((self.most, 3))
        np.add.at(whole, self.numbers, motion)
        for _ in range(SPREAD):
            total, count = whole.copy(), np.ones(self.most)
            np.add.at(total, first, whole[second])
            np.add.at(total, second, whole[first])
            np.add.at(count, first, 1.0)
            np.add.at(count, second, 1.0)
            whole = total / count[:, None]
        return whole[self.numbers]

    def _joined(self, edges: np.ndarray, cells: np.ndarray) -> np.ndarray:
        """Whether edges (k, 2) and triangles (k, 3) hang together, by themselves or by a seam."""
        first, second = self.numbers[edges][:, :, None], self.numbers[cells][:, None, :]
        same = first == second
        if len(self.pairs):
            same |= np.isin(first.astype(np.int64) * self.most + second, self.pairs)
        return same.any(axis=(1, 2))


def _opposite(edges: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """The third nodes (m, 2) of both triangles beside edges (m, 2); -1 where there is none."""
    count = int(edges.max()) + 1
    keys = edges[:, 0].astype(np.int64) * count + edges[:, 1]
    found = np.full((len(edges), 2), -1)
    for k in range(3):
        sides = np.sort(cells[:, [k, (k + 1) % 3]], axis=1)
        which = np.searchsorted(keys, sides[:, 0].astype(np.int64) * count + sides[:, 1])
        forward = (cells[:, k] > cells[:, (k + 1) % 3]).astype(int)
        found[which, forward] = cells[:, (k + 2) % 3]
    return found


def _dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.asarray(np.einsum("ka,ka->k", a, b))


def _unit(a: np.ndarray) -> np.ndarray:
    length = np.linalg.norm(a, axis=1)
    return np.asarray(a / np.where(length > 0.0, length, 1.0)[:, None])
