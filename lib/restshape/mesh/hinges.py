"""Hinges of a triangle mesh: pairs of triangles about an inner edge."""

import numpy as np


def hinges(cells: np.ndarray, cell_edges: np.ndarray) -> np.ndarray:
    """Nodes (m, 4) int32 of each inner edge: its ends, the corner on its left, and the corner on its right.

    Args:
        cells: (ne, 3) nodes of triangles, counter-clockwise.
        cell_edges: (ne, 3) edge opposite to corner i.
    """
    flat = cell_edges.ravel()
    order = np.argsort(flat, kind="stable")
    pairs = np.flatnonzero(flat[order[1:]] == flat[order[:-1]])
    (cell, corner), (other, across) = (np.divmod(order[pairs + k], 3) for k in (0, 1))
    start, end = cells[cell, (corner + 1) % 3], cells[cell, (corner + 2) % 3]
    return np.column_stack([start, end, cells[cell, corner], cells[other, across]]).astype(np.int32)
