"""Curvatures of cloth that knows only where its nodes are: quadratic surfaces fitted around each triangle."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_matrix

RIDGE = (0.0, 0.0, 0.0, 1e-10, 1e-10, 1e-10)
"""On the diagonal of the normal equations: where too few nodes are near, the least curved surface is taken."""

TOGETHER = 2_000
"""Patches that are fitted at once: as many as caches hold."""


class PatchCurvature:
    """Second derivatives in the middle of triangles, of quadratic functions fitted to the nodes around.

    A patch holds the nodes of all triangles that share a node with one: about twelve inside, six at least at a corner
    unless the mesh is smaller. Quadratic positions have their exact curvatures on any mesh.

    Args:
        X: (n, 2) material coordinates [m].
        cells: (ne, 3) nodes of triangles.

    Source: docs/theory/error-estimates.md.
    """

    def __init__(self, X: np.ndarray, cells: np.ndarray) -> None:
        n, ne = len(X), len(cells)
        ones, rows = np.ones(3 * ne), np.repeat(np.arange(ne), 3)
        touched = csr_matrix((ones, (rows, cells.ravel())), shape=(ne, n))
        self._touched = touched
        patches = (touched @ (touched.T @ touched)).tocsr()
        weights, ends = np.empty((patches.nnz, 3)), patches.indptr
        for first in range(0, ne, TOGETHER):
            last = min(first + TOGETHER, ne)
            own = slice(ends[first], ends[last])
            away = X[patches.indices[own]]
            away -= np.repeat(X[cells[first:last]].mean(axis=1), np.diff(ends[first : last + 1]), axis=0)
            weights[own] = _weights(away, ends[first : last + 1] - ends[first])
        self._parts = [csr_matrix((w, patches.indices, ends), shape=(ne, n)) for w in weights.T.copy()]

    def __call__(self, x: np.ndarray) -> np.ndarray:
        """Second derivatives (ne, f, 3) xx, yy and twice xy of values x (n, f) at the nodes."""
        return np.stack([part @ x for part in self._parts], axis=-1)

    def sums(self, values: np.ndarray) -> np.ndarray:
        """Sums (ne,) of values (ne,) over the triangles around, each once for a node that it shares."""
        return self._touched @ (self._touched.T @ values)


def _weights(away: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Parts (k, 3) that nodes at `away` (k, 2) [m] have in xx, yy and twice xy.

    Patches lie between `ends`, which begin with 0.
    """
    owner = np.repeat(np.arange(len(ends) - 1), np.diff(ends))
    # In units of each patch, so that all columns are of one size.
    size = np.sqrt(np.maximum.reduceat((away**2).sum(axis=1), ends[:-1]))
    x, y = (away / size[owner, None]).T
    basis = np.stack([np.ones_like(x), x, y, 0.5 * x * x, 0.5 * y * y, x * y], axis=1)
    normal = np.add.reduceat(basis[:, :, None] * basis[:, None, :], ends[:-1], axis=0) + np.diag(RIDGE)
    wanted = np.zeros((len(size), 6, 3))
    # xx, yy and twice xy.
    wanted[:, [3, 4, 5], [0, 1, 2]] = np.array([1.0, 1.0, 2.0]) / size[:, None] ** 2
    return np.matmul(basis[:, None], np.linalg.solve(normal, wanted)[owner])[:, 0]
