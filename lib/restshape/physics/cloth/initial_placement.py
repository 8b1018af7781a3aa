"""Where flat cloth lies before it falls."""

from __future__ import annotations

import numpy as np

from restshape.mesh.mesh import Mesh
from restshape.scene.bodies import Start
from restshape.scene.space_values import evaluated
from restshape.shape.placement import placed, rotation


class InitialPlacement:
    """Where the flat cloth lies before it falls.

    Args:
        start: of the scene; None: in the plane z = 0, where it was cut.
        parameters: of the scene.
    """

    def __init__(self, start: Start | None, parameters: dict[str, float]) -> None:
        self.start = evaluated(start or Start(), parameters)

    def places(self, X: np.ndarray) -> np.ndarray:
        """Places (n, 3) [m] of material coordinates X (n, 2) [m]."""
        return placed(self.start, X)

    def slopes(self, normals: np.ndarray) -> np.ndarray:
        """Derivatives (k, 3) of the places along directions (k, 2) of the material."""
        return normals @ rotation(self.start.turn)[:, :2].T

    def scattered(self, mesh: Mesh) -> np.ndarray:
        """Places (n, 3) [m] of a mesh's nodes, with the scatter of the start."""
        places = self.places(mesh.X)
        if self.start.scatter:
            random = np.random.default_rng(self.start.seed).uniform(-1.0, 1.0, places.shape)
            # In an order that does not hang on the number of ranks.
            places += self.start.scatter * random[mesh.places]
        return places
