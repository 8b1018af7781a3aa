"""Whether a chain of boundary facets crosses or touches itself: gmsh does not come back from such a boundary."""

from __future__ import annotations

import numpy as np


def first_crossing(points: np.ndarray, segments: np.ndarray) -> tuple[int, int] | None:
    """Rows of two segments that cross, touch or fold onto each other; None if no two do.

    Args:
        points: (n, 2) [m].
        segments: (m, 2) rows of points; both the same for a single point.
    """
    from scipy.spatial import cKDTree

    a, b = points[segments[:, 0]], points[segments[:, 1]]
    reach = float(np.hypot(*(b - a).T).max())
    # Segments that meet have middles no farther apart than the longest of them.
    pairs = cKDTree(0.5 * (a + b)).query_pairs(reach * (1.0 + 1e-9), output_type="ndarray")
    i, j = pairs.T
    apart = (np.maximum(a[i], b[i]) < np.minimum(a[j], b[j])) | (np.maximum(a[j], b[j]) < np.minimum(a[i], b[i]))
    i, j = pairs[~apart.any(axis=1)].T
    shared = (segments[i][:, :, None] == segments[j][:, None, :]).any(axis=(1, 2))
    meets = (_side(a[i], b[i], a[j]) * _side(a[i], b[i], b[j]) <= 0.0) & (
        _side(a[j], b[j], a[i]) * _side(a[j], b[j], b[i]) <= 0.0
    )
    meets = np.where(shared, _folds(points, segments, i, j), meets)
    if not meets.any():
        return None
    row = int(np.argmax(meets))
    return int(i[row]), int(j[row])


def _side(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Twice the area (m,) of triangles, positive where c is left of the way from a to b."""
    return (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])


def _folds(points: np.ndarray, segments: np.ndarray, i: np.ndarray, j: np.ndarray) -> np.ndarray:
    """Whether segments i and j, which share an end, leave it in the same direction or are the same."""
    first, second = segments[i], segments[j]
    at_start = (first[:, :1] == second).any(axis=1)
    common = np.where(at_start, first[:, 0], first[:, 1])
    u = points[np.where(at_start, first[:, 1], first[:, 0])] - points[common]
    v = points[np.where(second[:, 0] == common, second[:, 1], second[:, 0])] - points[common]
    aligned = np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) <= 1e-9 * np.hypot(*u.T) * np.hypot(*v.T)
    return aligned & (np.sum(u * v, axis=1) >= 0.0)
