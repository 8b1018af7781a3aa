"""Triangles cut into smaller ones that show a field smoothly, and follow curved sides."""

from functools import cache

import numpy as np

from restshape.mesh.quadratic_basis import quadratic_basis

ENOUGH = 6000
"""Small triangles of a picture at least, where cells are few."""
FINEST = 8
"""Pieces of a side at most."""


def pieces_of(cells: np.ndarray) -> int:
    """Into how many pieces each side of cells (ne, 3) or (ne, 6) is cut."""
    wanted = int(np.ceil(np.sqrt(ENOUGH / max(len(cells), 1))))
    return min(max(wanted, 1 if cells.shape[1] == 3 else 2), FINEST)


@cache
def pattern(nodes: int, pieces: int) -> tuple[np.ndarray, np.ndarray]:
    """Values of the basis (m, nodes) at the corners of the small triangles of a cell, and their corners (k, 3).

    Args:
        nodes: of the cell, 3 or 6.
        pieces: of each side.
    """
    steps = [(i, j) for j in range(pieces + 1) for i in range(pieces + 1 - j)]
    number = {step: k for k, step in enumerate(steps)}
    small = []
    for i, j in steps:
        if i + j < pieces:
            small.append([number[i, j], number[i + 1, j], number[i, j + 1]])
        if i + j < pieces - 1:
            small.append([number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]])
    at = np.array(steps, dtype=float) / pieces
    basis = np.column_stack([1.0 - at.sum(axis=1), at]) if nodes == 3 else quadratic_basis(at)[0]
    return basis, np.array(small)


def smooth_triangles(x: np.ndarray, cells: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Places (m, 2), triangles (k, 3) between them, and values (m,) that show a field on cells.

    Args:
        x: (n, 2) places of the nodes.
        cells: (ne, 3) or (ne, 6).
        values: (ne, 3) or (ne, 6) at the nodes of each cell.
    """
    basis, small = pattern(cells.shape[1], pieces_of(cells))
    places = np.einsum("mk,ekd->emd", basis, x[cells]).reshape(-1, 2)
    first = len(basis) * np.arange(len(cells))
    triangles = (first[:, None, None] + small).reshape(-1, 3)
    return places, triangles, (values @ basis.T).ravel()
