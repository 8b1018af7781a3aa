"""Marks that do not say how they move, put where the deformed shape is drawn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from restshape.live.shown_marks import Arrows, Lines, Mark, Tone, Words

if TYPE_CHECKING:
    from restshape.arrays import AnyArray, Reals
    from restshape.live.frame_arrays import PicturePart

STAYS = ("goal",)
"""Meanings of marks that lie where the deformed shape should come to be."""
INSIDE = -1e-6
"""Least share of a corner at which a place still counts as inside a triangle."""


class MovedMarks:
    """Gives displacements to marks that have none; of a mark that stays on the same picture the same object."""

    def __init__(self) -> None:
        self._on: tuple[AnyArray | None, AnyArray | None] = (None, None)
        self._known: list[tuple[Mark, Mark]] = []
        self._around: dict[int, int] = {}

    def __call__(self, marks: Sequence[Mark], parts: Sequence[PicturePart]) -> Sequence[Mark]:
        """The marks of a frame as they are drawn on its picture.

        Args:
            marks: of the application; parts: of the picture, of which the shape moves marks.
        """
        shape = next((one for one in parts if one.role == "shape" and "displacement" in one.arrays), None)
        if shape is None:
            return marks
        now = shape.arrays["points"], shape.arrays["displacement"]
        same = all(one is other for one, other in zip(now, self._on))
        before = self._known if same else []
        known: list[tuple[Mark, Mark]] = []
        drawn = _DrawnShape(*now, shape.arrays["cells"], self._around)
        for place, mark in enumerate(marks):
            kept = place < len(before) and before[place][0] is mark
            known.append(before[place] if kept else (mark, _with_moves(mark, drawn)))
        self._on, self._known = now, known
        return [drawn for _, drawn in known]


def _with_moves(mark: Mark, shape: _DrawnShape) -> Mark:
    """A mark with the displacements of its points, where it has points and says nothing of them itself."""
    if isinstance(mark, Tone):
        if mark.at is None:
            return mark
        return replace(mark, moved=shape.moves(np.array([mark.at], dtype=float))[0].tolist())
    if not isinstance(mark, Lines | Arrows | Words) or mark.moved is not None or mark.meaning in STAYS:
        return mark
    if isinstance(mark, Words):
        if mark.at is None:
            return mark
        return replace(mark, moved=shape.moves(np.array([mark.at], dtype=float))[0].tolist())
    return replace(mark, moved=shape.moves(np.asarray(mark.points, dtype=float))) if len(mark.points) else mark


@dataclass(eq=False)
class _DrawnShape:
    """A shape whose displacements are drawn.

    Args:
        points, displacement: (n, d) of its nodes [m]; cells: (m, 3) nodes of its triangles.
        around: triangles that places were in, in the order in which they were looked for: there they are looked for
            first.
    """

    points: AnyArray
    displacement: AnyArray
    cells: AnyArray
    around: dict[int, int]
    _asked: int = 0

    def moves(self, places: Reals) -> Reals:
        """Displacements (m, 3) [m] of places (m, d) [m]: those of the shape there; beside it, of its nearest node."""
        # Points in the plane have two coordinates, and so may displacements have.
        found, moved, d = np.zeros((len(places), 3)), self.displacement, self.points.shape[1]
        own = found[:, : moved.shape[1]]
        if not len(self.points):
            return found
        wanted = np.zeros((len(places), 3))
        wanted[:, : places.shape[1]] = places
        for row, place in enumerate(wanted):
            shares = self._shares(place) if self._flat else None
            if shares is not None:
                own[row] = shares[1] @ moved[shares[0]]
            else:
                own[row] = moved[((self.points - place[:d]) ** 2).sum(axis=1).argmin()]
        return found

    @cached_property
    def _flat(self) -> bool:
        """Whether it lies in the plane z = 0."""
        return self.points.shape[1] == 2 or not self.points[:, 2].any()

    @cached_property
    def _corners(self) -> Reals:
        """Coordinates (2, 3, m) of the triangles' corners in the plane."""
        return np.ascontiguousarray(self.points[:, :2].T.astype(float)[:, self.cells.T])

    @cached_property
    def _box(self) -> Reals:
        """The least and the largest coordinates (2, 2, m) of each triangle."""
        a, b, c = self._corners.swapaxes(0, 1)
        return np.stack([np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)])

    def _shares(self, place: Reals) -> tuple[AnyArray, Reals] | None:
        """The nodes (3,) of the triangle around a place, and their shares (3,); None where there is none."""
        self._asked += 1
        before = self.around.get(self._asked, len(self.cells))
        if before < len(self.cells):
            # Places go less far in a frame than to the next triangle.
            shares = _shares_in(self.points[self.cells[[before]], :2].transpose(1, 2, 0).astype(float), place)[0]
            if shares.min() >= 0.0:
                return self.cells[before], shares
        (left, low), (right, high) = self._box
        x, y = place[:2]
        near = np.flatnonzero((left <= x) & (x <= right) & (low <= y) & (y <= high))
        if not len(near):
            return None
        shares = _shares_in(self._corners[:, :, near].swapaxes(0, 1), place)
        inside = shares.min(axis=1)
        best = int(np.nan_to_num(inside, nan=-np.inf).argmax())
        if inside[best] < INSIDE:
            return None
        self.around[self._asked] = int(near[best])
        return self.cells[near[best]], shares[best]


def _shares_in(corners: Reals, place: Reals) -> Reals:
    """The shares (m, 3) of the corners (3, 2, m) of triangles at a place in the plane; NaN where one has no area."""
    a, b, c = corners
    x, y = place[:2]
    area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
    with np.errstate(divide="ignore", invalid="ignore"):
        second = ((x - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (y - a[1])) / area
        third = ((b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1])) / area
    return np.stack([1.0 - second - third, second, third], axis=1)
