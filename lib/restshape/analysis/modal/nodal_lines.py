"""Lines along which a mode is still: where a field over triangles changes its sign."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

QUARTERS = ([0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5])
"""Nodes of the four triangles that a second-order one is drawn as."""
STILL = 1e-12
"""Share of the largest size of a field below which it is 0."""


def linear_triangles(cells: np.ndarray) -> np.ndarray:
    """Triangles (m, 3) between all nodes of cells (ne, 3), or (ne, 6) of second order, four of each."""
    return cells if cells.shape[1] == 3 else np.concatenate([cells[:, part] for part in QUARTERS])


@dataclass(frozen=True, eq=False)
class NodalLines:
    """Where a field that is linear on triangles is 0, a segment a triangle.

    Args:
        sides: (m, 2, 2) nodes at the ends of the sides on which each segment begins and ends.
        shares: (m, 2) of each side, from its first node on, where the segment meets it.
    """

    sides: np.ndarray
    shares: np.ndarray

    def those(self, chosen: np.ndarray) -> NodalLines:
        """The segments of a mask (m,) alone."""
        return NodalLines(self.sides[chosen], self.shares[chosen])

    def ends(self, field: np.ndarray) -> np.ndarray:
        """The values (m, 2, ...) of a field (n, ...) of the nodes at both ends of each segment."""
        shares = self.shares.reshape(*self.shares.shape, *(1,) * (field.ndim - 1))
        return (1.0 - shares) * field[self.sides[:, :, 0]] + shares * field[self.sides[:, :, 1]]


def nodal_lines(triangles: np.ndarray, values: np.ndarray) -> NodalLines:
    """The lines along which a field of values (n,) at nodes is 0; none where it is 0 on all of a triangle.

    Args:
        triangles: (m, 3) nodes.
        values: (n,); nodes at which they are 0 count as above it, so that a line through nodes is found once.
    """
    values = np.where(np.abs(values) <= STILL * np.abs(values).max(initial=0.0), 0.0, values)
    above = values[triangles] >= 0.0
    count = above.sum(axis=1)
    crossed = (count == 1) | (count == 2)
    corners, above, one = triangles[crossed], above[crossed], count[crossed] == 1
    rows = np.arange(len(corners))
    # The node that is alone on its side of the line, and the two others.
    alone = (above == one[:, None]).argmax(axis=1)
    apex = corners[rows, alone]
    sides = np.stack([np.stack([apex, corners[rows, (alone + k) % 3]], axis=1) for k in (1, 2)], axis=1)
    first, second = values[sides[..., 0]], values[sides[..., 1]]
    return NodalLines(sides, first / (first - second))


def inside(corners: np.ndarray, place: np.ndarray) -> bool:
    """Whether a place (2,) lies in one of the triangles with corners (m, 3, 2), or on its border."""
    start, u, v = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    to = place - start
    area = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    s, t = (to[:, 0] * v[:, 1] - to[:, 1] * v[:, 0]) / area, (u[:, 0] * to[:, 1] - u[:, 1] * to[:, 0]) / area
    return bool((np.minimum(np.minimum(s, t), 1.0 - s - t) >= -STILL).any())
