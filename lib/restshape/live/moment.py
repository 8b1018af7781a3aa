"""What a page sees of a frame, kept so that it can be shown again."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass

from restshape.arrays import AnyArray
from restshape.live.frame_arrays import PicturePart
from restshape.live.shown_marks import Mark

KEPT_BYTES = 256 << 20
"""Bytes of arrays of frames that are kept."""


@dataclass(frozen=True, eq=False)
class Moment:
    """A frame.

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
        most: bytes of their arrays.
    """

    def __init__(self, most: int = KEPT_BYTES) -> None:
        self._most, self._bytes = most, 0
        self._kept: OrderedDict[int, tuple[Moment, int]] = OrderedDict()
        self._arrays: dict[int, int] = {}

    def add(self, moment: Moment) -> None:
        """Keeps a frame."""
        if moment.number in self._kept:
            self._forget(moment.number)
        size = 0
        for array in _arrays_of(moment):
            if self._arrays.get(id(array), 0) == 0:
                size += array.nbytes
            self._arrays[id(array)] = self._arrays.get(id(array), 0) + 1
        self._kept[moment.number] = moment, size
        self._bytes += size
        while self._bytes > self._most and len(self._kept) > 1:
            self._forget(next(iter(self._kept)))

    def _forget(self, number: int) -> None:
        moment, size = self._kept.pop(number)
        self._bytes -= size
        for array in _arrays_of(moment):
            self._arrays[id(array)] -= 1
            if not self._arrays[id(array)]:
                del self._arrays[id(array)]

    def get(self, number: int) -> Moment | None:
        """A frame; None where it is not kept."""
        found = self._kept.get(number)
        return None if found is None else found[0]

    def drop_after(self, number: int) -> None:
        """Forgets frames after one."""
        for later in [one for one in self._kept if one > number]:
            self._forget(later)


def _arrays_of(moment: Moment) -> list[AnyArray]:
    """The arrays of the parts of a frame."""
    return [array for part in moment.parts for array in part.arrays.values()]
