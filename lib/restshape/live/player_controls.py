"""Play, pause, step, scrub and take over: what a page does with a script, or a recording, that is played."""

from __future__ import annotations

from dataclasses import dataclass
from time import monotonic
from typing import TYPE_CHECKING, Protocol

from restshape.live import messages as page

if TYPE_CHECKING:
    from restshape.interface.simulation import Predict
    from restshape.live.live_simulation import Progress
    from restshape.live.moment import Moment
    from restshape.live.script_player import Watch


class Player(Protocol):
    """What shows frames of an edit that was made before.

    Attributes:
        at: number of the frame that is shown, which who shows it sets; frames: how many there are.
    """

    at: int
    frames: int

    def show(self, number: int, progress: Progress, interrupted: Watch) -> Moment:
        """What a page sees of a frame, or of the nearest one that there is."""

    def take(self, progress: Progress) -> None:
        """Lets the hand go on from the frame that is shown."""

    def predict(self, how: Predict) -> None:
        """Frames are predicted so from now on."""

    def forget(self) -> None:
        """Frames are shown otherwise from now on."""


class Shower(Protocol):
    """What shows frames to a page."""

    def send(self, moment: Moment) -> None: ...
    def say(self, message: dict[str, object]) -> None: ...
    def progress(self, what: str) -> Progress: ...
    def waits(self) -> bool: ...
    def take_over(self) -> None: ...


@dataclass(frozen=True)
class Pace:
    """When frames are due.

    Args:
        speed: over that of edit time; start: when it began [s]; t: edit time that was shown then [s].
    """

    speed: float
    start: float
    t: float

    def due(self, t: float) -> float:
        """Seconds until an edit time is."""
        return max(0.0, self.start + (t - self.t) / self.speed - monotonic())


class PlayerControls:
    """Answers the page's messages on a player.

    Args:
        player: that shows frames; shower: who sends them to the page; text: of the script.
        t: edit time of the first frame [s].
    """

    def __init__(self, player: Player, shower: Shower, text: str, t: float = 0.0) -> None:
        self.player, self._shower, self.text = player, shower, text
        self._pace: Pace | None = None
        self._next: Moment | None = None
        self._t = t

    @property
    def playing(self) -> bool:
        """Whether it goes on by itself."""
        return self._pace is not None

    @property
    def frames(self) -> int:
        """How many there are."""
        return self.player.frames

    def answer(self, message: page.Message) -> None:
        """Does what a message asks for."""
        match message:
            case page.PlayMessage():
                self._play(message.speed or 1.0)
            case page.PauseMessage():
                self._pause()
            case page.SeekMessage():
                self._pause()
                self._seek(message.frame)
            case page.TakeMessage():
                self._pause()
                self.player.take(self._shower.progress("frames are computed again"))
                self._shower.take_over()
                return
            case _:
                return
        self._say()
        self._shower.say({"type": "done", "id": message.id})

    def _play(self, speed: float) -> None:
        if self.player.at >= self.player.frames - 1:
            self._seek(0)
        self._pace, self._next = Pace(speed, monotonic(), self._t), None

    def _pause(self) -> None:
        self._pace = self._next = None

    def _seek(self, frame: int) -> None:
        progress = self._shower.progress("frames on the way are computed")
        self._show(self.player.show(min(frame, self.player.frames - 1), progress, self._shower.waits))

    def _show(self, moment: Moment) -> None:
        self.player.at, self._t = moment.number, moment.t
        self._shower.send(moment)

    def show_again(self, changed: bool) -> None:
        """Shows the frame again, where it may look otherwise.

        Args:
            changed: all frames do.
        """
        if changed:
            self.player.forget()
        self._seek(self.player.at)

    def predict(self, how: Predict) -> None:
        """Frames are predicted so from now on."""
        self.player.predict(how)

    def go_on(self) -> float:
        """Shows the next frame, if it is due; seconds that are left until one is."""
        pace = self._pace
        if pace is None:
            return 0.0
        if self._next is None:
            if self.player.at >= self.player.frames - 1:
                self._pause()
                self._say()
                return 0.0
            self._next = self.player.show(self.player.at + 1, lambda done, of: None, lambda: False)
        left = pace.due(self._next.t)
        if left == 0.0:
            moment, self._next = self._next, None
            self._show(moment)
            self._say()
        return left

    def _say(self) -> None:
        player = self.player
        said = {"playing": self.playing, "frame": player.at, "frames": player.frames}
        self._shower.say({"type": "player", **said})
