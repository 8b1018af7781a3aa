"""Node and cell orders that keep neighbours close in memory."""

from __future__ import annotations

import numpy as np


def hilbert_keys(points: np.ndarray) -> np.ndarray:
    """Place (n,) of each point (n, 2) along a Hilbert curve that fills the box around all points."""
    # A grid of 16 squares for each point tells all but the closest neighbours apart.
    bits = int(np.ceil(0.5 * np.log2(len(points)))) + 2
    low, extent = points.min(axis=0), np.ptp(points, axis=0).max()
    scale = (2**bits - 1) / extent if extent > 0.0 else 0.0
    x, y = ((points - low) * scale).astype(np.int32).T.copy()
    key = np.zeros(len(points), dtype=np.int64)
    for bit in range(bits - 1, -1, -1):
        step = 1 << bit
        rx, ry = (x >> bit) & 1, (y >> bit) & 1
        key += ((3 * rx) ^ ry).astype(np.int64) << (2 * bit)
        # The quadrant's own curve is a turned one: reflect and swap so that the next bit reads like the first.
        turned = ry == 0
        mask = np.where(turned & (rx == 1), np.int32(step - 1), np.int32(0))
        x, y = x ^ mask, y ^ mask
        x, y = np.where(turned, y, x), np.where(turned, x, y)
    return key


def node_order(X: np.ndarray, owner: np.ndarray | None = None) -> np.ndarray:
    """Nodes (n,) in their new order: by owner, then along a Hilbert curve.

    Args:
        X: (n, 2) positions [m].
        owner: (n,) rank of each node; default: all the same.
    """
    key = hilbert_keys(X)
    return np.argsort(key, kind="stable") if owner is None else np.lexsort((key, owner))


def cell_order(cells: np.ndarray) -> np.ndarray:
    """Triangles (ne,) in their new order: by the smallest node, then by the others."""
    ordered = np.sort(cells, axis=1).astype(np.int64)
    return np.lexsort((ordered[:, 2], ordered[:, 1], ordered[:, 0]))
