"""Smooth pieces of a border, moved away from the material: lines, arcs and splines at a distance from themselves."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.optimize import root

from restshape.arrays import Reals
from restshape.errors import UserError
from restshape.shape.curves import second_derivatives
from restshape.shape.drawings.fitted_spline import SMOOTH, fitted_spline
from restshape.shape.drawings.loose_curve import Curve
from restshape.shape.outline import Loop, Outline

STRAIGHT = 1e-7
"""Angle [rad] up to which two pieces go on smoothly."""
PROBES = 64
"""Places of a spline, between two knots, whose curvature is looked at."""
MEET = 1e-12
"""Share of the size of the shape within which two curves meet."""


@dataclass(frozen=True)
class MovedOut:
    """A piece of a border in the direction of its loop, material on its left, and moved to its right.

    Args:
        name: of its edge; kind: "line", "arc" or "spline".
        place, rate: points (n, 2) [m] of the piece itself by parameters (n,) from 0 to 1, and their derivatives.
        distance: by which it is moved [m].
        turn: angle of an arc [rad], positive to the left.
        low, high: parameters of the part that is left of it.
    """

    name: str
    kind: str
    place: Callable[[Reals], Reals]
    rate: Callable[[Reals], Reals]
    distance: float
    turn: float = 0.0
    low: float = 0.0
    high: float = 1.0

    def at(self, s: Reals | float) -> Reals:
        """Points (n, 2) [m] of the moved piece."""
        s = np.atleast_1d(np.asarray(s, dtype=float))
        return self.place(s) + self.distance * self.normal(s)

    def normal(self, s: Reals | float) -> Reals:
        """Unit vectors (n, 2) away from the material."""
        rate = self.rate(np.atleast_1d(np.asarray(s, dtype=float)))
        return np.column_stack([rate[:, 1], -rate[:, 0]]) / np.hypot(*rate.T)[:, None]

    def curve(self, start: Reals, end: Reals) -> Curve:
        """What is left of it between two points (2,), as a loose curve.

        Raises:
            UserError: it bends too much for a spline.
        """
        source = f"the edge {self.name}"
        ends = np.array([start, end])
        if self.kind == "line":
            return Curve(ends, "line", source=source)
        if self.kind == "arc":
            bulge = float(np.tan(0.25 * self.turn * (self.high - self.low)))
            return Curve(ends, "arc", bulge=bulge, source=source)
        points, knots = fitted_spline(self.at, self.low, self.high, source)
        return Curve(np.array([start, *points[1:-1], end]), "spline", source=source, knots=knots, ends=SMOOTH)


def moved_out(outline: Outline, loop: Loop, distance: float) -> list[MovedOut]:
    """The smooth pieces of a loop, each moved away from the material by a distance [m].

    Raises:
        UserError: one is bent inwards with a radius that is not above the distance.
    """
    return [piece for edge, forward in loop.edges for piece in _pieces(outline, edge, forward, distance)]


def _pieces(outline: Outline, index: int, forward: bool, distance: float) -> Iterator[MovedOut]:
    """The smooth pieces of one edge."""
    edge, sign = outline.edges[index], 1.0 if forward else -1.0

    def place(s: Reals) -> Reals:
        return outline.point(index, s if forward else 1.0 - s)

    def rate(s: Reals) -> Reals:
        return sign * outline.tangent(index, s if forward else 1.0 - s)

    if edge.kind == "polyline":
        corners = outline.points[outline.layout.controls[index]]
        for a, b in pairwise(corners if forward else corners[::-1]):
            yield _line(edge.name, a, b, distance)
        return
    turn = sign * 4.0 * float(np.arctan(outline.bulges[index]))
    if edge.kind != "spline" and abs(turn) <= STRAIGHT:
        a, b = place(np.array([0.0, 1.0]))
        yield _line(edge.name, a, b, distance)
        return
    if edge.kind == "spline":
        _refuse_bent(outline, index, forward, distance)
    else:
        _refuse_small(outline, index, turn, distance)
    yield MovedOut(edge.name, edge.kind, place, rate, distance, turn)


def _line(name: str, a: Reals, b: Reals, distance: float) -> MovedOut:
    return MovedOut(name, "line", lambda s: a + s[:, None] * (b - a), lambda s: np.tile(b - a, (len(s), 1)), distance)


def _refuse_small(outline: Outline, index: int, turn: float, distance: float) -> None:
    """Refuses an arc around what is cut away that the cut would fill."""
    radius = outline.length(index) / abs(turn)
    if turn < 0.0 and radius <= distance:
        what = f"the arc {outline.edges[index].name} has a radius of {1e3 * radius:g} mm, within the cut"
        raise UserError(what, "--kerf", f"give less than {2e3 * radius:g} mm, or a larger arc")


def _refuse_bent(outline: Outline, index: int, forward: bool, distance: float) -> None:
    """Refuses a spline that bends around what is cut away more than the cut can follow."""
    edge = outline.edges[index]
    controls = outline.points[outline.layout.controls[index]]
    s = np.unique(np.concatenate([np.linspace(a, b, PROBES) for a, b in pairwise(edge.knots)]))
    seconds = second_derivatives(edge.knots, edge.ends) @ controls
    bend = np.column_stack([np.interp(s, edge.knots, seconds[:, k]) for k in range(2)])
    rate = outline.tangent(index, s)
    left = (rate[:, 0] * bend[:, 1] - rate[:, 1] * bend[:, 0]) / np.hypot(*rate.T) ** 3 * (1.0 if forward else -1.0)
    worst = int(left.argmin())
    if 1.0 + distance * left[worst] <= 0.0:
        x, y = 1e3 * outline.point(index, s[worst])[0]
        what = (
            f"the edge {edge.name} bends inwards with a radius of {-1e3 / left[worst]:.3g} mm at ({x:.4g}, {y:.4g}) mm"
        )
        raise UserError(f"{what}, within the cut", "--kerf", "give less, or smooth the edge")


def turn_between(before: MovedOut, after: MovedOut) -> float:
    """The angle [rad] by which a border turns from one piece to the next: positive to the left, around material."""
    (ax, ay), (bx, by) = before.rate(np.ones(1))[0], after.rate(np.zeros(1))[0]
    return float(np.arctan2(ax * by - ay * bx, ax * bx + ay * by))


def crossing(before: MovedOut, after: MovedOut, size: float) -> tuple[float, float, Reals]:
    """Where two moved pieces cross whose border turns to the right between them.

    Args:
        before, after: in the direction of the loop; size: of the shape [m].

    Returns:
        The parameters of both, and the point (2,) [m].

    Raises:
        UserError: they do not cross, for one of them is too short.
    """

    def gap(at: Reals) -> Reals:
        return (before.at(at[0])[0] - after.at(at[1])[0]) / size

    found = root(gap, np.array([1.0, 0.0]), tol=1e-15)
    s, u = found.x
    if np.hypot(*gap(found.x)) > MEET or not (before.low < s <= 1.0 and 0.0 <= u < after.high):
        x, y = 1e3 * before.place(np.ones(1))[0]
        what = f"at ({x:.4g}, {y:.4g}) mm, between {before.name} and {after.name}, the cut is wider than the corner"
        raise UserError(what, "--kerf", "give less, or lengthen these edges")
    return float(s), float(u), before.at(s)[0]
