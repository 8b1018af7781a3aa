"""Some frames of a script alone are solved for; the others are followed, without a solution."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from dataclasses import replace
from itertools import islice
from typing import TYPE_CHECKING, Self

from restshape.errors import UserError

if TYPE_CHECKING:
    from restshape.shape.script_frame import ScriptFrame

MOVING = ("move", "shape", "values", "mesh")
"""Changes after which the solution is another one."""


class ChosenFrames:
    """The frames that a replay solves for; it ends with the last of them.

    Args:
        wanted: says by its index whether a frame is solved for.
        last: index of the last frame that is wanted.
        leap: frames that are not solved for are left out, and the next one restarts: for replays that keep nothing.

    Attributes:
        refused: indices of the frames whose edits the session itself refused.
    """

    def __init__(self, wanted: Callable[[int], bool], last: int, leap: bool = False) -> None:
        self.wanted, self.last, self.leap = wanted, last, leap
        self.refused: set[int] = set()

    @classmethod
    def of(cls, indices: Collection[int]) -> Self:
        """These frames, and the first one.

        Raises:
            UserError: there is none, or an index is below 0.
        """
        if not indices or min(indices) < 0:
            raise UserError("no frames are chosen", do="only=[0, 20, 40] solves for these, by their index from 0")
        return cls({0, *indices}.__contains__, max(indices))

    def among(self, frames: Iterator[ScriptFrame]) -> Iterator[ScriptFrame]:
        """The frames as a replay is to see them."""
        moved = False
        for frame in islice(frames, self.last + 1):
            if frame.refused is not None:
                self.refused.add(frame.index)
            if self.wanted(frame.index):
                yield replace(frame, change="shape") if moved and frame.refused is None else frame
                moved = False
            elif self.leap:
                moved = moved or frame.change in MOVING
            else:
                yield replace(frame, analysed=False)
