"""What is kept from frame to frame: numbering, pattern, an old factor."""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import LinearOperator, cg, splu
from skfem import Basis, MeshTri

MOST_ITERATIONS = 10
"""Iterations after which a factor is too old."""


class Entries(NamedTuple):
    """Entries of a matrix: `indices` (2, n), and `data` (n,)."""

    indices: np.ndarray
    data: np.ndarray


def film_entries(ends, half, film):
    """Entries of a film over sides (k, 2) of half the length (k,)."""
    rows, columns = np.repeat(ends, 2, axis=1).ravel(), np.tile(ends, 2).ravel()
    values = film * half[:, None] * np.array([2 / 3, 1 / 3, 1 / 3, 2 / 3])
    return Entries(np.stack([rows, columns]), values.ravel())


class KeptNumbering:
    """Bases on moved geometry, with the numbers of unknowns of the first.

    Args:
        cells: (ne, 3) nodes; elements: by name, with the order of quadrature.
    """

    def __init__(self, cells, elements):
        self.cells, self.elements = np.ascontiguousarray(cells.T), elements
        self.dofs = {}

    def __call__(self, points):
        """A basis for each element."""
        mesh = MeshTri(np.ascontiguousarray(points.T), self.cells, validate=False)
        found = {}
        for name, (element, order) in self.elements.items():
            found[name] = Basis(mesh, element, intorder=order, dofs=self.dofs.get(name))
            self.dofs[name] = found[name].dofs
        return found


class KeptPattern:
    """Matrices of free unknowns with one pattern: only values are summed again.

    Args:
        free: ascending numbers of the unknowns that are free; count: of all unknowns.
    """

    def __init__(self, free, count):
        self.free, self.place = free, np.full(count, -1)
        self.place[free] = np.arange(len(free))
        self.slots = None

    def _find(self, indices):
        rows, columns = self.place[indices[0]], self.place[indices[1]]
        self.inside = (rows >= 0) & (columns >= 0)
        keys = columns[self.inside].astype(np.int64) * len(self.free) + rows[self.inside]
        unique, self.slots = np.unique(keys, return_inverse=True)
        self.rows = (unique % len(self.free)).astype(np.int32)
        starts = np.searchsorted(unique, np.arange(len(self.free) + 1) * len(self.free))
        self.starts = starts.astype(np.int32)

    def __call__(self, *entries):
        """The matrix of entries, each with `indices` (2, n) and `data` (n,), in the order of the first call."""
        if self.slots is None:
            self._find(np.concatenate([one.indices for one in entries], axis=1))
        data = np.concatenate([one.data for one in entries])
        values = np.bincount(self.slots, data[self.inside], len(self.rows))
        return csc_matrix((values, self.rows, self.starts), shape=(len(self.free),) * 2)


class OldFactor:
    """Conjugate gradients with an old complete factor, which is made again when it needs many iterations."""

    def __init__(self):
        self.factor, self.stale = None, True

    def __call__(self, matrix, right, guess, tolerance):
        """The solution, to a relative residual."""
        if self.stale:
            self.factor, self.stale = splu(matrix, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}), False
        count = [0]

        def counted(_):
            count[0] += 1

        by_factor = LinearOperator(matrix.shape, self.factor.solve)
        x, _ = cg(matrix, right, guess, rtol=tolerance, M=by_factor, callback=counted)
        self.stale = count[0] > MOST_ITERATIONS
        return x


class OldTangent:
    """Newton's method with an old factor of the tangent, made again where a step gains too little."""

    def __init__(self, symmetric):
        self.factor, self.symmetric = None, symmetric

    def __call__(self, x, free, residual, tangent, limit):
        """Free unknowns brought to a residual below the limit; `residual` and `tangent` are of all unknowns."""
        r, last = residual(x)[free], np.inf
        for _ in range(60):
            size = np.linalg.norm(r)
            if size <= limit:
                return x
            if self.factor is None or size > 0.3 * last:
                options = {"SymmetricMode": True} if self.symmetric else {}
                order = "MMD_AT_PLUS_A" if self.symmetric else "COLAMD"
                self.factor = splu(tangent(x), permc_spec=order, options=options)
            x[free] -= self.factor.solve(r)
            r, last = residual(x)[free], size
        raise RuntimeError("Newton's method has not converged")
