"""Marks of the valid range of what is under the hand, along the line that it goes: thesis, figure 6.5."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from restshape_apps.furniture.guidance.amounts import amount
from restshape_apps.furniture.guidance.range_way import way_of

from restshape.live.shown_marks import Lines, Mark, Meaning

if TYPE_CHECKING:
    from restshape_apps.furniture.guidance.design import DesignDirection
    from restshape_apps.furniture.physics.furniture import Furniture


class RangeMarks:
    """Makes the lines of a valid range; a plank that is moved has the same ones as long as it goes straight on."""

    def __init__(self) -> None:
        self._of: DesignDirection | None = None
        self._lines: list[Mark] = []

    def __call__(
        self, under: DesignDirection | None, t: float, grabbed_at: np.ndarray | None, model: Furniture
    ) -> list[Mark]:
        """The lines of a frame; none where nothing is under the hand, or no ranges are asked for.

        Args:
            under: the hand; t: how far it has gone [m or rad].
            grabbed_at: place (3,) where a plank was taken, through which the line goes; None: through what moves most.
            model: of the design, whose geometry may change.
        """
        if under is None or not under.design.guidance.ranges:
            self._of = None
            return []
        if grabbed_at is None:
            at, speed = way_of(model, under.direction, t)
            origin = at - t * speed
            return [*range_lines(under, origin, speed), _here(under, t, at)]
        plank = int(np.argmax(np.abs(under.direction).max(axis=1)))
        speed = under.design.piece.planks[plank].axes @ under.direction[plank, :3]
        if under is not self._of:
            self._of, self._lines = under, range_lines(under, grabbed_at, speed)
        return [*self._lines, _here(under, t, grabbed_at + t * speed)]


def range_lines(under: DesignDirection, origin: np.ndarray, speed: np.ndarray) -> list[Mark]:
    """The valid parts, those that are not, and doubtful ones, along a line through an origin (3,) at parameter 0."""
    valid = [(float(low), float(high)) for low, high in under.ranges.intervals]
    if not valid:
        nothing = _line("outside the valid range", "limit", [(under.low, under.high)], under, origin, speed)
        return [] if nothing is None else [replace(nothing, words=["nothing valid along this drag"])]
    marks = [
        _line("valid range", "inside", valid, under, origin, speed),
        _line("outside the valid range", "outside", _between(valid, under.low, under.high), under, origin, speed),
        _line("holds in doubt", "uncertain", list(under.doubtful), under, origin, speed),
    ]
    return [mark for mark in marks if mark is not None]


def _line(
    name: str,
    meaning: Meaning,
    parts: list[tuple[float, float]],
    under: DesignDirection,
    origin: np.ndarray,
    speed: np.ndarray,
) -> Lines | None:
    """Parts of a line, each with its ends in words; None where there are none."""
    if not parts:
        return None
    points = origin + np.array(parts).reshape(-1, 1) * speed
    return Lines(name, points, range(0, len(points), 2), meaning, None, [_words(one, under) for one in parts])


def _words(part: tuple[float, float], under: DesignDirection) -> str:
    """From where to where; where the range may go on, that is said."""
    low, high = part
    ends = ((low, low <= under.low), (high, high >= under.high))
    return " to ".join(f"{amount(t, under.unit)}{' or beyond' if goes_on else ''}" for t, goes_on in ends)


def _between(parts: list[tuple[float, float]], low: float, high: float) -> list[tuple[float, float]]:
    """What of a range is in none of its parts, which are in order."""
    ends = [low, *(end for part in parts for end in part), high]
    return [(left, right) for left, right in zip(ends[::2], ends[1::2]) if right > left]


def _here(under: DesignDirection, t: float, at: np.ndarray) -> Lines:
    """The dot of the piece as it is."""
    return Lines("as it is", at[None], (0,), "inside" if under.ranges.holds(t) else "outside", None, [under.name])
