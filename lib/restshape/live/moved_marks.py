"""Marks that do not say how they move, put where the deformed shape is drawn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from operator import is_, mul
from typing import TYPE_CHECKING, Any, TypeVar, cast

import numpy as np

from restshape.live.shifted_points import shifted
from restshape.live.shown_marks import Arrows, Lines, Mark, Tone, Words

if TYPE_CHECKING:
    from restshape.arrays import AnyArray, Reals
    from restshape.live.frame_arrays import PicturePart

T = TypeVar("T", bound=Any)
ALONG, AT_A_PLACE = (Lines, Arrows), (Words, Tone)
MOVED = ALONG + AT_A_PLACE
STAYS = ("goal",)
"""Meanings of marks that lie where the deformed shape should come to be."""
SPACE = 3
"""Directions of displacements as they are drawn."""
AT_ONCE = 1 << 14
"""Distances from nodes to places that are computed at once: more of them leave the processor's nearest memory."""
INSIDE = -1e-6
"""Least share of a corner at which a place still counts as inside a triangle."""


class MovedMarks:
    """Gives displacements to marks that have none; of a mark that stays on the same picture the same object."""

    def __init__(self) -> None:
        self._on: tuple[AnyArray | None, AnyArray | None] = (None, None)
        self._shift: object = None
        self._known: list[tuple[Mark, Mark]] = []
        self._around: dict[int, int] = {}
        self._still: Sequence[Mark] = ()

    def __call__(self, marks: Sequence[Mark], parts: Sequence[PicturePart]) -> Sequence[Mark]:
        """The marks of a frame as they are drawn on its picture.

        Args:
            marks: of the application; parts: of the picture, of which the shape moves marks.
        """
        if len(marks) == len(self._still) and all(map(is_, marks, self._still)):
            return marks
        if not any(map(_left, marks)):
            self._still = marks
            return marks
        self._still = ()
        shape = next((one for one in parts if one.role == "shape" and "displacement" in one.arrays), None)
        if shape is None:
            return marks
        now = shape.arrays["points"], shape.arrays["displacement"]
        shift = shape.said.get("shift")
        stays = now[0] is self._on[0] and now[1] is self._on[1] and shift == self._shift
        before, known = self._known, list[tuple[Mark, Mark]]()
        drawn = _DrawnShape(now[0], shifted(now[1], shift), shape.arrays["cells"], self._around)
        lasts = [
            before[number][1] if number < len(before) and before[number][0] is mark else None
            for number, mark in enumerate(marks)
        ]
        places = [_places(mark) if last is None or not stays else [] for mark, last in zip(marks, lasts)]
        # Those of all marks together: each look at the shape takes longer than what it finds.
        moves = iter(drawn.moves([place for own in places for place in own]))
        for mark, last, own in zip(marks, lasts, places):
            if own:
                known.append((mark, _gone(mark, [next(moves) for _ in own], last)))
            else:
                known.append((mark, last if stays and last is not None else mark))
        self._on, self._shift, self._known = now, shift, known
        return [drawn for _, drawn in known]


def _left(mark: Mark) -> bool:
    """Whether a mark has points, and leaves it to the shape how they move."""
    kind = type(mark)
    if kind not in MOVED or mark.moved is not None:  # type: ignore[union-attr]
        return False
    if kind in ALONG and mark.nodes is not None:  # type: ignore[union-attr]
        return False
    return kind is Tone or mark.meaning not in STAYS  # type: ignore[union-attr]


def _places(mark: Mark) -> Sequence[Sequence[float]]:
    """The places [m] at which the shape moves a mark; none where it has none, or says itself how it moves."""
    if not _left(mark):
        return []
    if isinstance(mark, ALONG):
        found: list[list[float]] = np.asarray(mark.points, dtype=float).tolist()
        return found
    return [mark.at] if isinstance(mark, AT_A_PLACE) and mark.at is not None else []


