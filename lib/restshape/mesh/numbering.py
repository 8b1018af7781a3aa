"""Node and cell orders that keep neighbours close in memory."""

from __future__ import annotations

import numpy as np

from restshape import _kernels


def hilbert_keys(points: np.ndarray) -> np.ndarray:
    """Place (n,) of each point (n, 2) along a Hilbert curve that fills the box around all points."""
    return _kernels.hilbert_keys(points)


def node_order(X: np.ndarray) -> np.ndarray:
    """Nodes (n,) in their order along a Hilbert curve, those at one place of it by their numbers.

    Args:
        X: (n, 2) positions [m].
    """
    return _kernels.node_order(X)


def cell_order(cells: np.ndarray, n_nodes: int) -> np.ndarray:
    """Triangles (ne,) in their new order: by the smallest node, then by the others.

    Args:
        cells: (ne, 3) nodes; n_nodes: number of nodes.
    """
    return _kernels.cell_order(np.ascontiguousarray(cells, dtype=np.int32), n_nodes)
