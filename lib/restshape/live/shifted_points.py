"""Points that travel once, and then the vector alone by which all of them have moved as they lie."""

from __future__ import annotations

import numpy as np

from restshape.arrays import AnyArray, Reals
from restshape.live.frame_arrays import same_bytes, sent_points

SPACE = 3
"""Coordinates of the vector."""
SAME = 1e-12
"""Largest part of a move that is not that of all, over the largest coordinate: far below the rounding of 32 bits."""


class ShiftedPoints:
    """The last points that were sent as such, and how far those of a frame have gone from there."""

    def __init__(self) -> None:
        self._from: Reals | None = None
        self._sent: AnyArray = np.empty((0, 0), dtype="<f4")

    def __call__(self, points: Reals, sent: AnyArray | None = None) -> tuple[AnyArray, list[float] | None]:
        """What travels of the points of a frame.

        Args:
            points: (n, d) [m]; sent: the same as they travel; None: made here.

        Returns:
            An array, the same object as before where the points have moved as they lie, and the vector [m] in space
            that is to be added to each of its points; None: nothing is.
        """
        found = sent_points(points) if sent is None else sent
        before = self._from
        if before is not None and found.shape == self._sent.shape and len(found):
            if same_bytes(found, self._sent):
                return self._sent, None
            way = _way(before, points)
            if way is not None:
                return self._sent, [*way.tolist(), *[0.0] * (SPACE - len(way))]
        self.begin(points.copy(), found)
        return found, None

    def begin(self, points: Reals, sent: AnyArray) -> None:
        """Points of a frame travel as such, whatever those before were.

        Args:
            points: (n, d) [m], which nobody changes any more; sent: the same as they travel.
        """
        self._from, self._sent = points, sent


def shifted(points: AnyArray, shift: object) -> AnyArray:
    """Points (n, d) as they travel, moved by the vector of three numbers that travels with them, if any does."""
    if not shift:
        return points
    found: AnyArray = np.add(points, np.asarray(shift, dtype=points.dtype)[: points.shape[1]])
    return found


def _way(before: Reals, now: Reals) -> Reals | None:
    """The vector (d,) [m] by which all points (n, d) have moved; None where they have not moved as they lie."""
    with np.errstate(invalid="ignore"):
        way: Reals = now[0] - before[0]
        for some in (slice(-1, None), slice(None)):  # most frames of what deforms are told by one point
            aside = np.abs(now[some] - before[some] - way).max()
            # Comparisons with numbers that are none do not hold.
            if not aside <= SAME * max(np.abs(now[some]).max(), np.abs(before[some]).max()):
                return None
    return way
