"""Curves that are linear in their control points: arcs of fixed bulge, interpolating splines, polylines.

A bulge is tan(angle/4) of an arc, positive where the arc turns counter-clockwise from start to end.
"""

from functools import lru_cache

import numpy as np

from restshape.arrays import Complexes, Integers, Reals

GAUSS = np.array([0.5 - np.sqrt(0.15), 0.5, 0.5 + np.sqrt(0.15)])
GAUSS_WEIGHTS = np.array([5.0, 8.0, 5.0]) / 18.0
STRAIGHT = 1e-9
"""Half the angle of an arc below which it is a line."""


def arc_fraction(bulge: float, s: Reals) -> Complexes:
    """Complex z(s) with p(s) = a + (b - a) z(s) on the arc from a to b.

    Args:
        bulge: tan(angle/4).
        s: (m,) share of the angle, 0 at a and 1 at b.
    """
    half = 2.0 * np.arctan(bulge)
    return s + 0j if abs(half) < STRAIGHT else arc_fractions(half, s)


def arc_fractions(half: Reals | float, s: Reals) -> Complexes:
    """The same (m,) on arcs that turn: half their angles are `half` (m,), of one or of several arcs."""
    return np.exp(1j * half * (s - 1.0)) * (np.sin(half * s) / np.sin(half))


def half_angles(bulges: Reals) -> Reals:
    """Half of the angles of arcs of some bulges."""
    return 2.0 * np.arctan(bulges)


def arc_fraction_rate(bulge: float, s: Reals) -> Complexes:
    """Complex dz/ds of :func:`arc_fraction`."""
    half = 2.0 * np.arctan(bulge)
    if abs(half) < STRAIGHT:
        return np.ones_like(s) + 0j
    return half / np.sin(half) * np.exp(1j * half * (2.0 * s - 1.0))


def arc_centre(a: Reals, b: Reals, bulge: float) -> tuple[Reals, float]:
    """Centre (2,) and radius of the arc from a to b; the bulge must not be 0."""
    along = b - a
    normal = np.array([-along[1], along[0]])
    centre = 0.5 * (a + b) + normal * (1.0 - bulge**2) / (4.0 * bulge)
    return centre, float(np.hypot(*along)) * (1.0 + bulge**2) / (4.0 * abs(bulge))


def segment_areas(bulges: Reals) -> Reals:
    """Signed areas (m,) between arcs of bulges (m,) and their chords, over the squares of the chords' lengths.

    With b = tan(angle / 4) the radius is chord (1 + b^2) / (4 b), and the area radius^2 (angle - sin angle) / 2.
    """
    angle = 4.0 * np.arctan(bulges)
    square = angle**2
    # The first terms of the series where angle and sine would cancel.
    series = angle * square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0 * (1.0 - square / 72.0)))
    lens = np.where(square < 0.04, series, angle - np.sin(angle))
    squares = np.where(bulges == 0.0, 1.0, bulges**2)
    return (1.0 + bulges**2) ** 2 / (32.0 * squares) * lens


def bulge_through(a: Reals, q: Reals, b: Reals) -> float:
    """Bulge of the arc from a to b that passes through q.

    Raises:
        ValueError: q coincides with an end, or lies on the line of a and b but not between them.
    """
    u, v = a - q, b - q
    cross, dot = u[0] * v[1] - u[1] * v[0], u @ v
    if not u.any() or not v.any() or (cross == 0.0 and dot > 0.0):
        raise ValueError("no arc passes through these three points in this order")
    # The angle that the chord subtends at q is pi minus half the angle of the arc.
    return float(np.tan((np.pi - np.arctan2(abs(cross), dot)) / 2.0)) * (1.0 if cross < 0.0 else -1.0)


def chord_parameters(points: Reals) -> tuple[float, ...]:
    """Parameters of points along a curve, by chord length, 0 at the first and 1 at the last."""
    chords = np.hypot(*np.diff(points, axis=0).T)
    total = np.concatenate([[0.0], np.cumsum(chords)])
    return tuple((total / total[-1]).tolist())


@lru_cache(maxsize=512)
def second_derivatives(knots: tuple[float, ...], ends: tuple[str, str]) -> Reals:
    """Matrix (n, n) that gives a cubic spline's second derivatives at its knots from its values there.

    Args:
        knots: rising parameters, at least two.
        ends: "natural" (second derivative 0) or "smooth" (third derivative continuous at the next knot), for each end.
    """
    u = np.array(knots)
    n, h = len(u), np.diff(u)
    if n == 2:
        return np.zeros((2, 2))
    left, right = np.zeros((n, n)), np.zeros((n, n))
    for i in range(1, n - 1):
        left[i, i - 1 : i + 2] = h[i - 1] / 6.0, (h[i - 1] + h[i]) / 3.0, h[i] / 6.0
        right[i, i - 1 : i + 2] = 1.0 / h[i - 1], -1.0 / h[i - 1] - 1.0 / h[i], 1.0 / h[i]
    for row, end in ((0, ends[0]), (n - 1, ends[1])):
        if end == "natural":
            left[row, row] = 1.0
        else:
            k = 1 if row == 0 else n - 2
            left[row, k - 1 : k + 2] = h[k], -h[k - 1] - h[k], h[k - 1]
    matrix = np.linalg.solve(left, right)
    matrix.setflags(write=False)
    return matrix


