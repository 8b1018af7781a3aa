"""What a page sees of a frame, kept so that it can be shown again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from restshape.arrays import AnyArray
from restshape.live.frame_arrays import PicturePart
from restshape.live.shown_marks import Mark

KEPT_BYTES = 256 << 20
"""Bytes of frames that are kept."""
HEADER_BYTES = 8_192
"""Of a frame besides its arrays, about."""


@dataclass(eq=False, slots=True)
class Moment:
    """A frame; nobody changes one that was sent.

    Args:
        header: of its message, without `id`; parts: of its picture; marks: at the hand.
        t: edit time [s].
    """

    header: dict[str, object]
    parts: Sequence[PicturePart]
    marks: Sequence[Mark]
    t: float

    @property
    def number(self) -> int:
        """Of the frame."""
        return int(str(self.header["number"]))


class KeptMoments:
    """Frames that have been shown; of too many the first ones are forgotten.

    Args:
        most: bytes of their arrays, of which those that frames share count once, and of their headers.
    """

    def __init__(self, most: int = KEPT_BYTES) -> None:
        self._most, self._bytes = most, 0
        self._kept: dict[int, Moment] = {}
        self._uses: dict[int, int] = {}

    def add(self, moment: Moment) -> None:
        """Keeps a frame."""
        if moment.number in self._kept:
            self._forget(moment.number)
        self._kept[moment.number] = moment
        self._bytes += HEADER_BYTES
        for array in _arrays_of(moment):
            uses = self._uses.get(id(array), 0)
            self._uses[id(array)] = uses + 1
            self._bytes += 0 if uses else array.nbytes
        while self._bytes > self._most and len(self._kept) > 1:
            self._forget(next(iter(self._kept)))

    def _forget(self, number: int) -> None:
        self._bytes -= HEADER_BYTES
        for array in _arrays_of(self._kept.pop(number)):
            self._uses[id(array)] -= 1
            if not self._uses[id(array)]:
                del self._uses[id(array)]
                self._bytes -= array.nbytes

    def get(self, number: int) -> Moment | None:
        """A frame; None where it is not kept."""
        return self._kept.get(number)


def _arrays_of(moment: Moment) -> list[AnyArray]:
    """The arrays of the parts of a frame, and of its marks."""
    found = [array for part in moment.parts for array in part.arrays.values()]
    return found + [value for mark in moment.marks for value in vars(mark).values() if isinstance(value, np.ndarray)]
