"""Segments of SVG paths as loose curves in metres, y up."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import groupby, pairwise
from typing import Any

import numpy as np

from restshape.arrays import Reals
from restshape.errors import UserError
from restshape.shape.drawings.bsplines import edges_of_cubic, spline_of_beziers
from restshape.shape.drawings.fitted_spline import SMOOTH, fitted_spline
from restshape.shape.drawings.loose_curve import Curve

ROUND = 1e-9
"""Share by which the half axes of an arc may differ that is one of a circle."""
HALF = 4e-15
"""Share of its coordinates by which the radius of an arc may differ from half its chord that is half a circle: the root
of a difference that is rounding gives where its centre is."""
STRAIGHT = 1e-9
"""Share of its length by which the handles of a Bézier curve may be off its chord that is a line."""
CIRCULAR = 1e-3
"""Share by which handles and their directions may be off those by which programs draw a circle: of the radius for a
quarter of it, less for shorter arcs, as their handles are shorter."""
QUARTER = 0.5 * np.pi
KNOTS = np.array([0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0])


@dataclass(frozen=True)
class Placing:
    """Where the points of a shape lie.

    Args:
        linear: (2, 2) metres, y up, by its own units, y down; shift: (2,) [m].
        source: the shape, for messages.
    """

    linear: Reals
    shift: Reals
    source: str

    @classmethod
    def of(cls, matrix: Any, scale: tuple[float, float], source: str) -> Placing:
        """By a matrix of svgelements, into user units, and the metres in a user unit along x and y."""
        metres = np.array([[scale[0]], [-scale[1]]])
        linear = np.array([[matrix.a, matrix.c], [matrix.b, matrix.d]], dtype=float)
        with np.errstate(all="ignore"):
            return cls(metres * linear, metres[:, 0] * (float(matrix.e), float(matrix.f)), source)

    def __call__(self, points: Iterable[Any]) -> Reals:
        """Points (n, 2) [m] of points of svgelements.

        Raises:
            UserError: one is not finite.
        """
        with np.errstate(all="ignore"):
            found: Reals = np.array([(float(p.x), float(p.y)) for p in points]) @ self.linear.T + self.shift
        if not np.isfinite(found).all():
            what = f"{self.source} has a coordinate that is no finite number"
            raise UserError(what, "", "write numbers that are finite, also in its transforms")
        return found


def curves_of_segment(segment: Any, placed: Placing, source: str) -> list[Curve]:
    """The edges of a segment of svgelements, without names; none of one that draws nothing.

    Args:
        segment: Move, Line, Close, QuadraticBezier, CubicBezier or Arc, in units of its shape.
        placed: where it lies.
        source: what it belongs to, for messages.

    Raises:
        UserError: an arc of an ellipse bends too much.
    """
    kind = type(segment).__name__
    if kind in ("Line", "Close"):
        if segment.start is None or segment.end is None or segment.start == segment.end:
            return []
        return [Curve(placed([segment.start, segment.end]), "line")]
    if kind == "CubicBezier":
        return cubic(placed([segment.start, segment.control1, segment.control2, segment.end]))
    if kind == "QuadraticBezier":
        a, q, b = placed([segment.start, segment.control, segment.end])
        return cubic(np.array([a, (a + 2.0 * q) / 3.0, (b + 2.0 * q) / 3.0, b]))
    return _arc(segment, placed, source) if kind == "Arc" else []


def curves_of_path(segments: Iterable[Any], placed: Placing, source: str) -> list[Curve]:
    """The edges of a path: each segment by itself, but that cubic ones which together are one spline are one edge.

    Arguments and errors as of `curves_of_segment`.
    """
    found: list[Curve] = []
    for cubics, run in groupby(segments, lambda one: type(one).__name__ == "CubicBezier"):
        if cubics:
            found += _of_cubics([placed([one.start, one.control1, one.control2, one.end]) for one in run])
        else:
            found += [curve for one in run for curve in curves_of_segment(one, placed, source)]
    return found


def _of_cubics(pieces: list[Reals]) -> list[Curve]:
    """The edges of cubic Bézier curves (4, 2) [m] that join: a spline for those that are one, else each by itself."""
    found: list[Curve] = []
    begin = 0
    while begin < len(pieces):
        knots, controls, count = spline_of_beziers(pieces, begin)
        single = [curve for piece in pieces[begin : begin + count] for curve in cubic(piece)]
        begin += count
        straight = all(curve.kind == "line" for curve in single)
        edges = [] if count == 1 or straight else edges_of_cubic(knots, controls)
        found += [Curve(points, "spline", knots=own, ends=ends) for points, own, ends in edges] or single
    return found


def cubic(controls: Reals) -> list[Curve]:
    """The edges that a cubic Bézier curve is: a line, an arc where it was drawn for one, else a spline, exact.

    Args:
        controls: (4, 2) its control points [m].
    """
    a, b = controls[0], controls[3]
    chord = b - a
    length = float(np.hypot(*chord))
    if length == 0.0 and not np.ptp(controls):
        return []
    if length > 0.0:
        along, across = chord / length, np.array([-chord[1], chord[0]]) / length
        off = np.abs((controls[1:3] - a) @ across).max()
        shares = (controls[1:3] - a) @ along / length
        if off <= STRAIGHT * length and 0.0 <= shares[0] <= shares[1] <= 1.0:
            return [Curve(controls[[0, 3]], "line")]
        bulge = _bulge(controls)
        if bulge:
            return [Curve(controls[[0, 3]], "arc", bulge=bulge)]
    return [Curve(points, "spline", knots=knots, ends=ends) for points, knots, ends in edges_of_cubic(KNOTS, controls)]


def _bulge(controls: Reals) -> float:
    """The bulge of the arc that a cubic Bézier curve was drawn for; 0 for others.

    An arc of angle t and radius r has handles along its tangents of 4/3 tan(t/4) r, of at most a quarter turn.
    """
    a, p, q, b = controls
    first, last, chord = p - a, b - q, b - a
    half = np.arctan2(first[0] * chord[1] - first[1] * chord[0], first @ chord)
    other = np.arctan2(chord[0] * last[1] - chord[1] * last[0], chord @ last)
    part = abs(half) / (0.5 * QUARTER)
    if not (abs(half - other) < CIRCULAR * part and 0.0 < part < 1.0 + CIRCULAR):
        return 0.0
    radius = float(np.hypot(*chord)) / (2.0 * np.sin(abs(half)))
    wanted = 4.0 / 3.0 * np.tan(0.5 * abs(half)) * radius
    off = max(abs(float(np.hypot(*handle)) - wanted) for handle in (first, last))
    return float(np.tan(0.5 * half)) if off < CIRCULAR * part * radius else 0.0


def _arc(segment: Any, placed: Placing, source: str) -> list[Curve]:
    """The edges of an arc of a circle or an ellipse."""
    center, major, minor = placed([segment.center, segment.prx, segment.pry])
    major, minor = major - center, minor - center
    low, sweep = float(segment.get_start_t()), float(segment.sweep)
    ends = placed([segment.start, segment.end])
    whole = bool(np.hypot(*(ends[0] - ends[1])) <= 1e-9 * np.hypot(*major))
    if not sweep or not (np.any(major) and np.any(minor)):
        return [] if whole else [Curve(ends, "line")]

    def points(t: Reals) -> Reals:
        return center + np.cos(t)[:, None] * major + np.sin(t)[:, None] * minor

    lengths = np.hypot(*major), np.hypot(*minor)
    is_round = abs(lengths[0] - lengths[1]) <= ROUND * max(lengths) and abs(major @ minor) <= ROUND * max(lengths) ** 2
    count = 1 if is_round and not whole else max(int(np.ceil(abs(sweep) / QUARTER - 1e-9)), 2 if whole else 1)
    cuts = np.linspace(low, low + sweep, count + 1)
    corners = points(cuts)
    corners[[0, -1]] = ends
    if is_round:
        half = 0.5 * float(np.hypot(*(ends[1] - ends[0])))
        if not whole and abs(lengths[0] - half) <= HALF * float(np.abs(ends).max() + half):
            sweep = float(np.copysign(np.pi, sweep))
        turn = float(np.sign(major[0] * minor[1] - major[1] * minor[0])) * sweep / count
        return [Curve(np.array(pair), "arc", bulge=float(np.tan(turn / 4.0))) for pair in pairwise(corners)]
    found = []
    for (a, b), pair in zip(pairwise(cuts), pairwise(corners)):
        own, knots = fitted_spline(points, float(a), float(b), source)
        found.append(Curve(np.array([pair[0], *own[1:-1], pair[1]]), "spline", knots=knots, ends=SMOOTH))
    return found
