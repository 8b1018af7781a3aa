"""Flat bodies that vibrate, as surfaces in space: bent as a mode bends them, larger than life."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from restshape.analysis.modal.nodal_lines import linear_triangles

LARGEST = 0.12
"""The largest displacement that is drawn, in parts of the body's size."""


@dataclass(frozen=True, eq=False)
class FlatBody:
    """A body between a bottom and a top over the plane.

    Args:
        X: (n, 2) nodes [m]; cells: (ne, 3) or (ne, 6) nodes of triangles of first or second order.
        thickness: (n,) [m].
    """

    X: np.ndarray
    cells: np.ndarray
    thickness: np.ndarray

    @cached_property
    def size(self) -> float:
        """Diagonal of the box around it [m]."""
        return float(np.linalg.norm(np.ptp(self.X, axis=0)))

    @cached_property
    def triangles(self) -> np.ndarray:
        """Flat triangles (m, 3) that stand for the cells, in the order that shows z up."""
        found = linear_triangles(self.cells).astype(np.int64)
        u, v = (self.X[found[:, k]] - self.X[found[:, 0]] for k in (1, 2))
        turned = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0] < 0.0
        found[turned] = found[turned][:, ::-1]
        return found

    @cached_property
    def sides(self) -> np.ndarray:
        """Straight pieces (s, 2) of the outline and of holes, the body on their left."""
        ends = np.concatenate([self.triangles[:, [i, (i + 1) % 3]] for i in range(3)])
        forth, back = ends[:, 0] * len(self.X) + ends[:, 1], ends[:, 1] * len(self.X) + ends[:, 0]
        return ends[~np.isin(forth, back)]

    def surface(self, displacement: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Top, bottom and rim as triangles: places (2 n, 3) [m], those of the top first, and corners (m, 3).

        Args:
            displacement: (n, 3) of the middle surface [m]; normals turn with it.
        """
        middle = np.column_stack([self.X, np.zeros(len(self.X))]) + displacement
        half = 0.5 * self.thickness[:, None] * _normals(middle, self.triangles)
        below, (a, b) = len(self.X), self.sides.T
        rim = np.concatenate([np.stack([b, a, a + below], axis=1), np.stack([b, a + below, b + below], axis=1)])
        faces = np.concatenate([self.triangles, self.triangles[:, ::-1] + below, rim])
        return np.concatenate([middle + half, middle - half]), faces

    def outline(self) -> np.ndarray:
        """The ends (s, 2, 3) [m] of the pieces of the outline, at rest."""
        return np.column_stack([self.X, np.zeros(len(self.X))])[self.sides]

    def drawn(self, shape: np.ndarray) -> np.ndarray:
        """A mode (n, 3) of any size as the displacements [m] with which it is drawn at its largest."""
        return LARGEST * self.size / np.linalg.norm(shape, axis=1).max() * shape


def _normals(places: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Unit normals (n, 3) at nodes (n, 3): of the triangles (m, 3) around, by their areas."""
    a, b, c = (places[triangles[:, k]] for k in range(3))
    of_triangle, found = np.cross(b - a, c - a), np.zeros_like(places)
    for k in range(3):
        np.add.at(found, triangles[:, k], of_triangle)
    length = np.linalg.norm(found, axis=1)
    found[length == 0.0] = (0.0, 0.0, 1.0)
    return found / np.where(length == 0.0, 1.0, length)[:, None]
