"""Where the flat cloth lies before it falls."""

from __future__ import annotations

import numpy as np

from restshape.mesh.mesh import Mesh
from restshape.physics.cloth.seams.pleats import Pleats
from restshape.physics.cloth.seams.seam_lines import SeamLine, pleated_lines
from restshape.scene.model import Scene
from restshape.shape.panels.panel_placement import PatternPlacement

ALL = slice(None)
SLOPE = 0.2
"""Of the cloth in folded darts at first: behind the rest, over the distance from the nearer leg; and in pleats."""
FAR = 4.0
"""How far pleats are begun away from their seam, over their depth."""


class InitialPlacement:
    """Where the flat cloth lies before it falls.

    Args:
        scene: of cloth; a sheet that it places nowhere lies in the plane z = 0, where it was cut.
    """

    def __init__(self, scene: Scene) -> None:
        self._pattern = PatternPlacement(scene)
        self.start, self._scene = self._pattern.start, scene
        self._darts = [dart for dart in scene.shape.darts if dart.dart.folded]

    def coordinates(self, mesh: Mesh, nodes: np.ndarray | slice = ALL) -> np.ndarray:
        """Coordinates (k, 2) [m] of nodes of a mesh in their own panels; X of one sheet."""
        return self._pattern.coordinates(mesh.X[nodes], mesh.node_piece[nodes])

    def places(self, mesh: Mesh, nodes: np.ndarray | slice = ALL) -> np.ndarray:
        """Places (k, 3) [m] of nodes of a mesh."""
        return self._pattern.places(mesh.X[nodes], mesh.node_piece[nodes])

    def directions(self, mesh: Mesh, nodes: np.ndarray | slice, d: np.ndarray) -> np.ndarray:
        """Derivatives (k, 3) of the places along directions d (k, 2) of the pattern plane at nodes (k,)."""
        return self._pattern.directions(d, mesh.X[nodes], mesh.node_piece[nodes])

    def _begin_folds(self, mesh: Mesh, places: np.ndarray) -> None:
        """Let the cloth of folded darts, at places (n, 3) that are changed, lie behind the rest like a flat roof.

        Flat cloth would be pushed together in its plane as its seam closes, and stay so.
        """
        for dart in self._darts:
            legs = mesh.facets[np.concatenate([mesh.facets_of(leg) for side in dart.legs for leg in side])]
            inside = np.setdiff1d(mesh.nodes_of(dart.name), legs)
            if not len(inside):
                continue
            away, _, _ = _nearest(mesh.X[inside], mesh.X[legs])
            x, y = (self.directions(mesh, inside, np.tile(axis, (len(inside), 1))) for axis in np.eye(2))
            places[inside] -= SLOPE * away[:, None] * np.cross(x, y)

    def _begin_pleats(self, mesh: Mesh, places: np.ndarray) -> None:
        """Let cloth, at places (n, 3) that are changed, begin in waves that fold to pleats as their seams close."""
        if not any(seam.pleats for seam in self._scene.seams.values()):
            return
        for line, pleats in pleated_lines(self._scene, mesh, places):
            pieces = mesh.node_piece[line.nodes]
            # A side may go on along edges of other panels.
            for piece in np.unique(pieces):
                own = np.flatnonzero(mesh.node_piece == piece)
                height = _wave(mesh.X[own], line, pleats, mesh.X, pieces == piece)
                x, y = (self.directions(mesh, own, np.tile(axis, (len(own), 1))) for axis in np.eye(2))
                places[own] += height[:, None] * np.cross(x, y)

    def scattered(self, mesh: Mesh) -> np.ndarray:
        """Places (n, 3) [m] of a mesh's nodes, with the scatter of the start."""
        places = self.places(mesh)
        self._begin_folds(mesh, places)
        self._begin_pleats(mesh, places)
        if self.start.scatter:
            random = np.random.default_rng(self.start.seed).uniform(-1.0, 1.0, places.shape)
            # In an order that does not hang on the number of ranks.
            places += self.start.scatter * random[mesh.places]
        return places


def _wave(points: np.ndarray, line: SeamLine, pleats: Pleats, X: np.ndarray, near: np.ndarray) -> np.ndarray:
    """Heights (k,) [m] at which cloth at points (k, 2) of one panel begins beside a line with pleats.

    Args:
        points: [m]; line: with the pleats; X: (n, 2) nodes of the mesh [m]; near: which nodes (p,) of the line are of
            the panel.
    """
    lengths = line.lengths(X)
    edges = np.flatnonzero((line.along > 0.0) & near[:-1] & near[1:])
    ends = np.stack([X[line.nodes[edges]], X[line.nodes[edges + 1]]], axis=1)
    away, nearest, share = _nearest(points, ends)
    along = lengths[edges[nearest]] + share * np.diff(lengths)[edges[nearest]]
    fades = np.clip(1.0 - away / (FAR * np.max(lengths[pleats.second] - lengths[pleats.first])), 0.0, None)
    return SLOPE * fades * pleats.heights(along, lengths)


def _nearest(points: np.ndarray, ends: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of points (k, 2): distances (k,) from the nearest of segments (m, 2, 2), which, and where on it (0 to 1)."""
    along = ends[:, 1] - ends[:, 0]
    off = points[:, None] - ends[:, 0]
    share = np.clip(np.einsum("kmi,mi->km", off, along) / np.einsum("mi,mi->m", along, along), 0.0, 1.0)
    far = np.linalg.norm(off - share[..., None] * along, axis=2)
    nearest = far.argmin(axis=1)
    every = np.arange(len(points))
    return far[every, nearest], nearest, share[every, nearest]
