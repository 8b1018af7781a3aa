"""Where the flat cloth lies before it falls."""

from __future__ import annotations

import numpy as np

from restshape.mesh.mesh import Mesh
from restshape.scene.model import Scene
from restshape.shape.panel_placement import PatternPlacement

ALL = slice(None)


class InitialPlacement:
    """Where the flat cloth lies before it falls.

    Args:
        scene: of cloth; a sheet that it places nowhere lies in the plane z = 0, where it was cut.
    """

    def __init__(self, scene: Scene) -> None:
        self._pattern = PatternPlacement(scene)
        self.start = self._pattern.start

    def coordinates(self, mesh: Mesh, nodes: np.ndarray | slice = ALL) -> np.ndarray:
        """Coordinates (k, 2) [m] of nodes of a mesh in their own panels; X of one sheet."""
        return self._pattern.coordinates(mesh.X[nodes], mesh.node_piece[nodes])

    def places(self, mesh: Mesh, nodes: np.ndarray | slice = ALL) -> np.ndarray:
        """Places (k, 3) [m] of nodes of a mesh."""
        return self._pattern.places(mesh.X[nodes], mesh.node_piece[nodes])

    def directions(self, mesh: Mesh, nodes: np.ndarray | slice, d: np.ndarray) -> np.ndarray:
        """Derivatives (k, 3) of the places along directions d (k, 2) of the pattern plane at nodes (k,)."""
        return self._pattern.directions(d, mesh.X[nodes], mesh.node_piece[nodes])

    def scattered(self, mesh: Mesh) -> np.ndarray:
        """Places (n, 3) [m] of a mesh's nodes, with the scatter of the start."""
        places = self.places(mesh)
        if self.start.scatter:
            random = np.random.default_rng(self.start.seed).uniform(-1.0, 1.0, places.shape)
            # In an order that does not hang on the number of ranks.
            places += self.start.scatter * random[mesh.places]
        return places
