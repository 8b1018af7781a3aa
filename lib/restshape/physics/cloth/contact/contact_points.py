"""Where cloth touches: corners of triangles, and points between them where corners alone would let a body in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from restshape import _kernels

SAG = 0.5
"""How much deeper a body may be between two points of a triangle than at these, over the thickness of contact."""
NEAR, LEFT = 2.0, 6.0
"""Distances of a body, over the thickness of contact, within which triangles get points, and beyond which they lose
them."""
NOTICED = 0.25
"""How much nearer to a body than its corners a triangle must be to get points, over the thickness of contact."""
PRESSED = 0.25
"""Depth of a body in a triangle, over the thickness of contact or a thinner body's, at which there are more points."""
FLAT = 0.05
"""How much deeper a body may be between points, over the same, where more of them are of no use."""
MOST_PARTS = 48
"""Parts of a triangle's side at most."""
CLOSE = 0.02
"""Tolerance of distances over triangles, over the thickness of contact."""


@lru_cache(maxsize=MOST_PARTS)
def lattice(parts: int) -> tuple[np.ndarray, np.ndarray]:
    """Points between the corners of a triangle whose sides are cut in parts, by the composite rule of the corners.

    Returns: their barycentric coordinates (m, 3), and the share (m,) of the triangle that each stands for. Each corner
    stands for 1/(3 parts^2) of it.
    """
    i, j = (part.ravel() for part in np.mgrid[: parts + 1, : parts + 1])
    counts = np.column_stack([i, j, parts - i - j])[i + j <= parts]
    counts = counts[counts.max(axis=1) < parts]
    # Six of the small triangles meet at a point inside, three at one on a side.
    met = np.where(counts.min(axis=1) == 0, 3.0, 6.0)
    return counts / parts, met / (3.0 * parts**2)


def spacing_on(body: _kernels.Body, radius: np.ndarray | float, thickness: float) -> np.ndarray:
    """How far apart points may be [m] where a body's surface has a radius of curvature [m], see `SAG`.

    Nor does a thin body find its way between them.
    """
    sagging = np.sqrt(8.0 * (radius + 0.5 * thickness) * SAG * thickness)
    return np.minimum(sagging, 2.0 * (body.inner_radius + 0.25 * thickness))


