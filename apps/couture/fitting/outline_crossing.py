"""Outlines that cross themselves: their area and their middle are not those of a shadow."""

from __future__ import annotations

import numpy as np

from restshape.errors import UserError

LOOP = 0.01
"""Area of a loop over that of the rest from which a crossing is none of noise."""


def refuse_crossing(points: np.ndarray, where: str) -> None:
    """Refuse a closed line of points (m, 2) [m] that crosses itself, apart from loops as small as noise makes them.

    Raises:
        UserError: with the place.
    """
    a = _pieces(points)
    b = np.roll(a, -1, axis=0)
    i, j = _meetings(a, b)
    if not len(i):
        return
    cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    before = np.concatenate([[0.0], np.cumsum(cross)])
    closing = a[j, 0] * b[i, 1] - a[j, 1] * b[i, 0]
    loop = before[j] - before[i + 1] + closing
    ends = np.abs(np.stack([loop, before[-1] - loop]))
    share = ends.min(axis=0) / np.maximum(ends.max(axis=0), np.finfo(float).tiny)
    worst = int(share.argmax())
    if share[worst] > LOOP:
        x, y = 1e3 * a[i[worst]]
        what = f"the outline crosses itself near ({x:.4g}, {y:.4g}) mm, y upwards"
        raise UserError(what, where, "draw the edge of the shadow, once round and without loops")


def _pieces(points: np.ndarray) -> np.ndarray:
    """Points (k, 2) on the line, with none of its pieces longer than the mean of its segments."""
    way = np.roll(points, -1, axis=0) - points
    lengths = np.hypot(*way.T)
    counts = np.maximum(np.ceil(lengths / max(float(lengths.mean()), np.finfo(float).tiny)).astype(int), 1)
    row = np.repeat(np.arange(len(points)), counts)
    along = (np.arange(len(row)) - np.repeat(np.cumsum(counts) - counts, counts)) / counts[row]
    return points[row] + along[:, None] * way[row]


def _meetings(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rows i < j of segments from a to b (k, 2) that meet, without neighbours."""
    from scipy.spatial import cKDTree

    longest = float(np.hypot(*(b - a).T).max())
    # Segments that meet have middles no farther apart than the longest of them.
    i, j = cKDTree(0.5 * (a + b)).query_pairs(longest * (1.0 + 1e-9), output_type="ndarray").T
    beside = (j - i == 1) | (j - i == len(a) - 1)
    apart = (np.maximum(a[i], b[i]) < np.minimum(a[j], b[j])) | (np.maximum(a[j], b[j]) < np.minimum(a[i], b[i]))
    near = ~(beside | apart.any(axis=1))
    i, j = i[near], j[near]
    meets = (_left(a[i], b[i], a[j]) * _left(a[i], b[i], b[j]) <= 0.0) & (
        _left(a[j], b[j], a[i]) * _left(a[j], b[j], b[i]) <= 0.0
    )
    return i[meets], j[meets]


def _left(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Signs (k,) of the side of the way from a to b on which c is, left being positive."""
    return np.sign((b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0]))
