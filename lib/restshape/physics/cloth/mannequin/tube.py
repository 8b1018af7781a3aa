"""Parts of bodies: tubes of sections that are two half ellipses, and their smooth union."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.interpolate import PchipInterpolator
from scipy.special import ellipe

NEAR = 1e-9
"""Distance from an axis [m] below which its direction has no meaning."""

Section = tuple[float, float, float]
"""Half of the breadth, and the depths in front of the axis and behind it [m]."""


def ellipse_girth(a: float, b: float) -> float:
    """The girth [m] of an ellipse of these half axes [m], by the complete elliptic integral of the second kind."""
    long, short = max(a, b), min(a, b)
    return 4.0 * long * float(ellipe(1.0 - (short / long) ** 2))


def section(girth: float, breadth: float = 1.0, front: float = 0.5) -> Section:
    """A section of two half ellipses of a girth [m].

    Args:
        girth: of the whole section [m].
        breadth: over the depth.
        front: part of the depth that is in front of the axis.
    """
    before, behind = 2.0 * front, 2.0 - 2.0 * front
    scale = 2.0 * girth / (ellipse_girth(breadth, before) + ellipse_girth(breadth, behind))
    return scale * breadth, scale * before, scale * behind


class Tube:
    """Sections along a straight axis, between which their half axes are interpolated without overshoot; round ends.

    Args:
        rows: along the axis [m]: height, place (2,) of the centre, section.
        caps: how far the ends bulge, the lower and the upper one [m].
        far: distance [m] from the box around it beyond which nothing is computed.
        origin: (3,) of the axis [m].
        axes: (3, 3) rows: the directions of breadth, of depth (from front to back) and of the axis.
    """

    def __init__(
        self,
        rows: Sequence[tuple[float, tuple[float, float], Section]],
        caps: tuple[float, float],
        far: float,
        origin: Sequence[float] = (0.0, 0.0, 0.0),
        axes: np.ndarray | None = None,
    ) -> None:
        self.origin, self.caps, self.far = np.array(origin), caps, far
        self.axes = np.eye(3) if axes is None else axes
        heights = [height for height, _, _ in rows]
        self.heights = np.array(heights)
        self.ends = heights[0], heights[-1]
        centres, halves = (np.array([row[k] for row in rows]) for k in (1, 2))
        reach = np.column_stack([halves[:, 0], halves[:, 1:].max(axis=1)])
        self.low = np.array([*(centres - reach).min(axis=0), heights[0] - caps[0]]) - far
        self.high = np.array([*(centres + reach).max(axis=0), heights[-1] + caps[1]]) + far
        self.along = PchipInterpolator(heights, [[*centre, *half] for _, centre, half in rows])

    def __call__(self, places: np.ndarray) -> np.ndarray:
        """The distance (...) from the surface at places (..., 3) [m], negative inside, 0 on it exactly, `far` at most.

        Elsewhere it is measured from the middle of the section through the place, which is not the shortest way.
        """
        own = (places - self.origin) @ self.axes.T
        near = np.all((own >= self.low) & (own <= self.high), axis=-1)
        found = np.full(near.shape, self.far)
        found[near] = self._within(own[near])
        return found

    def reach(self, places: np.ndarray) -> np.ndarray:
        """The same distance (n,) of places (n, 3) wherever they are."""
        return self._within((places - self.origin) @ self.axes.T)

    def taken_to(self, other: Tube, places: np.ndarray) -> np.ndarray:
        """Where places (n, 3) of this tube are in another one with as many sections: at the same share of each."""
        own = (places - self.origin) @ self.axes.T
        height = np.clip(own[:, 2], *self.ends)
        beyond = np.interp(height, self.heights, other.heights)
        (x, y, half, *depths), (to_x, to_y, to_half, *to_depths) = self.along(height).T, other.along(beyond).T
        behind, above = own[:, 1] > y, own[:, 2] > height
        found = np.column_stack(
            [
                to_x + (own[:, 0] - x) * to_half / half,
                to_y + (own[:, 1] - y) * np.where(behind, to_depths[1], to_depths[0]) / np.where(behind, *depths[::-1]),
                beyond + (own[:, 2] - height) * np.where(above, *other.caps[::-1]) / np.where(above, *self.caps[::-1]),
            ]
        )
        return found @ other.axes + other.origin

    def _within(self, own: np.ndarray) -> np.ndarray:
        """The distance (n,) of places (n, 3) in the tube's own frame."""
        height = np.clip(own[:, 2], *self.ends)
        x, y, half, front, back = self.along(height).T
        across, deep, over = own[:, 0] - x, own[:, 1] - y, own[:, 2] - height
        depth = np.where(deep < 0.0, front, back)
        cap = np.where(over < 0.0, *self.caps)
        share = np.sqrt((across / half) ** 2 + (deep / depth) ** 2 + (over / cap) ** 2)
        radius = np.sqrt(across**2 + deep**2 + over**2)
        return np.where(radius > NEAR, radius - radius / np.maximum(share, NEAR), -half)


def blended(first: np.ndarray, second: np.ndarray, reach: float) -> np.ndarray:
    """Distances of the union of two bodies, smooth where both are within a reach [m] of each other, exact elsewhere.

    Source: the cubic smooth minimum of I. Quilez, "smooth minimum"; it is twice continuously differentiable.
    """
    apart = np.maximum(reach - np.abs(first - second), 0.0) / reach
    return np.minimum(first, second) - apart**3 * reach / 6.0
