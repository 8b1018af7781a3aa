"""Marks that do not say how they move, put where the deformed shape is drawn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from restshape.live.shown_marks import Arrows, Lines, Mark, Words

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
        for place, mark in enumerate(marks):
            kept = place < len(before) and before[place][0] is mark
            known.append(before[place] if kept else (mark, _with_moves(mark, shape)))
        self._on, self._known = now, known
        return [drawn for _, drawn in known]


def _with_moves(mark: Mark, shape: PicturePart) -> Mark:
    """A mark with the displacements of its points, where it has points and says nothing of them itself."""
    if not isinstance(mark, Lines | Arrows | Words) or mark.moved is not None or mark.meaning in STAYS:
        return mark
    if isinstance(mark, Words):
        if mark.at is None:
            return mark
        return replace(mark, moved=_moved(np.array([mark.at], dtype=float), shape)[0].tolist())
    return replace(mark, moved=_moved(np.asarray(mark.points, dtype=float), shape)) if len(mark.points) else mark


def _moved(places: Reals, shape: PicturePart) -> Reals:
    """Displacements (m, 3) [m] of places (m, d) [m]: those of the shape there; beside it those of its nearest node."""
    X, moved = shape.arrays["points"].astype(float), shape.arrays["displacement"].astype(float)
    found = np.zeros((len(places), 3))
    if not len(X):
        return found
    wanted = np.zeros((len(places), 3))
    wanted[:, : places.shape[1]] = places
    flat = not X[:, 2].any()
    for row, place in enumerate(wanted):
        shares = _shares(X, shape.arrays["cells"], place) if flat else None
        if shares is not None:
            found[row] = shares[1] @ moved[shares[0]]
        else:
            found[row] = moved[((X - place) ** 2).sum(axis=1).argmin()]
    return found


def _shares(X: Reals, cells: AnyArray, place: Reals) -> tuple[AnyArray, Reals] | None:
    """The nodes (3,) of the triangle in the plane around a place, and their shares (3,); None where there is none."""
    corners = X[cells, :2]
    low, high = corners.min(axis=1), corners.max(axis=1)
    near = np.flatnonzero(((low <= place[:2]) & (place[:2] <= high)).all(axis=1))
    if not len(near):
        return None
    a, b, c = corners[near].transpose(1, 2, 0)
    area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
    x, y = place[:2]
    with np.errstate(divide="ignore", invalid="ignore"):
        second = ((x - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (y - a[1])) / area
        third = ((b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1])) / area
    shares = np.stack([1.0 - second - third, second, third], axis=1)
    inside = shares.min(axis=1)
    best = int(np.nan_to_num(inside, nan=-np.inf).argmax())
    return (cells[near[best]], shares[best]) if inside[best] >= INSIDE else None
