"""Points in all cells of a new mesh, at which fields of the mesh before it are looked at."""

from functools import cached_property

import numpy as np

from restshape import _kernels
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
        at: (q, 2) reference coordinates of the points; weights: (q,) of them, which sum to 1.
        values: (q, k), slopes: (q, k, 2) of the basis there.
    """

    def __init__(self, old: Space, new: Space) -> None:
        self.old, self.new = old, new
        points, self.weights = SAMPLES
        self.at = np.ascontiguousarray(points[:, 1:])
        if new.cells.shape[1] == 6:
            self.values, self.slopes = quadratic_basis(self.at)
        else:
            self.values, self.slopes = points, np.broadcast_to(LINEAR_SLOPES, (len(points), 3, 2))

    @cached_property
    def found(self) -> Transfer:
        """Where they lie in the old mesh, all points (q,) of the first cell before those of the others."""
        X = self.values @ self._nodal(self.new.X)
        return Transfer(self.old, X.reshape(len(X), -1, 2).transpose(1, 0, 2).reshape(-1, 2), close=True)

    def lacking_forces(self, u: np.ndarray, start: np.ndarray, moduli: np.ndarray, means: np.ndarray) -> np.ndarray:
        """Nodal forces (n, 2) [N] of the strains that `start` (n, 2) on the new mesh lacks beside u on the old one.

        Args:
            u, start: displacements [m].
            moduli: (ne, 3) or (1, 3) Lame's two [Pa] and the thickness [m].
            means: (ne_old,) of the dilatation of u over cells, where elements take its mean; else empty.
        """
        old, new, found = self.old, self.new, self.found
        meshes = old.X, old.cells, u, new.X, new.cells, start
        points = self.at, self.weights, found.cells, found.weights
        # Those of cells of several materials are a part of their parameters.
        return _kernels.lacking_forces(*meshes, *points, np.ascontiguousarray(moduli), means)

    def momenta(self, v: np.ndarray, density: np.ndarray) -> np.ndarray:
        """Integrals (n, 2) [kg m/s] of the new basis of second order times the momentum of v (n_old, 2) [m/s].

        Args:
            v: velocities of the old mesh.
            density: (ne, 1) or (1,) mass an area [kg/m^2].
        """
        points = self.at, self.weights, self.found.cells, self.found.weights
        return _kernels.momenta(self.old.cells, v, self.new.X, self.new.cells, *points, density)

    def along(self, field: np.ndarray) -> np.ndarray:
        """Slopes (q, 2, ne, f) of a field (n, f) on the new mesh along both directions of its cells."""
        rows = self.slopes.transpose(0, 2, 1).reshape(-1, self.slopes.shape[1])
        # Products of two matrices, with a column for each cell and component: einsum takes four times as long.
        return (rows @ self._nodal(field)).reshape(len(self.weights), 2, len(self.new.cells), -1)

    def _nodal(self, field: np.ndarray) -> np.ndarray:
        return field[self.new.cells.T].reshape(self.new.cells.shape[1], -1)
