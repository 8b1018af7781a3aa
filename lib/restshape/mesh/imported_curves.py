"""Edges of an outline from the boundary nodes of a mesh from elsewhere: lines, arcs, splines, or straight sides."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np

from restshape.shape.curves import arc_centre, arc_fraction
from restshape.shape.draft import DraftEdge

FEWEST, LEAST_TURN = 4, np.radians(45.0)
"""Nodes of a run that may be an arc, and the angle that it turns by; a run of MANY nodes may turn by less."""
MANY = 8
OFF_CIRCLE = 0.02
"""How far nodes may be from the circle, over how far its arc is from the chords between them."""
ROUNDING = 1e-6
"""How far they may be besides, over the size of the run: what files leave of their digits."""

STRAIGHT = 1e-5
"""A chain whose nodes are no farther from the line between its ends, relative to its length, is a line."""
BENT = 1e-4
"""A side whose middle is farther from the line between its ends, relative to its length, is curved."""

Middles = dict[tuple[int, int], np.ndarray]
"""Places (2,) [m] of the middles of curved sides, by their ends, the smaller first."""


class BoundaryChain:
    """A chain of boundary nodes, with the nodes in the middle of its sides where the file has curved ones.

    Args:
        corners: (n, 2) places [m]; middles: for each side its middle (2,), None where the side is straight.
    """

    def __init__(self, corners: np.ndarray, middles: Sequence[np.ndarray | None]) -> None:
        self.corners, self.middles = corners, middles

    @property
    def curved(self) -> bool:
        """Whether the file has a curved side."""
        return any(middle is not None for middle in self.middles)

    def points(self, i: int, j: int) -> np.ndarray:
        """All points (m, 2) [m] from the i-th to the j-th corner."""
        rows = [self.corners[i]]
        for k in range(i, j):
            middle = self.middles[k]
            rows += [self.corners[k + 1]] if middle is None else [middle, self.corners[k + 1]]
        return np.array(rows)

    def knots(self) -> np.ndarray:
        """Parameters (m,) of all points: corners by the length of the chords, a middle halfway between its ends."""
        steps = np.hypot(*np.diff(self.corners, axis=0).T)
        at = np.concatenate([[0.0], np.cumsum(steps)]) / steps.sum()
        at[-1] = 1.0
        found = [at[0]]
        for k, middle in enumerate(self.middles):
            found += [at[k + 1]] if middle is None else [0.5 * (at[k] + at[k + 1]), at[k + 1]]
        return np.array(found)

    def rows_of_corners(self) -> np.ndarray:
        """Rows of the corners among all points of the chain."""
        return np.concatenate([[0], np.cumsum([1 if middle is None else 2 for middle in self.middles])])

    def arc(self, i: int, j: int) -> float:
        """The angle [rad] of the arc that the run from the i-th to the j-th corner is, positive to the left; or 0."""
        points = self.points(i, j)
        if len(points) < FEWEST:
            return 0.0
        circle = _circle(points[0], points[len(points) // 2], points[-1])
        if circle is None:
            return 0.0
        centre, radius = circle
        chord = float(np.hypot(*np.diff(self.corners[i : j + 1], axis=0).T).max())
        size = float(np.ptp(points, axis=0).max())
        sagitta = min(chord, 2.0 * radius) ** 2 / (8.0 * radius)
        if sagitta < 5.0 * ROUNDING * size:
            return 0.0
        away = points - centre
        if np.abs(np.hypot(*away.T) - radius).max() > OFF_CIRCLE * sagitta + ROUNDING * size:
            return 0.0
        turns = _turns(away)
        one_way = (turns > 0.0).all() or (turns < 0.0).all()
        return float(turns.sum()) if one_way and abs(turns.sum()) < 1.99 * np.pi else 0.0

    def is_arc(self, i: int, j: int) -> bool:
        """Whether a run lies on a circle, on as many nodes and round as far as makes it no accident."""
        turn, count = abs(self.arc(i, j)), len(self.points(i, j))
        return (turn >= LEAST_TURN and count >= FEWEST) or (turn > 0.0 and count >= MANY)

    def stops(self) -> list[int]:
        """Corners at which the chain is cut so that each arc is a piece by itself: first and last at least."""
        last = len(self.corners) - 1
        found, i, straight = [0], 0, 0
        while i < last:
            j = self._farthest(i)
            if not j:
                i += 1
                continue
            if i > straight:
                found.append(i)
            found.append(j)
            i = straight = j
        return found if found[-1] == last else [*found, last]

    def _farthest(self, i: int) -> int:
        """The last corner of the arc that begins at the i-th corner; 0 where none does."""
        last, least = len(self.corners) - 1, i + 1
        while least <= last and len(self.points(i, least)) < FEWEST:
            least += 1
        if least > last or not self.arc(i, least):
            return 0
        low, step = least, 1
        while low + step <= last and self.arc(i, low + step):
            low, step = low + step, 2 * step
        high = min(low + step, last + 1)
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (middle, high) if self.arc(i, middle) else (low, middle)
        return low if self.is_arc(i, low) else 0


def on_one_circle(X: np.ndarray, run: Sequence[int], curved: Middles) -> bool:
    """Whether the nodes of a run, a ring if its last is its first, and the middles between them are on one circle.

    They are MANY at least, and go around its centre in one sense, once at most.
    """
    points = _chain_of(X, np.array(run), curved).points(0, len(run) - 1)
    count = len(points) - (run[0] == run[-1])
    circle = _circle(points[0], points[count // 3], points[2 * count // 3])
    if count < MANY or circle is None:
        return False
    centre, radius = circle
    away = points - centre
    turns = _turns(away)
    sagitta = radius * (1.0 - np.cos(0.5 * np.abs(turns).max()))
    one_way = (turns > 0.0).all() or (turns < 0.0).all()
    size = float(np.ptp(points, axis=0).max())
    near = np.abs(np.hypot(*away.T) - radius).max() <= OFF_CIRCLE * sagitta + ROUNDING * size
    return bool(one_way and near and abs(turns.sum()) < 2.01 * np.pi)


def _circle(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> tuple[np.ndarray, float] | None:
    """Centre (2,) and radius of the circle through three points; None where they are in a line."""
    u, v = b - a, c - a
    double = 2.0 * (u[0] * v[1] - u[1] * v[0])
    if abs(double) <= 1e-12 * (u @ u + v @ v):
        return None
    x = (v[1] * (u @ u) - u[1] * (v @ v)) / double
    y = (u[0] * (v @ v) - v[0] * (u @ u)) / double
    return a + np.array([x, y]), float(np.hypot(x, y))


def _turns(away: np.ndarray) -> np.ndarray:
    """Angles (m - 1,) between consecutive directions (m, 2)."""
    u, v = away[:-1], away[1:]
    return np.arctan2(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0], (u * v).sum(axis=1))


def curved_middles(X: np.ndarray, sides: np.ndarray, middles: np.ndarray, traced: np.ndarray) -> Middles:
    """Middles of those sides that are curved, by their ends.

    Args:
        X: (n, 2) [m]; sides: (m, 2) ends, the smaller first, of sides with a middle (m, 2) [m].
        traced: (k, 2) ends, the smaller first, of the sides that are asked for.
    """
    if not len(sides):
        return {}
    n = len(X)
    wanted = np.isin(sides @ (n, 1), traced.astype(np.int64) @ (n, 1))
    sides, middles = sides[wanted], middles[wanted]
    a, b = X[sides[:, 0]], X[sides[:, 1]]
    off, along = middles - 0.5 * (a + b), b - a
    square = (along * along).sum(axis=1)
    bent = np.abs(off[:, 0] * along[:, 1] - off[:, 1] * along[:, 0]) > BENT * square
    return {(int(i), int(j)): middle for (i, j), middle in zip(sides[bent], middles[bent])}


def cut_at_arcs(X: np.ndarray, chain: np.ndarray, curved: Middles) -> list[np.ndarray]:
    """The pieces of a chain: its arcs, and what lies between them."""
    stops = _chain_of(X, chain, curved).stops()
    return [chain[i : j + 1] for i, j in itertools.pairwise(stops)]


def imported_edge(
    X: np.ndarray, chain: np.ndarray, curved: Middles, name: str, ends: tuple[str, str]
) -> tuple[DraftEdge, np.ndarray]:
    """The edge of a chain, and the parameters of its inner nodes; nodes of a line or an arc are moved onto it."""
    known = _chain_of(X, chain, curved)
    last = len(chain) - 1
    if known.is_arc(0, last):
        bulge = float(np.tan(0.25 * known.arc(0, last)))
        centre, _ = arc_centre(X[chain[0]], X[chain[-1]], bulge)
        angles = np.unwrap(np.arctan2(*(X[chain] - centre).T[::-1]))
        s = ((angles - angles[0]) / (angles[-1] - angles[0]))[1:-1]
        z = arc_fraction(bulge, s)
        a, along = complex(*X[chain[0]]), complex(*(X[chain[-1]] - X[chain[0]]))
        X[chain[1:-1]] = np.column_stack([(a + along * z).real, (a + along * z).imag])
        return DraftEdge(name, "arc", *ends, bulge=bulge), s
    if known.curved:
        knots, points = known.knots(), known.points(0, last)
        inner = tuple(map(tuple, points[1:-1].tolist()))
        corners = np.isin(np.arange(len(points)), known.rows_of_corners())[1:-1]
        return DraftEdge(name, "spline", *ends, inner=inner, knots=tuple(knots.tolist())), knots[1:-1][corners]
    start, along = X[chain[0]], X[chain[-1]] - X[chain[0]]
    offset = X[chain[1:-1]] - start
    s = offset @ along / (along @ along)
    away = np.abs(offset[:, 0] * along[1] - offset[:, 1] * along[0]) / (along @ along)
    if away.max(initial=0.0) <= STRAIGHT and (np.diff(s, prepend=0.0, append=1.0) > 0.0).all():
        X[chain[1:-1]] = start + s[:, None] * along
        return DraftEdge(name, "line", *ends), s
    steps = np.hypot(*np.diff(X[chain], axis=0).T)
    knots = np.concatenate([[0.0], np.cumsum(steps)]) / steps.sum()
    knots[-1] = 1.0
    inner = tuple(map(tuple, X[chain[1:-1]].tolist()))
    return DraftEdge(name, "polyline", *ends, inner=inner, knots=tuple(knots.tolist())), knots[1:-1]


def _chain_of(X: np.ndarray, chain: np.ndarray, curved: Middles) -> BoundaryChain:
    pairs = zip(chain[:-1].tolist(), chain[1:].tolist())
    return BoundaryChain(X[chain], [curved.get((min(a, b), max(a, b))) for a, b in pairs])
