"""How far a shape is from the one whose eigenvalues an inertia count has checked last."""

import numpy as np

from restshape.fem.space import Space

SHARE = 0.05
"""Of a body's size: where nodes are farther than this from where they were at the last count, the next one is due."""


class VerifiedShape:
    """The shape whose eigenvalues were last counted, and so are known to be all there.

    Nodes in the middle of sides do not count: flips set them elsewhere though the shape stays.
    """

    def __init__(self) -> None:
        self._X = np.empty((0, 2))
        self._far = 0.0

    def due(self, mesh: Space) -> bool:
        """Whether a mesh is far from that shape, or has other nodes."""
        X = mesh.mesh.X
        return X.shape != self._X.shape or float(np.abs(X - self._X).max()) > self._far

    def update(self, mesh: Space) -> None:
        """Take a mesh for the one that was counted on."""
        self._X = mesh.mesh.X.copy()
        self._far = SHARE * float(np.linalg.norm(np.ptp(self._X, axis=0)))
