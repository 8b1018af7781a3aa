"""How far places on a plate are from its border."""

import numpy as np

from restshape.shape.nearness import distances

HALVINGS = 40
"""Of the part of a segment between a place that is too near and one that is not."""


class BorderDistance:
    """Distances from the outline of a plate and from its holes.

    Args:
        X: (n, 2) nodes [m]; triangles: (m, 3) of them, whose sides that have one triangle alone are the border.
    """

    def __init__(self, X: np.ndarray, triangles: np.ndarray) -> None:
        sides = np.sort(np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
        found, times = np.unique(sides, axis=0, return_counts=True)
        self._starts, self._ends = np.moveaxis(X[found[times == 1]], 1, 0)

    def __call__(self, places: np.ndarray) -> np.ndarray:
        """Distances (m,) [m] of places (m, 2)."""
        return distances(places, self._starts, self._ends)

    def kept(self, at: np.ndarray, shares: np.ndarray, margin: float) -> np.ndarray:
        """Shares (m,) of segments with ends `at` (m, 2, 2), moved along them until they keep a distance [m].

        A place that is too near goes towards the end that is farther from the border; NaN where that is too near, too.
        """
        shares = shares.copy()
        near = np.flatnonzero(self(_along(at, shares)) < margin)
        if not len(near):
            return shares
        start, end = (self(at[near, k]) for k in (0, 1))
        far = np.where(end > start, 1.0, 0.0)
        shares[near] = np.where(np.maximum(start, end) >= margin, shares[near], np.nan)
        fits = np.isfinite(shares[near])
        moved, far, close = near[fits], far[fits], shares[near[fits]]
        for _ in range(HALVINGS if len(moved) else 0):
            middle = 0.5 * (far + close)
            keeps = self(_along(at[moved], middle)) >= margin
            far, close = np.where(keeps, middle, far), np.where(keeps, close, middle)
        shares[moved] = far
        return shares


def _along(at: np.ndarray, shares: np.ndarray) -> np.ndarray:
    return at[:, 0] + shares[:, None] * (at[:, 1] - at[:, 0])
