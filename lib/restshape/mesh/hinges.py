"""Sides of triangles at the edges of a mesh: hinges between two of them, and the one side at an edge of the border."""

import numpy as np


def inner_sides(cell_edges: np.ndarray) -> np.ndarray:
    """The two sides (m, 2) of each inner edge, side i of triangle e being 3 e + i, by the numbers of the edges.

    Args:
        cell_edges: (ne, 3) edge opposite to corner i.
    """
    flat = cell_edges.ravel()
    order = np.argsort(flat, kind="stable")
    pairs = np.flatnonzero(flat[order[1:]] == flat[order[:-1]])
    return np.column_stack([order[pairs], order[pairs + 1]])


def hinges(cells: np.ndarray, cell_edges: np.ndarray) -> np.ndarray:
    """Nodes (m, 4) int32 of each inner edge: its ends, the corner on its left, and the corner on its right.

    Args:
        cells: (ne, 3) nodes of triangles, counter-clockwise.
        cell_edges: (ne, 3) edge opposite to corner i.
    """
    sides = inner_sides(cell_edges)
    left = _sided(cells, sides[:, 0])
    return np.column_stack([left, cells.ravel()[sides[:, 1]]]).astype(np.int32)


def border_cells(cells: np.ndarray, cell_edges: np.ndarray, edges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The triangle (k,) at each edge (k,) of the border, and its nodes (k, 3) int32: the edge's ends, with it on the
    left, and the corner opposite. Arguments as of `hinges`."""
    if not len(edges):
        return np.empty(0, dtype=np.intp), np.empty((0, 3), dtype=np.int32)
    flat = cell_edges.ravel()
    sides = np.flatnonzero(np.isin(flat, edges))
    sides = sides[np.argsort(flat[sides], kind="stable")]
    sides = sides[np.searchsorted(flat[sides], edges)]
    return sides // 3, np.ascontiguousarray(_sided(cells, sides), dtype=np.int32)


def _sided(cells: np.ndarray, sides: np.ndarray) -> np.ndarray:
    """Nodes (k, 3) of triangles from their sides (k,) on: the side's ends, and the corner opposite."""
    cell, corner = np.divmod(sides, 3)
    return np.column_stack([cells[cell, (corner + k) % 3] for k in (1, 2, 0)])


def normals(X: np.ndarray, nodes: np.ndarray) -> np.ndarray:
    """Unit vectors (k, 2) on the right of the ways from the first to the second of nodes (k, 2 or more) at X (n, 2)."""
    d = X[nodes[:, 1]] - X[nodes[:, 0]]
    return np.column_stack([d[:, 1], -d[:, 0]]) / np.linalg.norm(d, axis=1)[:, None]


def normal_rates(X: np.ndarray, nodes: np.ndarray, dX: np.ndarray) -> np.ndarray:
    """Rates (k, 2) of `normals` when nodes at X (n, 2) move with dX (n, 2)."""
    d, dd = (values[nodes[:, 1]] - values[nodes[:, 0]] for values in (X, dX))
    n = normals(X, nodes)
    turned = np.column_stack([dd[:, 1], -dd[:, 0]])
    return (turned - np.einsum("ka,ka->k", turned, n)[:, None] * n) / np.linalg.norm(d, axis=1)[:, None]
