"""Morley's unknowns on a nested mesh, from those on the mesh that it is nested in."""

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix

from restshape.mesh.morley import MorleySpace
from restshape.mesh.nested import Refined


class MorleyProlongation:
    """The piecewise quadratic of a coarse space, taken at the corners and edges of the fine one.

    Where two triangles meet, the mean of both is taken: they agree at the ends of a side, and in the slope at its
    middle, but not along it. Quadratic functions are reproduced, also at nodes that lie on bent edges.

    Args:
        step: from the mesh of the coarse space to that of the fine one.
        coarse, fine: spaces over them; their nodes may move, their edges may not flip.
    """

    def __init__(self, step: Refined, coarse: MorleySpace, fine: MorleySpace) -> None:
        self.coarse, self.fine = coarse, fine
        cells = fine.mesh.cells.reshape(-1, 4, 3)
        self._nodes = cells[:, 3]
        self._edges = fine.mesh.cell_edges.reshape(-1, 4, 3)[:, :3].reshape(-1, 9)
        kept = fine.corner_number[step.corner_number]
        new = np.hstack([fine.corner_number[self._nodes], fine.side_number[self._edges]])
        seen = np.bincount(new.ravel(), minlength=fine.n_nodes)[new]
        self._weights = (1.0 / seen)[:, :, None]
        columns = np.hstack([coarse.corner_number[coarse.mesh.cells], coarse.side_number[coarse.mesh.cell_edges]])
        self._rows = np.concatenate([kept, np.repeat(new.ravel(), 6)])
        self._columns = np.concatenate([coarse.corner_number, np.repeat(columns, 12, axis=0).ravel()])
        self._pattern()

    def matrix(self) -> csr_matrix:
        """The matrix (n_fine, n_coarse) for one value a node, where the nodes lie now; its pattern stays."""
        triangles = self._triangles()
        entries = np.concatenate([self._values(*triangles), self._slopes(*triangles)], axis=1) * self._weights
        values = np.concatenate([np.ones(len(self.coarse.corner_number)), entries.ravel()])
        data = np.bincount(self._slots, values, len(self._indices))
        shape = (self.fine.n_nodes, self.coarse.n_nodes)
        return csr_matrix((data, self._indices, self._indptr), shape=shape)

    def _pattern(self) -> None:
        """Set the pattern of the matrix, and which of its places each entry adds to."""
        shape = (self.fine.n_nodes, self.coarse.n_nodes)
        pattern = coo_matrix((np.ones(len(self._rows)), (self._rows, self._columns)), shape=shape).tocsr()
        pattern.sort_indices()
        self._indices, self._indptr = pattern.indices, pattern.indptr
        keys = np.repeat(np.arange(shape[0], dtype=np.int64), np.diff(self._indptr)) * shape[1] + self._indices
        self._slots = np.searchsorted(keys, self._rows.astype(np.int64) * shape[1] + self._columns)

    def _triangles(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Gradients (ne, 3, 2) of the coarse cells' barycentric coordinates, their slopes (ne, 3, 3) along the normals
        of the sides, and those (ne, 3) along the normal opposite to each corner."""
        mesh = self.coarse.mesh
        X = mesh.X[mesh.cells]
        sides = np.roll(X, -2, axis=1) - np.roll(X, -1, axis=1)
        double = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]
        gradients = np.stack([-sides[..., 1], sides[..., 0]], axis=2) / double[:, None, None]
        along = np.einsum("cik,cek->cie", gradients, self.coarse.normals()[mesh.cell_edges])
        return gradients, along, np.einsum("cii->ci", along)

    def _barycentric(self, gradients: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Barycentric coordinates (ne, q, 3) of points (ne, q, 2) in the coarse cells."""
        corners = self.coarse.mesh.X[self.coarse.mesh.cells]
        away = points[:, :, None] - corners[:, None]
        return 1.0 + np.einsum("cqik,cik->cqi", away, gradients)

    def _values(self, gradients: np.ndarray, along: np.ndarray, own: np.ndarray) -> np.ndarray:
        """Values (ne, 3, 6) of the coarse cells' six functions at the fine nodes in the middle of their sides."""
        places = self._barycentric(gradients, self.fine.mesh.X[self._nodes])
        return _joined(places, places * (1.0 - places) / own[:, None], along)

    def _slopes(self, gradients: np.ndarray, along: np.ndarray, own: np.ndarray) -> np.ndarray:
        """Slopes (ne, 9, 6) of the same functions along the normals of the fine edges in and around the cells."""
        mesh = self.fine.mesh
        places = self._barycentric(gradients, mesh.X[mesh.edge_nodes[self._edges]].mean(axis=2))
        rates = np.einsum("cik,cqk->cqi", gradients, self.fine.normals()[self._edges])
        return _joined(rates, (1.0 - 2.0 * places) * rates / own[:, None], along)


def _joined(linear: np.ndarray, sides: np.ndarray, along: np.ndarray) -> np.ndarray:
    """Parts (ne, q, 6) of the corners' and of the sides' functions.

    A side's function is l (1 - l), l being the coordinate of the corner opposite to it: 0 at all corners, without
    slope in the middle of the other sides. A corner's is its coordinate less what the sides need to lose their slopes.

    Args:
        linear: (ne, q, 3) of the corners' coordinates; sides: (ne, q, 3) of the sides' functions.
        along: (ne, 3, 3) slopes of the corners' coordinates along the sides' normals.
    """
    return np.concatenate([linear - np.einsum("cie,cqe->cqi", along, sides), sides], axis=2)
