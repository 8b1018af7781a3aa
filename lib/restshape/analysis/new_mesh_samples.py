"""Points in all cells of a new mesh, at which fields of the mesh before it are looked at."""

from functools import cached_property

import numpy as np

from restshape.fem.space import Space
from restshape.mesh.quadratic_basis import quadratic_basis
from restshape.mesh.quadrature import SAMPLES
from restshape.mesh.transfer import Transfer

LINEAR_SLOPES = np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]])
"""Those of the basis of first order along both directions of a cell, (3, 2)."""


class CellSamples:
    """The points of `quadrature.SAMPLES` in each cell of a new mesh.

    Args:
        old, new: the mesh before, and the new one of triangles of 3 or 6 nodes.

    Attributes:
        weights: (q,) of the points, which sum to 1; values: (q, k), slopes: (q, k, 2) of the basis there.
    """

    def __init__(self, old: Space, new: Space) -> None:
        self.old, self.new = old, new
        points, self.weights = SAMPLES
        x, y = points[:, 1:].T
        if new.cells.shape[1] == 6:
            self.values, self.slopes = quadratic_basis(points[:, 1:])
        else:
            self.values = np.column_stack([1.0 - x - y, x, y])
            self.slopes = np.broadcast_to(LINEAR_SLOPES, (len(points), 3, 2))

    @cached_property
    def found(self) -> Transfer:
        """Where they lie in the old mesh, the first points (ne,) of all cells before the second ones."""
        return Transfer(self.old, (self.values @ self._nodal(self.new.X)).reshape(-1, 2))

    def along(self, field: np.ndarray) -> np.ndarray:
        """Slopes (q, 2, ne, f) of a field (n, f) on the new mesh along both directions of its cells."""
        rows = self.slopes.transpose(0, 2, 1).reshape(-1, self.slopes.shape[1])
        # Products of two matrices, with a column for each cell and component: einsum takes four times as long.
        return (rows @ self._nodal(field)).reshape(len(self.weights), 2, len(self.new.cells), -1)

    def _nodal(self, field: np.ndarray) -> np.ndarray:
        return field[self.new.cells.T].reshape(self.new.cells.shape[1], -1)

    def nodal_sums(self, shares: np.ndarray) -> np.ndarray:
        """What cells give to their nodes, (n, 2), of shares (k, ne, 2)."""
        nodes = self.new.cells.T.ravel()
        return np.column_stack([np.bincount(nodes, shares[..., a].ravel(), len(self.new.X)) for a in (0, 1)])
