"""The simulation of a live session: events as they come, its script in a file that grows, and its picture."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from restshape.interface.simulation import Predict, Simulation
from restshape.live.frame_picture import FramePicture
from restshape.outputs.growing_text import GrowingText

if TYPE_CHECKING:
    from restshape.interface.shown_frame import ShownFrame
    from restshape.scene.model import Scene

Event = Mapping[str, Any]
GRABBING = ("press", "pull")


class LiveSimulation:
    """A simulation that can be opened again at any time, in the same state.

    Args:
        scene: where it starts.
        policy: what is reused from frame to frame; None: as the scene says.
        out: where the script is written as it grows; None: nowhere.

    Attributes:
        sim: what carries out the events; picture: of its last frame.
        hand: what it holds, "on", and where it is, "at"; None: it holds nothing.
    """

    def __init__(self, scene: Scene, policy: str | None = None, out: Path | None = None) -> None:
        self._scene, self._policy, self._out = scene, policy, out
        self.predict: Predict = "none"
        self.hand: dict[str, object] | None = None
        self.sim = self._opened()
        self.picture = FramePicture(self.sim.replay)
        self._file = GrowingText(out, self.sim.written.text()) if out else None

    def _opened(self) -> Simulation:
        return Simulation(self._scene, policy=self._policy, predict=self.predict, strict=False)

    @property
    def scene(self) -> Scene:
        """The scene with the values that hold now."""
        return self.sim.scene

    def do(self, event: Event) -> Iterator[ShownFrame]:
        """Carries out an event; each of its frames as soon as it is computed.

        A hand that could not take hold of anything lets go at once, in a frame of its own.

        Raises:
            UserError: the event is not valid, or cannot come now: nothing has happened.
        """
        keys = {key: value for key, value in event.items() if key != "do"}
        do = str(event.get("do", ""))
        refused = ""
        for frame in self.sim.each(do, **keys):
            refused = refused or frame.refused
            self._follow_hand(do, event, frame)
            yield frame
        self._write()
        if do in GRABBING and refused:
            yield from self.do({"do": "release"})

    def _follow_hand(self, do: str, event: Event, frame: ShownFrame) -> None:
        """Take note of what the hand holds after a frame."""
        if do in GRABBING and not frame.refused:
            self.hand = {"on": event.get("on"), "at": event.get("at")}
        elif do == "release":
            self.hand = None
        elif do == "drag" and self.hand is not None and isinstance(event.get("to"), list):
            self.hand = self.hand | {"at": event["to"]}

    def _write(self) -> None:
        """Write down the last event."""
        if self._file is not None:
            self._file.add(self.sim.written.last_line())

    def reopen(self, predict: Predict, progress: Callable[[int, int], None]) -> None:
        """Begins again, with all that was done, so that frames are predicted in another way from the start.

        Args:
            predict: how; progress: takes frames done and frames to do.

        Raises:
            UserError: frames of this scene cannot be predicted so; all stays as it was.
        """
        before, old, events = self.predict, self.sim, self.events
        try:
            self.predict = predict
            self.sim = self._opened()
        except BaseException:
            self.predict = before
            raise
        old.close()
        self.redo(events, progress)
        field = self.picture.field
        self.picture = FramePicture(self.sim.replay)
        self.picture.field = field if field in self.picture.choice.looks else self.picture.field

    @property
    def events(self) -> list[Event]:
        """All that was done."""
        return [json.loads(line) for line in self.sim.written.text().splitlines()[1:]]

    def redo(self, events: list[Event], progress: Callable[[int, int], None]) -> None:
        """Carries out events of before."""
        for number, event in enumerate(events):
            progress(number, len(events))
            for frame in self.sim.each(str(event["do"]), **{k: v for k, v in event.items() if k != "do"}):
                self._follow_hand(str(event["do"]), event, frame)

    def close(self) -> None:
        """Ends it; the script is whole."""
        self.sim.close()
        if self._file is not None:
            self._file.close()
