"""In which of several outlines a loop or a point lies, and how far a point is from all of them."""

from __future__ import annotations

import numpy as np

from restshape.arrays import Reals
from restshape.shape.outline import Loop, Outline


class PieceFinder:
    """Finds the piece of an outline that something lies in, or is nearest to where none is around it.

    Args:
        outline: whose loops may be turned either way.
    """

    def __init__(self, outline: Outline) -> None:
        self._outline, loops = outline, outline.loops
        self._around = [i for i, loop in enumerate(loops) if loop.kind == "outline"]
        several = len(self._around) > 1
        self._polygons = [self._polygon(i) for i in self._around] if several else []

    def of_loop(self, loop: int) -> int:
        """Number of the outline that a loop is, or that it lies in or shares an edge with."""
        found, loops = self._outline.loops[loop], self._outline.loops
        if loop in self._around:
            return self._around.index(loop)
        own = {e for e, _ in found.edges}
        for k, i in enumerate(self._around):
            if len(self._around) > 1 and own & {e for e, _ in loops[i].edges}:
                return k
        first = found.edges[0][0]
        return self.of_point(self._outline.point(first, 0.5)[0])

    def of_point(self, place: Reals) -> int:
        """Number of the outline that a place (2,) [m] lies in, or is nearest to."""
        if not self._polygons:
            return 0
        inside = next((k for k, polygon in enumerate(self._polygons) if _inside(polygon, place)), None)
        if inside is not None:
            return inside
        return int(np.argmin([_distance(polygon, place) for polygon in self._polygons]))

    def _polygon(self, loop: int) -> Reals:
        return _polygon(self._outline, self._outline.loops[loop])


def distance_outside(outline: Outline, place: Reals) -> float:
    """How far a place (2,) [m] is from the pieces of an outline; 0 inside of one and in no hole of it [m]."""
    polygons = [_polygon(outline, loop) for loop in outline.loops if loop.kind in ("outline", "hole")]
    if sum(_inside(polygon, place) for polygon in polygons) % 2:
        return 0.0
    return min(_distance(polygon, place) for polygon in polygons)


def _polygon(outline: Outline, loop: Loop) -> Reals:
    """Corners (k, 2) of a loop's straight pieces, in its direction [m]."""
    parts = []
    for edge, forward in loop.edges:
        chain = outline.polyline(edge)
        parts.append((chain if forward else chain[::-1])[:-1])
    return np.concatenate(parts)


def _distance(polygon: Reals, place: Reals) -> float:
    """The distance of a place (2,) from the sides of a polygon (k, 2) [m]."""
    side, way = np.roll(polygon, -1, axis=0) - polygon, place - polygon
    square = np.maximum((side**2).sum(axis=1), np.finfo(float).tiny)
    share = np.clip((way * side).sum(axis=1) / square, 0.0, 1.0)
    return float(np.hypot(*(way - share[:, None] * side).T).min())


def _inside(polygon: Reals, place: Reals) -> bool:
    """Whether a place (2,) lies inside a polygon (k, 2), by the parity of crossings."""
    a, b, (x, y) = polygon, np.roll(polygon, -1, axis=0), place
    crosses = (a[:, 1] > y) != (b[:, 1] > y)
    rise = np.where(b[:, 1] == a[:, 1], 1.0, b[:, 1] - a[:, 1])
    at = a[:, 0] + (y - a[:, 1]) / rise * (b[:, 0] - a[:, 0])
    return bool(np.count_nonzero(crosses & (x < at)) % 2)
