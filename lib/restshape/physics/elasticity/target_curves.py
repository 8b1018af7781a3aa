"""Goals: how far the deformed edges of a body are from a curve that they should reach."""

import numpy as np

from restshape import _kernels
from restshape.physics.elasticity.goal import Goal
from restshape.shape import curves

PIECES = 240
"""Straight pieces of a goal, and points on it from which the way to the body is measured."""


def goal_curve(goal: Goal, pieces: int = PIECES) -> np.ndarray:
    """Points (m, 2) [m] on a goal in order, about evenly spaced, the given ones among them.

    Args:
        goal: of a scene.
        pieces: wanted; every part between two given points has one at least.
    """
    points = np.array(goal.spline or goal.polyline, dtype=float)
    knots = curves.chord_parameters(points)
    counts = np.maximum(np.round(np.diff(knots) * pieces).astype(int), 1)
    s = np.concatenate([*(np.linspace(a, b, n, endpoint=False) for a, b, n in zip(knots, knots[1:], counts)), [1.0]])
    if goal.spline:
        return curves.spline_weights(knots, ("natural", "natural"), s) @ points
    return curves.polyline_weights(knots, s) @ points


class CurveDistances:
    """Distances between a goal and the deformed facets of a mesh, of the points of each from the other.

    Args:
        goal: of a scene.
        facets: (nf, 2) nodes of the facets, or (nf, 3) with mid-side nodes last.
    """

    def __init__(self, goal: Goal, facets: np.ndarray) -> None:
        self.curve = np.ascontiguousarray(goal_curve(goal))
        self.starts, self.ends = np.ascontiguousarray(self.curve[:-1]), np.ascontiguousarray(self.curve[1:])
        # A second-order facet counts as two straight pieces.
        pieces = facets if facets.shape[1] == 2 else np.concatenate([facets[:, [0, 2]], facets[:, [2, 1]]])
        self.nodes, pieces = np.unique(pieces, return_inverse=True)
        self.pieces = pieces.reshape(-1, 2)
        self._places: np.ndarray | None = None
        self._found: tuple[np.ndarray, np.ndarray] | None = None

    def __call__(self, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Distances [m] of `nodes` at places (k, 2) [m] from the goal (k,), and of the goal's points (m,) from the
        facets; those of the last places are kept, for quantities that reduce them otherwise."""
        if self._found is None or not np.array_equal(places, self._places):
            starts, ends = places[self.pieces[:, 0]], places[self.pieces[:, 1]]
            there = _kernels.distances(places, self.starts, self.ends)
            self._places, self._found = places.copy(), (there, _kernels.distances(self.curve, starts, ends))
        return self._found


class GoalDistance:
    """The distance between a goal and the deformed facets of a mesh, counted from both.

    Args:
        distances: between them.
        reduce: "mean", half the mean of either direction along the curves' lengths, or "max", the larger maximum.
    """

    def __init__(self, distances: CurveDistances, reduce: str) -> None:
        self.distances, self.reduce = distances, reduce
        self.curve_weights = trapezoid(distances.starts, distances.ends)

    def __call__(self, x: np.ndarray) -> float:
        """The distance [m] with the nodes at x (n, 2) [m]."""
        own, (a, b) = x[self.distances.nodes], self.distances.pieces.T
        there, back = self.distances(own)
        if self.reduce == "max":
            return float(max(there.max(), back.max()))
        lengths = np.hypot(*(own[b] - own[a]).T)
        mean = 0.5 * (lengths @ (there[a] + there[b])) / lengths.sum()
        return 0.5 * float(mean + self.curve_weights @ back)


def trapezoid(starts: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Weights (m + 1,) of the points of a chain of m pieces that give the mean along its length."""
    lengths = np.hypot(*(ends - starts).T)
    weights = np.zeros(len(lengths) + 1)
    weights[:-1] += 0.5 * lengths
    weights[1:] += 0.5 * lengths
    return weights / lengths.sum()
