"""The surface of cloth as IPC Toolkit takes it, and where it crosses itself."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

SLACK = 1e-9
"""Part of an edge, or of a triangle's side, from whose ends on a passage counts."""
SPARSE = 16
"""Of so many edges one is looked at first, where some are known to pass through triangles."""


def unique_edges(cells: np.ndarray) -> np.ndarray:
    """Edges (m, 2) int32 of triangles (ne, 3), the smaller node first."""
    sides = np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]])
    return np.unique(np.sort(sides, axis=1), axis=0).astype(np.int32)


def columns(values: np.ndarray) -> np.ndarray:
    """The values (n, 3) by columns, as the library wants them."""
    return np.asfortranarray(values, dtype=float)


class CollisionSurface:
    """Triangles of one sheet, for the broad phase and the collisions of IPC Toolkit.

    Args:
        X: (n, 2) material coordinates [m]; cells: (ne, 3) triangles.

    Attributes:
        edges: (m, 2) int32 nodes; cells: (ne, 3) int32.
        sewn: what seams join, of `NearPairs.sew`; None: there are none.

    Source: Ferguson and others, IPC Toolkit; Li and others, ACM TOG 39(4), 2020, 49.
    """

    def __init__(self, X: np.ndarray, cells: np.ndarray) -> None:
        self.edges, self.cells = unique_edges(cells), np.array(cells, np.int32)
        self.sewn: tuple[np.ndarray, np.ndarray] | None = None
        self.place(X)

    def place(self, X: np.ndarray) -> None:
        """Take in where the nodes are in the material, (n, 2) [m]."""
        self.flat = columns(np.column_stack([X, np.zeros(len(X))]))
        self.__dict__.pop("mesh", None)

    def sew(self, numbers: np.ndarray, pairs: np.ndarray) -> bool:
        """Let nodes of one of the numbers (n,), and of pairs (k, 2) of numbers, be as one: their parts do not meet.

        Returns: whether they are others than before.
        """
        before, self.sewn = self.sewn, (numbers, pairs)
        return before is None or not all(map(np.array_equal, before, self.sewn))

    def as_one(self, first: np.ndarray, second: np.ndarray) -> np.ndarray:
        """Whether nodes (m,) and others (m,) are the same, or sewn together."""
        if self.sewn is None:
            return first == second
        numbers, pairs = self.sewn
        n, i, j = np.int64(len(numbers)), numbers[first], numbers[second]
        keys = np.minimum(i, j) * n + np.maximum(i, j)
        return (i == j) | np.isin(keys, pairs[:, 0] * n + pairs[:, 1])

    @property
    def sewn_nodes(self) -> np.ndarray:
        """Whether each node (n,) is sewn to another one, or to a place between two."""
        if self.sewn is None:
            return np.zeros(len(self.flat), bool)
        numbers, pairs = self.sewn
        several = np.bincount(numbers, minlength=len(numbers)) > 1
        several[pairs] = True
        return several[numbers]

    @cached_property
    def library(self) -> Any:
        """The module `ipctk`, loaded when cloth first needs it, on one thread."""
        import ipctk

        ipctk.set_num_threads(1)
        return ipctk

    @cached_property
    def mesh(self) -> Any:
        """The library's `CollisionMesh`."""
        edges, cells = (np.asfortranarray(part) for part in (self.edges, self.cells))
        return self.library.CollisionMesh(self.flat, edges, cells)

    def crosses(self, x: np.ndarray) -> bool:
        """Whether an edge passes through a triangle at positions x (n, 3)."""
        meet = bool(self.library.has_intersections(self.mesh, columns(x), self.library.LBVH()))
        return meet and (self.sewn is None or len(self._passed(x, self.edges, self.cells)) > 0)

    def crossed(self, x: np.ndarray) -> np.ndarray:
        """Numbers (k,) of the triangles that edges of others pass through at positions x (n, 3)."""
        if not np.isfinite(x).all() or not self.crosses(x):
            return np.empty(0, np.int64)
        # Where most triangles are crossed a few edges show it, and pairs of all are millions.
        some = self._passed(x, self.edges[::SPARSE], self.cells)
        left = np.setdiff1d(np.arange(len(self.cells)), some)
        more = left[self._passed(x, self.edges, self.cells[left])] if len(left) else left
        return np.union1d(some, more)

    def _passed(self, x: np.ndarray, edges: np.ndarray, cells: np.ndarray) -> np.ndarray:
        """Which of some triangles (ne, 3) edges (m, 2) pass through at positions x (n, 3): numbers (k,)."""
        search = self.library.LBVH()
        search.build(columns(x), np.asfortranarray(edges), np.asfortranarray(cells))
        near = search.detect_edge_face_candidates()
        edge, cell = np.array([(pair.edge_id, pair.face_id) for pair in near], np.int64).reshape(-1, 2).T
        ends, corners = edges[edge], cells[cell]
        first, second = np.broadcast_arrays(ends[:, :, None], corners[:, None, :])
        apart = ~self.as_one(first.ravel(), second.ravel()).reshape(first.shape).any(axis=(1, 2))
        hit = passes_through(x[ends[apart]], x[corners[apart]])
        return np.unique(cell[apart][hit])


def passes_through(edges: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Whether edges (m, 2, 3) pass through the triangles (m, 3, 3) beside them.

    Source: Möller and Trumbore, Journal of Graphics Tools 2(1), 1997, 21.
    """
    start, way = edges[:, 0], edges[:, 1] - edges[:, 0]
    first, second = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    normal = np.cross(way, second)
    volume = np.einsum("ma,ma->m", first, normal)
    scale = np.where(volume == 0.0, np.inf, volume)
    offset = start - triangles[:, 0]
    turned = np.cross(offset, first)
    u = np.einsum("ma,ma->m", offset, normal) / scale
    v = np.einsum("ma,ma->m", way, turned) / scale
    t = np.einsum("ma,ma->m", second, turned) / scale
    return (np.minimum.reduce([u, v, 1.0 - u - v, t, 1.0 - t]) > SLACK) & (volume != 0.0)
