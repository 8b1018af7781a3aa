"""The surface of a body as binary STL in millimetres, for slicers: closed where the body has a thickness."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from restshape.export.frame_mesh import FrameMesh
from restshape.outputs.atomic_files import replacing
from restshape.outputs.kinds import EXPORT_MARK

MM = 1e3
TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
FOURTHS = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]])
"""The four triangles of a second-order one, whose sides bend in their middles."""
TETRAHEDRON = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
HEXAHEDRON = np.array([[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]])
FACES = {"tetra": TETRAHEDRON, "tetra10": TETRAHEDRON, "hexahedron": HEXAHEDRON}
"""Faces of cells, seen from outside."""


def write_stl(mesh: FrameMesh, thickness: float | np.ndarray | None, path: Path) -> None:
    """Writes the surface of a mesh.

    Of tetrahedra and hexahedra it is their border; of cloth in space the cloth; of a plane mesh the closed surface of
    the body over it, from z = 0 up.

    Args:
        mesh: in the plane or in space.
        thickness: of the body over a plane mesh [m], of all of it or (n,) at its nodes; None: the plane mesh itself,
            which is not closed.
        path: of the file.

    Raises:
        OSError: it cannot be written.
    """
    corners = MM * surface(mesh, thickness)
    rows = np.zeros(len(corners), dtype=TRIANGLE)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    rows["normal"], rows["corners"] = normal / np.where(length > 0.0, length, 1.0), corners
    with replacing(path) as part, part.open("r+b") as file:
        file.write(EXPORT_MARK.encode().ljust(80, b"\0"))
        file.write(np.uint32(len(rows)).tobytes())
        file.write(rows.tobytes())


def surface(mesh: FrameMesh, thickness: float | np.ndarray | None) -> np.ndarray:
    """The triangles (m, 3, 3) [m] of the surface, counter-clockwise seen from outside; see `write_stl`."""
    if mesh.cell_type in FACES:
        return mesh.X[_border_faces(mesh.cells, FACES[mesh.cell_type])]
    cells = mesh.cells if mesh.cells.shape[1] == 3 else mesh.cells[:, FOURTHS].reshape(-1, 3)
    if mesh.placed is not None:
        return mesh.placed[cells]
    flat = np.column_stack([mesh.X, np.zeros(len(mesh.X))])
    if thickness is None:
        return flat[cells]
    top = np.column_stack([mesh.X, np.broadcast_to(thickness, len(mesh.X))])
    a, b = _border_sides(cells).T
    walls = [np.stack([flat[a], flat[b], top[b]], 1), np.stack([flat[a], top[b], top[a]], 1)]
    return np.concatenate([top[cells], flat[cells[:, ::-1]], *walls])


def _border_sides(cells: np.ndarray) -> np.ndarray:
    """Sides (m, 2) of one triangle (ne, 3) alone, which is on their left."""
    sides = cells[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    return sides[_alone(sides)]


def _border_faces(cells: np.ndarray, of_cell: np.ndarray) -> np.ndarray:
    """Triangles (m, 3), seen from outside, of the faces that one cell (ne, k) alone has."""
    faces = cells[:, of_cell].reshape(-1, of_cell.shape[1])
    faces = faces[_alone(faces)]
    return np.concatenate([faces[:, [0, i, i + 1]] for i in range(1, faces.shape[1] - 1)])


def _alone(facets: np.ndarray) -> np.ndarray:
    """Which facets (m, k) have the nodes of no other one."""
    _, first, counts = np.unique(np.sort(facets, axis=1), axis=0, return_index=True, return_counts=True)
    return np.sort(first[counts == 1])
