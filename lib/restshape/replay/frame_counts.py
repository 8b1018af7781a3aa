"""What the frames of a replay do, counted: events of PETSc, and calls of kernels."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from restshape import _kernels
from restshape.replay.event_counts import EventCounts

if TYPE_CHECKING:
    from restshape.analysis.row_values import RowValues
    from restshape.replay.loop import Replay

Calls = dict[str, dict[str, list[int]]]
"""By kernel and purpose: calls, and elements in them."""


def difference(more: Calls, less: Calls) -> Calls:
    """Calls and elements less others; what is the same in both is left out."""
    found: Calls = {}
    for name in sorted({*more, *less}):
        for purpose in sorted({*more.get(name, {}), *less.get(name, {})}):
            here, there = (counts.get(name, {}).get(purpose, (0, 0)) for counts in (more, less))
            if tuple(here) != tuple(there):
                found.setdefault(name, {})[purpose] = [here[0] - there[0], here[1] - there[1]]
    return found


@dataclass(frozen=True)
class Counts:
    """What one frame has done.

    Args:
        events: of PETSc, by their names in its log: how often each was.
        calls: of kernels until the answer, by kernel and purpose: how many, and elements in them.
        calls_beside: those of what is measured off the frame's time.
    """

    events: dict[str, int]
    calls: Calls
    calls_beside: Calls


class FrameCounts:
    """Counts what each frame of a replay does.

    Args:
        replay: that has not begun; PETSc's log must have (`begin_log`), and costs a little of each event.

    Attributes:
        last: of the last frame; None before the first.
    """

    def __init__(self, replay: Replay) -> None:
        self._events, self._answered = EventCounts(), _kernels.calls()
        self.last: Counts | None = None
        replay.on_answer = self._on_answer

    def over(self, rows: Iterator[RowValues]) -> Iterator[RowValues]:
        """The rows, and what each has done in `last`: what is done between them is none of it."""
        while True:
            self._events.since_last()
            start = _kernels.calls()
            row = next(rows, None)
            if row is None:
                return
            calls, beside = difference(self._answered, start), difference(_kernels.calls(), self._answered)
            self.last = Counts(self._events.since_last(), calls, beside)
            yield row

    def _on_answer(self) -> None:
        self._answered = _kernels.calls()