def _spans(knots: Reals, s: Reals) -> Integers:
    return np.clip(np.searchsorted(knots, s, side="right") - 1, 0, len(knots) - 2)


def spline_weights(knots: tuple[float, ...], ends: tuple[str, str], s: Reals) -> Reals:
    """Weights (m, n) of the n interpolated points at the parameters s (m,)."""
    u, second = np.array(knots), second_derivatives(knots, ends)
    i = _spans(u, s)
    h = u[i + 1] - u[i]
    b = (s - u[i]) / h
    a = 1.0 - b
    weights = ((a**3 - a) * h**2 / 6.0)[:, None] * second[i] + ((b**3 - b) * h**2 / 6.0)[:, None] * second[i + 1]
    rows = np.arange(len(s))
    weights[rows, i] += a
    weights[rows, i + 1] += b
    return weights


def spline_weight_rates(knots: tuple[float, ...], ends: tuple[str, str], s: Reals) -> Reals:
    """Derivatives (m, n) of :func:`spline_weights` with respect to s."""
    u, second = np.array(knots), second_derivatives(knots, ends)
    i = _spans(u, s)
    h = u[i + 1] - u[i]
    b = (s - u[i]) / h
    a = 1.0 - b
    rates = ((3.0 * b**2 - 1.0) * h / 6.0)[:, None] * second[i + 1]
    rates -= ((3.0 * a**2 - 1.0) * h / 6.0)[:, None] * second[i]
    rows = np.arange(len(s))
    rates[rows, i] -= 1.0 / h
    rates[rows, i + 1] += 1.0 / h
    return rates


def spline_extremes(knots: tuple[float, ...], ends: tuple[str, str], points: Reals) -> Reals:
    """Parameters (m,) between 0 and 1 at which a coordinate of a spline through points (n, 2) may be extreme.

    The rate of a coordinate is a quadratic in each span; parameters outside of the span of their root are left out.
    """
    u, second = np.array(knots), second_derivatives(knots, ends) @ points
    h = np.diff(u)[:, None]
    scale = h**2 / 6.0
    low, high = second[:-1], second[1:]
    a, half, c = 3.0 * scale * (high - low), 3.0 * scale * low, np.diff(points, axis=0) - scale * (2.0 * low + high)
    # Roots of a b^2 + 2 half b + c without cancellation.
    q = -(half + np.where(half < 0.0, -1.0, 1.0) * np.sqrt(np.maximum(half**2 - a * c, 0.0)))
    with np.errstate(divide="ignore", invalid="ignore"):
        roots = np.stack([q / a, c / q])
    inside = (roots > 0.0) & (roots < 1.0)
    return (u[:-1, None] + h * np.where(inside, roots, 0.0))[inside]


def arc_extremes(bulge: float, chord: Reals) -> Reals:
    """Parameters (m,) between 0 and 1 at which the tangent of an arc over a chord (2,) points along an axis."""
    half, middle, right = 2.0 * np.arctan(bulge), np.arctan2(chord[1], chord[0]), 0.5 * np.pi
    if abs(half) < STRAIGHT:
        return np.zeros(0)
    first, last = sorted((middle - half, middle + half))
    along = right * np.arange(np.ceil(first / right), np.floor(last / right) + 1.0)
    return np.clip(0.5 * ((along - middle) / half + 1.0), 0.0, 1.0)


def polyline_weights(knots: tuple[float, ...], s: Reals) -> Reals:
    """Weights (m, n) of the n corners at the parameters s (m,)."""
    u = np.array(knots)
    i = _spans(u, s)
    b = (s - u[i]) / (u[i + 1] - u[i])
    weights, rows = np.zeros((len(s), len(u))), np.arange(len(s))
    weights[rows, i] = 1.0 - b
    weights[rows, i + 1] = b
    return weights


def polyline_weight_rates(knots: tuple[float, ...], s: Reals) -> Reals:
    """Derivatives (m, n) of :func:`polyline_weights` with respect to s."""
    u = np.array(knots)
    i = _spans(u, s)
    rates, rows = np.zeros((len(s), len(u))), np.arange(len(s))
    rates[rows, i] = -1.0 / (u[i + 1] - u[i])
    rates[rows, i + 1] = 1.0 / (u[i + 1] - u[i])
    return rates


def gauss_parameters(knots: tuple[float, ...]) -> tuple[Reals, Reals]:
    """Gauss points and weights, three a span: exact for polynomials of degree 5 in each."""
    u = np.array(knots)
    h = np.diff(u)
    return (u[:-1, None] + h[:, None] * GAUSS).ravel(), (h[:, None] * GAUSS_WEIGHTS).ravel()
