"""Distances between a measured outline and the shadow of a drape, both ways, and how they follow both."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from restshape_apps.couture.fitting.measured_outline import MeasuredOutline

from restshape.physics.cloth.drape_shadow import ShadowEdge, directions

MEASURED = 360
"""Places along the measured outline at which its distance is taken."""
EVERY = 2
"""Of the directions of a shadow, those that its edge is taken at."""


@dataclass(frozen=True)
class Place:
    """Where the measured outline is placed: turned about its middle, and moved.

    Args:
        turn: angle [rad]; x, y: of its middle [m].
    """

    turn: float
    x: float
    y: float

    def lay(self, points: np.ndarray) -> np.ndarray:
        """Points (m, 2) from the middle of the outline [m], placed."""
        c, s = np.cos(self.turn), np.sin(self.turn)
        return points @ np.array([[c, s], [-s, c]]) + [self.x, self.y]


@dataclass(frozen=True, eq=False)
class Distances:
    """Signed distances, positive where the measured outline is outside of the shadow.

    Args:
        values: (`MEASURED` + directions,) [m], of places of the measured outline from the shadow's edge, then of places
            of that from the measured outline.
        by_place: (.., 3) derivatives by turn [rad], x and y [m] of the measured outline.
        first, second: numbers (..,) of the places of the shadow's edge that each follows; shares: (..,) of the second.
        ways: (.., 2) unit vectors from the shadow outwards.
    """

    values: np.ndarray
    by_place: np.ndarray
    first: np.ndarray
    second: np.ndarray
    shares: np.ndarray
    ways: np.ndarray

    def by_radii(self, rates: np.ndarray) -> np.ndarray:
        """Rates (..,) as the radii of the shadow's edge have rates (directions,)."""
        moved = rates[:, None] * directions()[::EVERY]
        there = (1.0 - self.shares)[:, None] * moved[self.first] + self.shares[:, None] * moved[self.second]
        return -np.einsum("ka,ka->k", self.ways, there)

    @property
    def weights(self) -> np.ndarray:
        """Roots (..,) of weights with which the sum of squares is the mean of both ways."""
        n, m = MEASURED, len(self.values) - MEASURED
        return np.sqrt(np.concatenate([np.full(n, 0.5 / n), np.full(m, 0.5 / m)]))

    @property
    def rms(self) -> float:
        """Root of the mean of the squares of both ways [m]."""
        return float(np.linalg.norm(self.weights * self.values))

    @property
    def farthest(self) -> float:
        """The largest distance [m]: Hausdorff's between the places."""
        return float(np.abs(self.values).max())


def distances(measured: np.ndarray, place: Place, edge: ShadowEdge) -> Distances:
    """Distances between a measured outline and the edge of a shadow.

    The nearest point of the other line does not matter for how a distance changes: it lies where the line and the way
    to it are at a right angle (the envelope theorem).

    Args:
        measured: (`MEASURED`, 2) places along it from its middle [m].
        place: where it is placed; edge: of the shadow.
    """
    p, q = place.lay(measured), edge.points()[::EVERY]
    count = len(q)
    k, share, foot = _nearest(p, q)
    outside = _outside(p, edge, q)
    values, ways = _signed(p - foot, outside, q, k)
    levers = np.stack([-(p[:, 1] - place.y), p[:, 0] - place.x], axis=1)
    j, along, base = _nearest(q, p)
    beyond = ~_inside(q, p)
    back, outwards = _signed(base - q, ~beyond, p, j)
    # Where the shadow reaches out of the measured outline, the way from the shadow to it is inwards.
    lever = (1.0 - along)[:, None] * levers[j] + along[:, None] * levers[(j + 1) % MEASURED]
    turned = np.concatenate([np.einsum("ka,ka->k", ways, levers), np.einsum("ka,ka->k", outwards, lever)])
    both = np.concatenate([ways, outwards])
    numbers = np.arange(count)
    return Distances(
        np.concatenate([values, back]),
        np.column_stack([turned, both]),
        np.concatenate([k, numbers]),
        np.concatenate([(k + 1) % count, numbers]),
        np.concatenate([share, np.zeros(count)]),
        both,
    )


def _nearest(points: np.ndarray, line: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of points (m, 2) the nearest piece (m,) of a closed line (k, 2), the share (m,) along it, the place (m, 2)."""
    along = np.roll(line, -1, axis=0) - line
    length = np.maximum(np.einsum("ka,ka->k", along, along), np.finfo(float).tiny)
    ahead = points @ along.T - np.einsum("ka,ka->k", line, along)
    share = np.clip(ahead / length, 0.0, 1.0)
    # Squares of distances less those of the points from the origin, which all pieces share.
    away = share * (share * length - 2.0 * ahead) - 2.0 * (points @ line.T) + np.einsum("ka,ka->k", line, line)
    best = away.argmin(axis=1)
    own = share[np.arange(len(points)), best]
    return best, own, line[best] + own[:, None] * along[best]


def _signed(
    way: np.ndarray, positive: np.ndarray, line: np.ndarray, piece: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Signed lengths (m,) of ways (m, 2), and unit vectors (m, 2) along them outwards; of none the line's normal."""
    length = np.hypot(*way.T)
    along = line[(piece + 1) % len(line)] - line[piece]
    normal = np.stack([along[:, 1], -along[:, 0]], axis=1)
    normal /= np.maximum(np.hypot(*normal.T), np.finfo(float).tiny)[:, None]
    sign = np.where(positive, 1.0, -1.0)
    there = length > 1e-12
    unit = sign[:, None] * way / np.where(there, length, 1.0)[:, None]
    return sign * length, np.where(there[:, None], unit, normal)


def _outside(points: np.ndarray, edge: ShadowEdge, line: np.ndarray) -> np.ndarray:
    """Whether points (m, 2) are outside of a shadow, by the piece of its edge (k, 2) in their direction."""
    way = points - edge.middle
    turn = np.arctan2(way[:, 1], way[:, 0]) / (2.0 * np.pi) * len(line)
    k = np.floor(turn).astype(int) % len(line)
    along, here = line[(k + 1) % len(line)] - line[k], points - line[k]
    return along[:, 0] * here[:, 1] - along[:, 1] * here[:, 0] < 0.0


def _inside(points: np.ndarray, line: np.ndarray) -> np.ndarray:
    """Whether points (m, 2) are within a closed line (k, 2), by the crossings of a ray."""
    a, b = line, np.roll(line, -1, axis=0)
    x, y = points[:, None, 0], points[:, None, 1]
    spans = (a[:, 1] > y) != (b[:, 1] > y)
    rise = np.where(b[:, 1] == a[:, 1], 1.0, b[:, 1] - a[:, 1])
    crossing = a[:, 0] + (y - a[:, 1]) / rise * (b[:, 0] - a[:, 0])
    return (spans & (x < crossing)).sum(axis=1) % 2 == 1


def from_middle(measured: MeasuredOutline) -> np.ndarray:
    """Places (`MEASURED`, 2) evenly along a measured outline, from its middle [m]."""
    return measured.spread(MEASURED) - measured.middle
