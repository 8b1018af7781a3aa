"""Spline edges as B-splines and Bézier curves, and cubic B-splines as spline edges; exact both ways."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import islice, pairwise
from typing import TYPE_CHECKING

import numpy as np

from restshape.arrays import Reals
from restshape.bounds import SPLINE_POINTS
from restshape.shape.curves import second_derivatives

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

Ends = tuple[str, str]
SplineEdge = tuple[Reals, tuple[float, ...], Ends]
"""The points (n, 2) of a spline edge, its knots (n,) from 0 to 1, and its end conditions."""
NEGLIGIBLE = 1e-11
"""A derivative smaller than this share of the largest one is 0: the curve moves by no more than that share."""
SAME_KNOT = 1e-9
"""Share of the range of a parameter by which knots differ that are not the same."""
JOINED = 1e-9
"""Share of the handles by which slope and bend of two Bézier curves of one spline may differ where they join."""


def cubic_of(points: Reals, knots: tuple[float, ...], ends: Ends) -> BSpline:
    """The B-spline that is a spline edge: degree 3, knots of multiplicity 4 at 0 and 1, simple ones between them.

    Args:
        points: (n, 2) that the edge interpolates; knots: (n,) its parameters there, from 0 to 1.
        ends: end conditions, see `restshape.shape.curves.second_derivatives`.
    """
    from scipy.interpolate import make_interp_spline  # late: few shapes have splines

    second = second_derivatives(knots, ends) @ points
    curvature = [(2, second[0])], [(2, second[-1])]
    return make_interp_spline(np.array(knots), points, 3, bc_type=curvature)


def beziers_of(points: Reals, knots: tuple[float, ...], ends: Ends) -> Reals:
    """The control points (n - 1, 4, 2) of the cubic Bézier curves between the points of a spline edge.

    Args as of `cubic_of`.
    """
    curve, steps = cubic_of(points, knots, ends), np.diff(knots)[:, None] / 3.0
    slopes = curve(np.array(knots), 1)
    return np.stack([points[:-1], points[:-1] + steps * slopes[:-1], points[1:] - steps * slopes[1:], points[1:]], 1)


def edges_of_cubic(knots: Reals, controls: Reals) -> list[SplineEdge]:
    """The spline edges that are a cubic B-spline: one, or two of a closed curve, for an edge has two ends.

    At an end whose second derivative is not 0 the edge gets a point in its last span, which makes the end "smooth" the
    same polynomial.

    Args:
        knots: (n + 4,) not decreasing; controls: (n, 2) control points.

    Returns:
        The edges; none where an inner knot is not simple, the ends are not at the first and last control point, or
        there would be more than `bounds.SPLINE_POINTS`.
    """
    from scipy.interpolate import BSpline

    if len(controls) < 4 or len(knots) != len(controls) + 4 or not np.ptp(knots) > 0.0:
        return []
    knots = (knots - knots[0]) / np.ptp(knots)
    own = np.concatenate([[0.0], knots[4:-4], [1.0]])
    clamped = not knots[:4].any() and bool((knots[-4:] == 1.0).all())
    if not clamped or np.diff(own).min() <= 0.0 or len(own) + 4 > SPLINE_POINTS:
        return []
    return _edges(BSpline(knots, controls, 3), own)


def cubic_between(curve: Callable[[Reals], Reals], low: float, high: float, knots: Sequence[float]) -> list[SplineEdge]:
    """The spline edges that are a curve which may be a cubic between knots: one, or two of a closed curve.

    Args:
        curve: gives points (n, 2) of parameters (n,).
        low, high: parameters of its ends.
        knots: rising, where its third derivative may jump.

    Returns:
        The edges; none where they would be off the curve, or have more points than `bounds.SPLINE_POINTS`.
    """
    known = np.array(knots)
    near = SAME_KNOT * (high - low)
    own = np.array([low, *known[(known > low + near) & (known < high - near)], high])
    if len(own) + 4 > SPLINE_POINTS:
        return []
    steps = np.diff(own) / 3.0
    places = np.union1d(own, [low + steps[0], high - steps[-1]])
    whole = cubic_of(curve(places), tuple((places - low) / (high - low)), ("smooth", "smooth"))
    probes = (own[:-1, None] + steps[:, None] * np.array([0.5, 1.5, 2.5])).ravel()
    off = np.abs(whole((probes - low) / (high - low)) - curve(probes)).max()
    if not off <= NEGLIGIBLE * np.ptp(whole.c, axis=0).max():
        return []
    return _edges(whole, (own - low) / (high - low))


def _edges(curve: BSpline, own: Reals) -> list[SplineEdge]:
    """The spline edges that a cubic from 0 to 1 with these knots is: one, or two of a closed curve."""
    begin, end = curve.c[0], curve.c[-1]
    if np.hypot(*(begin - end)) > 1e-9 * np.ptp(curve.c):
        return [_part(curve, own)]
    middle = 0.5 if len(own) == 2 else float(own[len(own) // 2])
    return [
        _part(curve, np.unique([*own[own < middle], middle])),
        _part(curve, np.unique([middle, *own[own > middle]])),
    ]


def spline_of_beziers(pieces: Sequence[Reals], begin: int = 0) -> tuple[Reals, Reals, int]:
    """The cubic B-spline that some joined Bézier curves are, of as many as it can be.

    At a joint of a spline slope and second derivative go on, for steps of its parameter as the handles are long.

    Args:
        pieces: (4, 2) control points each.
        begin: the first of them; there is one.

    Returns:
        Knots (n + 4,) and control points (n, 2), and how many of the pieces it is.
    """
    steps = [1.0]
    for one, other in pairwise(islice(pieces, begin, None)):
        step = _next_step(one, other, steps[-1])
        if step is None:
            break
        steps.append(step)
    own = np.concatenate([[0.0], np.cumsum(steps)])
    knots = np.concatenate([[0.0] * 3, own, [own[-1]] * 3])
    # The blossom of the polynomial of a piece at three knots that follow each other is the control point there.
    controls = [*pieces[begin][:2]]
    for piece, step, following in zip(islice(pieces, begin, None), steps, steps[1:]):
        # The blossom is affine in each knot: on from that at the begin and the end of this piece to the next end.
        controls.append(piece[2] + (piece[2] - piece[1]) * following / step)
    return knots, np.array([*controls, *pieces[begin + len(steps) - 1][2:]]), len(steps)


def _next_step(one: Reals, other: Reals, step: float) -> float | None:
    """The step of a Bézier curve that goes on from another of this step as one spline does; None where it does not."""
    before, after = one[3] - one[2], other[1] - other[0]
    lengths = float(np.hypot(*before)), float(np.hypot(*after))
    if min(lengths) == 0.0 or np.any(one[3] != other[0]):
        return None
    found = step * lengths[1] / lengths[0]
    kink = float(np.hypot(*(after / lengths[1] - before / lengths[0])))
    bends = (one[3] - 2.0 * one[2] + one[1]) / step**2, (other[2] - 2.0 * other[1] + other[0]) / found**2
    # What rounding may do to a bend is a share of the handles that it is made of.
    jump = float(np.hypot(*(bends[1] - bends[0]))) * min(step, found) ** 2
    return found if kink < JOINED and jump < JOINED * max(lengths) else None


def _part(curve: BSpline, knots: Reals) -> SplineEdge:
    """The spline edge that is a cubic between the first and the last of some knots, among them all of its own there."""
    bend = np.abs(curve(knots, 2)).max(axis=1)
    ends = tuple("natural" if bend[at] <= NEGLIGIBLE * bend.max() else "smooth" for at in (0, -1))
    assert len(ends) == 2
    knots = _own_knots(curve, knots)
    more: list[float] = []
    if ends[0] == "smooth":
        more.append(knots[0] + (knots[1] - knots[0]) / 3.0)
    if ends[1] == "smooth":
        more.append(knots[-1] - (knots[-1] - knots[-2]) / 3.0)
    if len(knots) == 2 and not more:
        # An edge without a point between its ends would be a line, as this one is.
        more.append(0.5 * float(knots[0] + knots[1]))
    places = np.union1d(knots, more)
    own = (places - places[0]) / (places[-1] - places[0])
    return curve(places), tuple(own.tolist()), (ends[0], ends[1])


def _own_knots(curve: BSpline, knots: Reals) -> Reals:
    """Those of the knots at which the curve is not the same polynomial on both sides, and both ends.

    Without this each export and import of a spline edge would add a point at each of its ends.
    """
    jumps = np.abs(np.diff(curve(0.5 * (knots[1:] + knots[:-1]), 3), axis=0)).max(axis=1)
    # A jump moves the curve by about its product with the spans beside it, of which the shorter one counts twice.
    short, long = np.sort(np.stack([np.diff(knots)[1:], np.diff(knots)[:-1]]), axis=0)
    room = NEGLIGIBLE * np.ptp(curve.c, axis=0).max() / (short**2 * long)
    return np.concatenate([knots[:1], knots[1:-1][jumps > room], knots[-1:]])
