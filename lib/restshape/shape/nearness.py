"""How far points are from straight sides."""

import numpy as np

from restshape.arrays import Reals

AT_ONCE = 1 << 20
"""Pairs of a point and a side that are looked at together."""


def distances(points: Reals, starts: Reals, ends: Reals) -> Reals:
    """Distances (m,) of points (m, 2) from the nearest of sides (k, 2) to (k, 2), in the unit of both."""
    sides = ends - starts
    squares = np.maximum((sides**2).sum(axis=1), 1e-300)
    parts = np.array_split(points, 1 + len(points) * len(sides) // AT_ONCE)
    return np.concatenate([_nearest(part, starts, sides, squares) for part in parts])


def _nearest(points: Reals, starts: Reals, sides: Reals, squares: Reals) -> Reals:
    away = points[:, None] - starts
    share = np.clip((away * sides).sum(axis=2) / squares, 0.0, 1.0)
    apart = away - share[:, :, None] * sides
    return np.hypot(apart[:, :, 0], apart[:, :, 1]).min(axis=1)