def _gone(mark: Mark, moves: list[list[float]], last: Mark | None) -> Mark:
    """A mark with the displacements [m] of its places.

    Args:
        mark: of the application; moves: of each of its places.
        last: what became of the same mark in the frame before, which stays where it has not moved; None: nothing.
    """
    if isinstance(mark, AT_A_PLACE):
        return last if isinstance(last, AT_A_PLACE) and last.moved == moves[0] else replace(mark, moved=moves[0])
    if isinstance(last, ALONG) and last.moved is not None and last.moved.tolist() == moves:
        return last
    return mark.gone(np.array(moves)) if isinstance(mark, ALONG) else mark


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

    def moves(self, places: Sequence[Sequence[float]]) -> list[list[float]]:
        """Displacements [m] in space of places [m]: those of the shape there; beside it, of its nearest node."""
        if not len(self.points):
            return [[0.0] * SPACE for _ in places]
        if self._flat:
            return [self._moves(place) for place in places]
        some = max(AT_ONCE // len(self.points), 1)
        parts = (places[first : first + some] for first in range(0, len(places), some))
        return [own for part in parts for own in self._nearest(part)]

    def _nearest(self, places: Sequence[Sequence[float]]) -> list[list[float]]:
        """Displacements in space of the nearest nodes, which are found for all places at once."""
        d = self.points.shape[1]
        wanted = np.array([[*place, *[0.0] * SPACE][:d] for place in places])
        points = cast("Reals", self.points)
        nodes = ((points - wanted[:, None]) ** 2).sum(axis=2).argmin(axis=1)
        found: list[list[float]] = self.displacement[nodes].tolist()
        return found if len(found[0]) == SPACE else [[*own, *[0.0] * (SPACE - len(own))] for own in found]

    def _moves(self, place: Sequence[float]) -> list[float]:
        """The displacement in space of a place; numbers of Python, for those of so few points cost least."""
        shares = self._shares(place) if self._flat else None
        if shares is not None:
            own = [sum(map(mul, shares[1], along)) for along in zip(*self.displacement[shares[0]].tolist())]
        else:
            # Points in the plane have two coordinates, and so may displacements have.
            d = self.points.shape[1]
            wanted = np.array([*place, *[0.0] * SPACE][:d])
            own = self.displacement[((self.points - wanted) ** 2).sum(axis=1).argmin()].tolist()
        return [*own, *[0.0] * (SPACE - len(own))]

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

    def _shares(self, place: Sequence[float]) -> tuple[AnyArray, Sequence[float]] | None:
        """The nodes (3,) of the triangle around a place, and their three shares; None where there is none."""
        self._asked += 1
        before = self.around.get(self._asked, len(self.cells))
        if before < len(self.cells):
            # Places go less far in a frame than to the next triangle.
            nodes = self.cells[before]
            (ax, ay), (bx, by), (cx, cy) = self.points[nodes, :2].tolist()
            own = (
                _shares_of(ax, ay, bx, by, cx, cy, *place[:2]) if (bx - ax) * (cy - ay) != (cx - ax) * (by - ay) else ()
            )
            if own and min(own) >= INSIDE:
                return nodes, own
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
        return self.cells[near[best]], shares[best].tolist()


def _shares_in(corners: Reals, place: Sequence[float]) -> Reals:
    """The shares (m, 3) of the corners (3, 2, m) of triangles at a place in the plane; NaN where one has no area."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.stack(_shares_of(*corners.reshape(6, -1), *place[:2]), axis=1)


def _shares_of(ax: T, ay: T, bx: T, by: T, cx: T, cy: T, x: float, y: float) -> tuple[T, T, T]:
    """The shares of the corners a, b and c of a triangle at a place: of one by numbers, of many by arrays (m,)."""
    area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
    second = ((x - ax) * (cy - ay) - (cx - ax) * (y - ay)) / area
    third = ((bx - ax) * (y - ay) - (x - ax) * (by - ay)) / area
    return 1.0 - second - third, second, third
