"""Cells of meshes as triangles to draw: of first and second order, in the plane and in space."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from restshape.analysis.modal.nodal_lines import QUARTERS
from restshape.arrays import AnyArray, Integers, Reals
from restshape.live.frame_arrays import sent_indices

TETRAHEDRON = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
"""Corners of the faces of a tetrahedron, which look outwards."""
MIDDLES = np.array([[6, 5, 4], [4, 8, 7], [5, 9, 8], [7, 9, 6]])
"""Nodes in the middles of the sides of these faces, of the second order."""
HEXAHEDRON = np.array([[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]])
"""Corners of the faces of a hexahedron, likewise."""
LOW = (1 << 32) - 1
"""Bits of the second node of a side."""
SHARP = np.cos(np.radians(35.0))
"""Cosine of the angle between two faces above which their common side is drawn."""


@dataclass(frozen=True, eq=False)
class ShownTriangles:
    """ShownTriangles that show cells.

    Args:
        corners: (m, 3) rows of the shown nodes; border: (b, 2) sides that are drawn as the shape's; as they travel.
        nodes: (n,) of the mesh that are shown; None: all.
        cell: (m,) the cell of each triangle; local: (m, 3) which of its nodes the corners are.
        cell_size: nodes of a cell.
    """

    corners: AnyArray
    border: AnyArray
    nodes: Integers | None
    cell: Integers
    local: Integers
    cell_size: int

    @classmethod
    def none(cls) -> ShownTriangles:
        """No triangles."""
        empty = np.empty((0, 3), dtype=np.int64)
        return cls(sent_indices(empty, 0), sent_indices(empty[:, :2], 0), None, empty[:, 0], empty, 3)

    @property
    def parts(self) -> int:
        """Triangles of each cell that lie in a plane: all first ones come first, then all second ones, and so on."""
        return {6: 4, 8: 2, 10: 4}.get(self.cell_size, 1)

    def chosen(self, values: Reals) -> Reals:
        """Of values (n, ...) of all nodes those of the shown ones."""
        return values if self.nodes is None else values[self.nodes]

    def spread(self, values: Reals) -> Reals:
        """Values (ne,) of cells, or (ne, k) of their nodes, at the corners (m, 3) of the triangles."""
        if values.ndim == 1:
            return np.repeat(values[self.cell, None], 3, axis=1)
        found: Reals = values[self.cell[:, None], self.local]
        return found


def triangles_of(X: Reals, given: AnyArray, border: AnyArray | None = None) -> ShownTriangles:
    """ShownTriangles that show cells, as they lie.

    Args:
        X: (n, d) places of the nodes [m].
        given: cells (ne, k): 3 or 6 nodes of triangles, 4 or 10 of tetrahedra, 8 of hexahedra.
        border: of triangles, as it travels, where it is known from other cells on the same nodes; None: it is not.
    """
    number, k = np.arange(len(given)), given.shape[1]
    if k == 3 and border is not None:
        return ShownTriangles(
            sent_indices(given, len(X)), border, None, number, np.tile(np.arange(3), (len(given), 1)), k
        )
    cells: Integers = given.astype(np.int64)
    if k in (3, 6):
        parts = np.array([[0, 1, 2]] if k == 3 else QUARTERS)
        cell, local = np.tile(number, len(parts)), np.repeat(parts, len(cells), axis=0)
    elif k == 8:
        halves = [np.tile(HEXAHEDRON[:, half], (len(cells), 1)) for half in ([0, 1, 2], [0, 2, 3])]
        cell, local = np.tile(np.repeat(number, len(HEXAHEDRON)), 2), np.concatenate(halves)
    elif k in (4, 10):
        cell, local = _skin(cells)
    else:
        return ShownTriangles.none()
    corners = cells[cell[:, None], local]
    if k == 8:
        sides = np.concatenate(
            [HEXAHEDRON[:2][:, [i, (i + 1) % 4]] for i in range(4)] + [np.array([[0, 4]]) + i for i in range(4)]
        )
        border = cells[:, sides].reshape(-1, 2)
    else:
        border = drawn_sides(X, corners, creased=k in (4, 10))
    nodes = np.unique(corners) if k in (4, 10) else None
    if nodes is not None:
        place = np.zeros(len(X), dtype=np.int64)
        place[nodes] = np.arange(len(nodes))
        corners, border = place[corners], place[border]
    count = len(X) if nodes is None else len(nodes)
    return ShownTriangles(sent_indices(corners, count), sent_indices(border, count), nodes, cell, local, k)


def _skin(cells: Integers) -> tuple[Integers, Integers]:
    """The cell, and the local nodes (m, 3), of each triangle of the faces that one tetrahedron alone has."""
    faces = np.sort(cells[:, TETRAHEDRON].reshape(-1, 3), axis=1)
    _, first, counts = np.unique(faces, axis=0, return_index=True, return_counts=True)
    outer = np.sort(first[counts == 1])
    cell, face = outer // 4, outer % 4
    if cells.shape[1] == 4:
        return cell, TETRAHEDRON[face]
    six = np.column_stack([TETRAHEDRON[face], MIDDLES[face]])
    return np.tile(cell, 4), np.concatenate([six[:, part] for part in QUARTERS])


def drawn_sides(X: Reals, corners: Integers, creased: bool) -> Integers:
    """The sides (b, 2) that one triangle alone has; of a creased surface those between faces at an angle, too."""
    after = corners[:, [1, 2, 0]]
    key = (np.minimum(corners, after) << 32 | np.maximum(corners, after)).ravel()
    order = np.argsort(key, kind="stable") if creased else None
    rising = np.sort(key) if order is None else key[order]
    first = np.flatnonzero(np.append(True, rising[1:] != rising[:-1])[: len(rising)])
    counts = np.diff(np.append(first, len(rising)))
    alone = rising[first[counts == 1]]
    found = np.stack([alone >> 32, alone & LOW], axis=1)
    if order is None:
        return found
    a, b, c = (X[corners[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    pairs = first[counts == 2]
    one, other = order[pairs] // 3, order[pairs + 1] // 3
    sharp = (normals[one] * normals[other]).sum(axis=1) < SHARP
    creases = rising[pairs[sharp]]
    return np.concatenate([found, np.stack([creases >> 32, creases & LOW], axis=1)])
