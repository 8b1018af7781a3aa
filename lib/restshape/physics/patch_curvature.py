"""Curvatures of cloth that knows only where its nodes are: quadratic surfaces fitted around each triangle."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_matrix

RIDGE = 1e-10
"""Share of the unit matrix in the normal equations: where too few nodes are near, the least curved surface is taken."""


class PatchCurvature:
    """Second derivatives in the middle of triangles, of quadratic functions fitted to the nodes around.

    A patch holds the nodes of all triangles that share a node with one: about twelve inside, six at least at a corner
    unless the mesh is smaller. Quadratic positions have their exact curvatures on any mesh.

    Args:
        X: (n, 2) material coordinates [m].
        cells: (ne, 3) nodes of triangles.

    Source: docs/theory.md, section "Error estimates".
    """

    def __init__(self, X: np.ndarray, cells: np.ndarray) -> None:
        n, ne = len(X), len(cells)
        ones, rows = np.ones(3 * ne), np.repeat(np.arange(ne), 3)
        touched = csr_matrix((ones, (rows, cells.ravel())), shape=(ne, n))
        self._touched = touched
        patches = (touched @ (touched.T @ touched)).tocsr()
        counts = np.diff(patches.indptr)
        owner = np.repeat(np.arange(ne), counts)
        away = X[patches.indices] - X[cells].mean(axis=1)[owner]
        # In units of each patch, so that all columns are of one size.
        size = np.sqrt(np.maximum.reduceat((away**2).sum(axis=1), patches.indptr[:-1]))
        x, y = (away / size[owner, None]).T
        basis = np.stack([np.ones_like(x), x, y, 0.5 * x * x, 0.5 * y * y, x * y], axis=1)
        normal = np.add.reduceat(basis[:, :, None] * basis[:, None, :], patches.indptr[:-1], axis=0)
        normal += RIDGE * np.eye(6)
        wanted = np.zeros((ne, 6, 3))
        # xx, yy and twice xy.
        wanted[:, [3, 4, 5], [0, 1, 2]] = np.array([1.0, 1.0, 2.0]) / size[:, None] ** 2
        weights = np.einsum("kb,kbc->kc", basis, np.linalg.solve(normal, wanted)[owner])
        self._parts = [csr_matrix((w, patches.indices, patches.indptr), shape=(ne, n)) for w in weights.T]

    def __call__(self, x: np.ndarray) -> np.ndarray:
        """Second derivatives (ne, f, 3) xx, yy and twice xy of values x (n, f) at the nodes."""
        return np.stack([part @ x for part in self._parts], axis=-1)

    def sums(self, values: np.ndarray) -> np.ndarray:
        """Sums (ne,) of values (ne,) over the triangles around, as often as they share a node with the one in the middle."""
        return self._touched @ (self._touched.T @ values)
