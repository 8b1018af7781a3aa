"""Areas inside loose curves by Gauss quadrature of x dy - y dx, independent of the program's own shapes."""

from collections.abc import Callable, Sequence

import numpy as np

NODES, WEIGHTS = np.polynomial.legendre.leggauss(24)
Piece = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
"""Points (n, 2) and derivatives (n, 2) of a curve at parameters (n,) from 0 to 1."""


def line(a: Sequence[float], b: Sequence[float]) -> Piece:
    start, way = np.array(a, dtype=float), np.subtract(b, a)
    return lambda s: (start + s[:, None] * way, np.broadcast_to(way, (len(s), 2)))


def arc(centre: Sequence[float], radius: float, first: float, turn: float) -> Piece:
    """From the angle `first` [rad] by `turn` [rad]."""

    def at(s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        angle = first + turn * s
        ray = np.stack([np.cos(angle), np.sin(angle)], 1)
        return np.array(centre) + radius * ray, radius * turn * ray[:, ::-1] * (-1.0, 1.0)

    return at


def bezier(controls: np.ndarray) -> Piece:
    a, b, c, d = controls

    def at(s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        t = s[:, None]
        u = 1.0 - t
        points = u**3 * a + 3 * u**2 * t * b + 3 * u * t**2 * c + t**3 * d
        return points, 3 * (u**2 * (b - a) + 2 * u * t * (c - b) + t**2 * (d - c))

    return at


def enclosed(pieces: list[Piece], reach: float) -> float:
    """The area that curves enclose which join end to end, in any order and direction; ends meet within `reach`."""
    ends = [piece(np.array([0.0, 1.0]))[0] for piece in pieces]
    left, at, total = set(range(len(pieces))), ends[0][0], 0.0
    while left:
        i, forward = next(
            (i, forward)
            for i in sorted(left)
            for forward in (True, False)
            if np.hypot(*(ends[i][int(not forward)] - at)) < reach
        )
        points, rates = pieces[i](0.5 * (NODES + 1.0))
        part = 0.25 * float(WEIGHTS @ (points[:, 0] * rates[:, 1] - points[:, 1] * rates[:, 0]))
        total += part if forward else -part
        at = ends[i][int(forward)]
        left.discard(i)
    assert np.hypot(*(at - ends[0][0])) < reach, "the curves do not close"
    return abs(total)
