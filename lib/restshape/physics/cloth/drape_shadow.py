"""The shadow of a drape from above: its area, and the folds around it.

G. E. Cusick, The Measurement of Fabric Drape, Journal of the Textile Institute 59 (6), 1968: a round cloth on a smaller
disc casts a shadow, and the drape coefficient is the shadow's area over the cloth's, each less the disc's.
"""

from __future__ import annotations

import numpy as np

DIRECTIONS = 1440
"""Directions in which a shadow is measured."""
ROUNDING = 1e-9
"""Steps between directions by which one counts as that of a node."""
FOLD = 0.02
"""Share of the mean radius by which a shadow rises and falls where there is a fold."""


class DrapeShadow:
    """Measures the shadow of one mesh.

    Args:
        cells: (m, 3) triangles; border: (k, 2) facets around it, without those of holes.
    """

    def __init__(self, cells: np.ndarray, border: np.ndarray) -> None:
        sides = np.sort(np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]]), axis=1)
        self._edges = np.unique(sides, axis=0)
        self._around = border

    def radii(self, places: np.ndarray) -> np.ndarray:
        """How far the cloth reaches (`DIRECTIONS`,) [m] from the middle of its border, 0 where it does not reach.

        Args:
            places: (n, 3) of the nodes [m].
        """
        ends = places[self._around]
        lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        flat = places[:, :2] - np.average(ends[:, :, :2].mean(axis=1), axis=0, weights=lengths)
        return reach(flat[self._edges[:, 0]], flat[self._edges[:, 1]])

    def area(self, places: np.ndarray) -> float:
        """Area [m^2] of the shadow, as far as it is seen from its middle: gaps between that and the cloth are in it."""
        return float(0.5 * (self.radii(places) ** 2).sum() * 2.0 * np.pi / DIRECTIONS)

    def folds(self, places: np.ndarray) -> int:
        """Number of the folds that reach out of the shadow."""
        return count_folds(self.radii(places))


def reach(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The largest distance (`DIRECTIONS`,) from the origin to segments from a (m, 2) to b (m, 2), in each direction."""
    cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    # Each segment the way round in which its angle rises, by less than half a turn.
    a, b = np.where(cross[:, None] < 0.0, b, a), np.where(cross[:, None] < 0.0, a, b)
    step = 2.0 * np.pi / DIRECTIONS
    low = np.arctan2(a[:, 1], a[:, 0])
    span = np.arctan2(np.abs(cross), (a * b).sum(axis=1))
    first = np.ceil(low / step - ROUNDING).astype(int)
    count = np.maximum(np.floor((low + span) / step + ROUNDING).astype(int) - first + 1, 0)
    row = np.repeat(np.arange(len(a)), count)
    number = first[row] + np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
    way = np.stack([np.cos(step * number), np.sin(step * number)], axis=1)
    along = b[row] - a[row]
    across = way[:, 0] * along[:, 1] - way[:, 1] * along[:, 0]
    ends = np.maximum(np.hypot(*a[row].T), np.hypot(*b[row].T))
    # A segment along the direction reaches as far as its farther end.
    slanted = across > ROUNDING * np.hypot(*along.T)
    far = np.where(slanted, np.minimum(np.abs(cross[row]) / np.where(slanted, across, 1.0), ends), ends)
    found = np.zeros(DIRECTIONS)
    np.maximum.at(found, number % DIRECTIONS, far)
    return found


def count_folds(radii: np.ndarray) -> int:
    """How often radii around a circle rise and fall again by more than `FOLD` of their mean."""
    ring = np.roll(radii, -int(radii.argmin()))
    least, folds, rising = FOLD * float(radii.mean()), 0, True
    low = high = float(ring[0])
    for radius in (*ring.tolist(), low):
        if rising:
            low, high = (min(low, radius), radius) if radius < low else (low, max(high, radius))
            if high - low > least and high - radius > least:
                folds, rising, low = folds + 1, False, radius
        else:
            low = min(low, radius)
            if radius - low > least:
                rising, high = True, radius
    return folds
