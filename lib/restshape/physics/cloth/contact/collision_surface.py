"""The surface of cloth as IPC Toolkit takes it, and where it crosses itself."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from restshape import _kernels


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
        changed = before is None or not all(map(np.array_equal, before, self.sewn))
        if changed:
            self.search.sew(numbers, pairs)
        return changed

    @cached_property
    def search(self) -> _kernels.NearPairs:
        """What may cross, found by trees of boxes over the flat sheet as it was first."""
        return _kernels.NearPairs(np.ascontiguousarray(self.flat[:, :2]), self.edges, self.cells)

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
        """Whether an edge passes through a triangle at positions x (n, 3); none does where they are no numbers."""
        if not np.isfinite(x).all():
            return False
        if self.sewn is not None:
            return len(self.search.crossed(x)) > 0
        return bool(self.library.has_intersections(self.mesh, columns(x), self.library.LBVH()))

    def crossed(self, x: np.ndarray) -> np.ndarray:
        """Numbers (k,) of the triangles that edges of others pass through at positions x (n, 3)."""
        return self.search.crossed(x) if np.isfinite(x).all() else np.empty(0, np.int32)