@dataclass(frozen=True, eq=False)
class ContactPoints:
    """Points that triangles of a sheet touch with besides their corners.

    Args:
        cells: (ne, 3) int32 corners of the triangles.
        parts: (ne,) how many parts a triangle's sides are cut in; 1: it touches with its corners alone.
    """

    cells: np.ndarray
    parts: np.ndarray

    @classmethod
    def none(cls, cells: np.ndarray) -> ContactPoints:
        """Corners alone."""
        return cls(cells, np.ones(len(cells), dtype=np.int64))

    @cached_property
    def cut(self) -> np.ndarray:
        """The triangles (k,) that have points, in order."""
        return np.flatnonzero(self.parts > 1)

    @cached_property
    def counts(self) -> np.ndarray:
        """Points (ne,) of each triangle."""
        return np.where(self.parts > 1, (self.parts + 1) * (self.parts + 2) // 2 - 3, 0)

    @cached_property
    def cell(self) -> np.ndarray:
        """The triangle (m,) int32 of each point."""
        return np.repeat(np.arange(len(self.parts), dtype=np.int32), self.counts)

    @cached_property
    def weights(self) -> np.ndarray:
        """Barycentric coordinates (m, 3) of the points."""
        return np.concatenate([np.empty((0, 3)), *(lattice(int(parts))[0] for parts in self.parts[self.cut])])

    @cached_property
    def share(self) -> np.ndarray:
        """The part (m,) of its triangle that each point stands for."""
        return np.concatenate([np.empty(0), *(lattice(int(parts))[1] for parts in self.parts[self.cut])])

    @cached_property
    def nodes(self) -> np.ndarray:
        """The corners (m, 3) int32 around each point."""
        return np.ascontiguousarray(self.cells[self.cell])

    def place(self, values: np.ndarray) -> np.ndarray:
        """Values (n, f) at the corners, followed by those (m, f) at the points."""
        if not len(self.cut):
            return values
        if values.shape[1] == 3:
            return _kernels.with_points(values, self.nodes, self.weights)
        return np.concatenate([values, np.einsum("pk,pka->pa", self.weights, values[self.nodes])])

    def areas(self, corners: np.ndarray, triangles: np.ndarray) -> np.ndarray:
        """What corners and points (n + m,) stand for, from what corners do alone (n,) and from triangles (ne,)."""
        if not len(self.cut):
            return corners
        given = triangles[self.cut] * (1.0 - 1.0 / self.parts[self.cut] ** 2) / 3.0
        left = corners - np.bincount(self.cells[self.cut].ravel(), np.repeat(given, 3), minlength=len(corners))
        return np.concatenate([left, self.share * triangles[self.cell]])

    def on(
        self, bodies: Sequence[_kernels.Body], x: np.ndarray, thickness: float, asked: np.ndarray | None = None
    ) -> ContactPoints:
        """The points for corners at x (n, 3) [m]; the same object where they are these.

        A triangle gets points where a body is nearer to it than to its corners, and near at all. They are so close that
        the body is at most half of the thickness deeper between them. It keeps them until the body has left.

        Args:
            bodies: that it may touch.
            x: corners.
            thickness: of contact [m].
            asked: (ne,) which triangles are looked at, the others stay as they are; None: all.
        """
        if asked is not None and not asked.any():
            return self
        parts, longest = np.ones_like(self.parts), _kernels.longest_sides(x, self.cells)
        most = longest.max(initial=0.0)
        for body in bodies:
            if spacing_on(body, body.sharpest, thickness) < most:
                np.maximum(parts, self._near(body, x, longest, thickness, asked), out=parts)
        if asked is not None:
            parts = np.where(asked, parts, self.parts)
        return self if np.array_equal(parts, self.parts) else ContactPoints(self.cells, parts)

    def _near(
        self, body: _kernels.Body, x: np.ndarray, longest: np.ndarray, thickness: float, asked: np.ndarray | None
    ) -> np.ndarray:
        """Parts (ne,) that a body asks for of the sides of triangles, the longest of which are given (ne,) [m]."""
        found = np.ones_like(self.parts)
        distance = self._distances(body, x, asked)
        # No place of a triangle is farther from its first corner than its longest side.
        close = distance[self.cells[:, 0]] < longest + LEFT * thickness
        near = np.flatnonzero(close if asked is None else close & asked)
        if not len(near):
            return found
        nearest = distance[self.cells[near]].min(axis=1)
        had = self.parts[near]
        # Where a triangle has no points, none but those that it may get are of interest.
        noticed = np.minimum(NEAR * thickness, nearest - NOTICED * thickness)
        enough = np.where(had > 1, LEFT * thickness, noticed)
        lowest, radius = body.lowest_each(x, self.cells[near], CLOSE * thickness, enough)
        spacing = spacing_on(body, radius, thickness)
        kept = (lowest < LEFT * thickness) & (had > 1)
        deeper = (lowest < NEAR * thickness) & (nearest - lowest > NOTICED * thickness)
        wanted = np.minimum(np.ceil(longest[near] / spacing), MOST_PARTS).astype(np.int64)
        # A triangle that stretches a little keeps the points that it has.
        wanted = np.where(kept & (wanted <= had + 1), had, wanted)
        sag = (longest[near] / had) ** 2 / (8.0 * (radius + 0.5 * thickness))
        # Thin bodies pass where cloth is as deep as they are.
        size = min(thickness, body.inner_radius)
        # A flat triangle on a large ball is one that corners alone would do for.
        more = kept | (deeper & (wanted == 1))
        wanted[more & (lowest < -PRESSED * size) & (sag > FLAT * size)] *= 2
        found[near] = np.where(kept | deeper, np.minimum(wanted, MOST_PARTS), 1)
        return found

    def _distances(self, body: _kernels.Body, x: np.ndarray, asked: np.ndarray | None) -> np.ndarray:
        """Of a body from corners at x (n, 3), of triangles that are `asked` (ne,) for; infinite elsewhere."""
        if asked is None:
            return body.distances(x)
        found, corners = np.full(len(x), np.inf), np.zeros(len(x), dtype=bool)
        corners[self.cells[asked]] = True
        found[corners] = body.distances(x[corners])
        return found

    def sources_in(self, before: ContactPoints, n: int) -> np.ndarray:
        """For each of n corners and of the points the number (n + m,) of the same one before; -1: there was none."""
        same = (self.parts == before.parts)[self.cell]
        first, own = (np.cumsum(points.counts) - points.counts for points in (before, self))
        shifted = n + np.arange(len(self.cell)) + (first - own)[self.cell]
        return np.concatenate([np.arange(n), np.where(same, shifted, -1)])
