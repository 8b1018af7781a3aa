"""Where flat cloth lies before it falls."""

from __future__ import annotations

import numpy as np

from restshape.mesh.mesh import Mesh
from restshape.scene.bodies import Start, evaluated


def rotation(angles: tuple[float, float, float]) -> np.ndarray:
    """The matrix (3, 3) that turns about x, then y, then z by angles [rad]."""
    R = np.eye(3)
    for axis, angle in enumerate(angles):
        c, s = np.cos(angle), np.sin(angle)
        turn = np.eye(3)
        i, j = (axis + 1) % 3, (axis + 2) % 3
        turn[i, i], turn[i, j], turn[j, i], turn[j, j] = c, -s, s, c
        R = turn @ R
    return R


class InitialPlacement:
    """Where the flat cloth lies before it falls.

    Args:
        start: of the scene; None: in the plane z = 0, where it was cut.
        parameters: of the scene.
    """

    def __init__(self, start: Start | None, parameters: dict[str, float]) -> None:
        self.start = evaluated(start or Start(), parameters)
        self.rotation = rotation(self.start.turn)

    def places(self, X: np.ndarray) -> np.ndarray:
        """Places (n, 3) [m] of material coordinates X (n, 2) [m]."""
        flat = np.column_stack([X, np.zeros(len(X))])
        about = np.array(self.start.about)
        return (flat - about) @ self.rotation.T + about + self.start.move

    def slopes(self, normals: np.ndarray) -> np.ndarray:
        """Derivatives (k, 3) of the places along directions (k, 2) of the material."""
        return normals @ self.rotation[:, :2].T

    def scattered(self, mesh: Mesh) -> np.ndarray:
        """Places (n, 3) [m] of a mesh's nodes, with the scatter of the start."""
        places = self.places(mesh.X)
        if self.start.scatter:
            random = np.random.default_rng(self.start.seed).uniform(-1.0, 1.0, places.shape)
            # In an order that does not hang on the number of ranks.
            places += self.start.scatter * random[mesh.places]
        return places
