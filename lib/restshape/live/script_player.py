"""Plays a script in a live session: frame by frame, forth and back, until the hand takes over."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from restshape.interface.simulation import Predict
from restshape.live.live_simulation import LiveSimulation, Progress
from restshape.live.moment import KeptMoments, Moment
from restshape.live.played_events import PlayedEvent

Watch = Callable[[], bool]
"""Whether something else is to be done first."""


class ScriptPlayer:
    """Shows the frames of a script; those that were shown are kept.

    Args:
        live: at the script's beginning; events: of the script.
        moment: gives what a page sees of the last frame.

    Attributes:
        at: number of the frame that is shown, which who shows it sets; frames: of the script.
    """

    def __init__(self, live: LiveSimulation, events: Sequence[PlayedEvent], moment: Callable[[], Moment]) -> None:
        self._live, self._events, self._moment = live, events, moment
        self._next = 0
        self._kept = KeptMoments()
        self.at, self.frames = 0, 1 + sum(event.frames for event in events)
        self._keep()

    @property
    def computed(self) -> int:
        """Number of the last frame that was computed."""
        return self._live.sim.frame.index

    def kept(self, number: int) -> Moment | None:
        """What a page sees of a frame, where that is known."""
        return self._kept.get(number)

    def _keep(self) -> Moment:
        found = self._moment()
        self._kept.add(found)
        return found

    def forget(self) -> None:
        """Frames are shown otherwise from now on: those that were kept are made again when they are asked for."""
        self._kept = KeptMoments()
        self._keep()

    def advance(self) -> bool:
        """Computes the next frame; False where the script is over."""
        live = self._live
        while not live.go_on():
            if self._next == len(self._events):
                return False
            event = self._events[self._next]
            self._next += 1
            live.begin_of_script(event.table, event.room)
        return True

    def show(self, number: int, progress: Progress, interrupted: Watch) -> Moment:
        """What a page sees of a frame, or of one before it where something else is to be done first.

        Args:
            number: of the frame; beyond the last one it is that.
                progress: takes how far it is; interrupted: asked after each frame.
        """
        kept = self._kept.get(number)
        if kept is None and number <= self.computed:
            if number == self.computed:
                kept = self._keep()
            else:
                self._live.reopen((), self._live.predict)
                self._next = 0
                first = self._keep()
                kept = first if number == 0 else None
        while kept is None:
            progress(self.computed, number)
            if not self.advance():
                self.frames = self.computed + 1
                kept = self._kept.get(self.computed) or self._keep()
                break
            # Those on the way are kept, too, so that they can be gone back to.
            made = self._keep()
            kept = made if self.computed >= number or interrupted() else None
        return kept

    def take(self, progress: Progress) -> None:
        """Lets the hand go on from the frame that is shown: frames after it are gone.

        An event that cannot end there is carried out to its end.

        Args:
            progress: takes how far it is, where frames have to be computed again.
        """
        live = self._live
        if self.at != self.computed:
            at = self.at
            live.reopen((), live.predict)
            self._next = 0
            while self.computed < at and self.advance():
                progress(self.computed, at)
        if not live.stop():
            while live.go_on():
                pass

    def predict(self, how: Predict) -> None:
        """Frames are predicted so from now on, and computed again."""
        self._live.reopen((), how)
        self._next, self._kept = 0, KeptMoments()
        self._keep()
