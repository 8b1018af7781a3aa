"""What cloth on a fine mesh has besides the cloth on a coarse one that it is nested in."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_matrix

from restshape import _kernels
from restshape.mesh.mesh import Mesh
from restshape.mesh.morley import MorleySpace
from restshape.mesh.nested import NestedMesh

NONE = 1e-300
"""Length of a way that is none."""


class FineCorrection:
    """Takes fine cloth apart into coarse cloth and a correction in the directions of that, and puts both together.

    Places of fine nodes are those of the coarse cloth, by barycentric coordinates, plus a vector of the correction;
    slopes of Morley's triangles are a vector of it. Directions are the normal of the coarse cloth and one along it,
    averaged at each node. So a motion of the coarse cloth takes the fine cloth along as it is.

    Args:
        nested: meshes of one shape.
        levels: how many of them, from the coarse one to the finest.
        morley: nodes over the finest; None: the unknowns are those of its nodes.

    Source: docs/theory/design-derivative.md; 5.3.5 of the thesis.
    """

    def __init__(self, nested: NestedMesh, levels: int, morley: MorleySpace | None) -> None:
        self.coarse, fine, steps = nested.meshes[-levels], nested.finest, nested.steps[-(levels - 1) :]
        corners, matrix = np.arange(len(self.coarse.X)), None
        for step in steps:
            corners, one = step.corner_number[corners], _means(step.parents, len(step.corner_number))
            matrix = one if matrix is None else one @ matrix
        self.fine_corners, self._prolongation = corners, matrix
        rows = _at_nodes(morley, fine) @ self._prolongation if morley else self._prolongation
        self._placed = np.ones(rows.shape[0], dtype=np.uint8)
        if morley:
            self._placed[morley.side_number] = 0
        self._rows = rows.indptr.astype(np.int32), rows.indices.astype(np.int32), rows.data
        self._next, self._sign = _neighbours(self.coarse)

    def restricted(self, values: np.ndarray) -> np.ndarray:
        """Values (..., n_coarse, k) at the coarse nodes, of those (..., corners, k) at the fine ones."""
        return values[..., self.fine_corners, :]

    def prolonged(self, values: np.ndarray) -> np.ndarray:
        """Values (corners, k) at the fine mesh's nodes by barycentric coordinates, of those (n_coarse, k)."""
        found: np.ndarray = self._prolongation @ values
        return found

    def of(self, coarse: np.ndarray, fine: np.ndarray) -> np.ndarray:
        """The correction (n, 3) [m] of fine unknowns (n, 3), where coarse nodes are at (n_coarse, 3)."""
        return self._vectors(coarse, fine, back=True)

    def rates(self, coarse: np.ndarray, fine: np.ndarray, slopes: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
        """Derivatives (k, n, 3) of the correction, from those (k, n_coarse, 3) and (k, n, 3) of both cloths.

        By differences so small that they are right to about eight digits: nothing but turns is not linear in them.
        """
        size, found = float(np.ptp(coarse, axis=0).max()), []
        for s, S in zip(*slopes):
            step = 1e-4 * size / max(float(np.abs(s).max()), float(np.abs(S).max()), NONE)
            ahead, behind = (self.of(coarse + way * s, fine + way * S) for way in (step, -step))
            found.append((ahead - behind) / (2.0 * step))
        return np.stack(found)

    def joined(self, coarse: np.ndarray, correction: np.ndarray) -> np.ndarray:
        """Fine unknowns (n, 3) of coarse nodes at (n_coarse, 3) and a correction (n, 3)."""
        return self._vectors(coarse, correction, back=False)

    def _vectors(self, coarse: np.ndarray, vectors: np.ndarray, back: bool) -> np.ndarray:
        """Vectors (n, 3) in the directions of the cloth put into space, beside its places, or back."""
        found = np.empty_like(vectors)
        cells, places = self.coarse.cells, np.ascontiguousarray(coarse)
        _kernels.nested_vectors(places, cells, self._next, self._sign, *self._rows, self._placed, vectors, back, found)
        return found


def _means(parents: np.ndarray, count: int) -> csr_matrix:
    """The matrix (n, count) of means between parents (n, 2)."""
    n = len(parents)
    return csr_matrix((np.full(2 * n, 0.5), (np.repeat(np.arange(n), 2), parents.ravel())), shape=(n, count))


def _at_nodes(morley: MorleySpace, mesh: Mesh) -> csr_matrix:
    """The matrix from the corners of a mesh to the nodes of Morley's triangles over it: edges have means."""
    ones = np.ones(len(mesh.X)), (morley.corner_number, np.arange(len(mesh.X)))
    shape = len(morley.X), len(mesh.X)
    rows = np.repeat(morley.side_number, 2)
    return csr_matrix(ones, shape=shape) + csr_matrix((np.full(len(rows), 0.5), (rows, mesh.edge_nodes.ravel())), shape)


def _neighbours(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    """A neighbour (n,) of each node, that which lies most along the first axis of the pattern, and its side (n,).

    Which one it is stays as it is, wherever the nodes go.
    """
    start, end = np.vstack([mesh.edge_nodes, mesh.edge_nodes[:, ::-1]]).T
    way = mesh.X[end] - mesh.X[start]
    order = np.lexsort((end, -np.abs(way[:, 0]) / np.linalg.norm(way, axis=1), start))
    first = order[np.searchsorted(start[order], np.arange(len(mesh.X)))]
    return end[first].astype(np.int32), np.sign(way[first, 0])
