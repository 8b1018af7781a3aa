"""The simulation of a live session: events frame by frame, and all of them again, to the same state."""

# More than 15 modules: what opens, drives and records a simulation meets here.

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from restshape.application import application_of
from restshape.interface.simulation import Predict, Simulation
from restshape.live.frame_picture import FramePicture

if TYPE_CHECKING:
    from collections.abc import Iterator

    from restshape.calibration import Calibration
    from restshape.interface.shown_frame import ShownFrame
    from restshape.replay.recording.recorder import Recorder
    from restshape.scene.model import Scene

Event = Mapping[str, Any]
Progress = Callable[[int, int], None]
"""Takes events done, and events to do."""
GRABBING = ("press", "pull")
LATE = 16
"""Events before the last one at most after which marks are made as all is done again."""
LONG_REST = 1_000_000
"""Frames of an idle event that is to be ended early."""


def quiet(done: int, of: int) -> None:
    """Says nothing of progress."""


@dataclass
class CurrentEvent:
    """An event that is being carried out.

    Args:
        event: its keys; frames: that are left of it.
        count: frames so far; path: where the hand was in each.
        refused: why the first refused frame was.
    """

    event: Event
    frames: Iterator[ShownFrame]
    count: int
    path: list[tuple[float, ...]]
    refused: str = ""


@dataclass(frozen=True)
class SolvedBy:
    """How a scene is simulated.

    Args:
        policy, guess: what is reused from frame to frame, and where solves start; None: as the scene says.
        calibration: seconds a unit of counted work; None: the nominal ones.
        petsc: words for PETSc's options database.
    """

    policy: str | None = None
    guess: str | None = None
    calibration: Calibration | None = None
    petsc: tuple[str, ...] = ()

    def options(self, predict: Predict) -> str:
        """Options with which `restshape replay` gives the same frames, where they are predicted so; empty: none."""
        given = {"predict": predict if predict != "none" else None, "policy": self.policy, "guess": self.guess}
        return " ".join(f"--{name} {value}" for name, value in given.items() if value is not None)


USUAL = SolvedBy()


class LiveSimulation:
    """A simulation whose events come one after the other, each carried out a frame at a time.

    Args:
        scene: where it starts.
        manner: how it is simulated.
        predict: how frames of drags are predicted.

    Attributes:
        application: of the scene.
        sim: what carries out the events; picture: of its last frame.
        hand: what it holds, "on", and where it is, "at"; None: it holds nothing.
        step: the event that is being carried out; None: there is none.
        lines: of the script, which have come since somebody took them.
        missed: the last event was to take hold of something, and was refused: scripts let go of that, too.
        recorder: takes the frames; None: they are not recorded.
        shared: other ranks follow, which nobody ends in the middle of a frame.
    """

    shared = False

    def __init__(self, scene: Scene, manner: SolvedBy = USUAL, predict: Predict = "none") -> None:
        self._scene, self._manner = scene, manner
        self.application = application_of(scene)
        self.predict = predict
        self.hand: dict[str, object] | None = None
        self.step: CurrentEvent | None = None
        self.lines: list[str] = []
        self.missed = False
        self.recorder: Recorder | None = None
        self.sim = self._opened(predict)
        self.picture = FramePicture(self.sim)

    def _opened(self, predict: Predict) -> Simulation:
        given = vars(self._manner) | {"predict": predict, "strict": False, "recorder": self.recorder}
        sim = Simulation(self._scene, **given)
        if options := self._manner.options(predict):
            sim.written.annotate(f"recorded live with {options}")
        return sim

    @property
    def scene(self) -> Scene:
        """The scene with the values that hold now."""
        return self.sim.scene

    @property
    def options(self) -> str:
        """Options with which `restshape replay` of the script gives the same frames; empty: none."""
        return self._manner.options(self.predict)

    @property
    def settled(self) -> bool:
        """Whether the last frame has come to rest, as all have that do not say that they have not."""
        row = self.sim.frame.row
        return row.get("converged", 1) != 0 or bool(row["refused"])

    def begin(self, event: Event) -> None:
        """Begins an event, of which `go_on` computes the frames.

        Raises:
            UserError: it is not valid, or cannot come now: nothing has happened.
        """
        to = event.get("to")
        if len(event) == 2 and event.get("do") == "drag" and isinstance(to, list):
            self.step = CurrentEvent(event, self.sim.moving(to), 0, [])
            return
        do, keys = str(event.get("do", "")), {key: value for key, value in event.items() if key != "do"}
        self.step = CurrentEvent(event, self.sim.each(do, **keys), 0, [])

    def begin_of_script(self, event: Event, room: float) -> None:
        """Begins an event of another script, at its own time; errors as of `begin`.

        Args:
            event: its keys; room: edit time [s] that it has to the next one.
        """
        self.step = CurrentEvent(event, self.sim.follow(event, room), 0, [])

    def rest(self) -> None:
        """Begins an event in which nothing happens, for as many frames as are asked for."""
        self.begin({"do": "idle", "frames": LONG_REST})

    def go_on(self) -> bool:
        """Computes the next frame of the event; False where there was none left, and the event has ended."""
        step = self.step
        if step is None:
            return False
        try:
            frame = next(step.frames, None)
        except BaseException:
            # The script does not have it.
            self.step = None
            raise
        if frame is None:
            self._end(step)
            return False
        step.count += 1
        step.refused = step.refused or frame.refused
        self._follow_hand(step, frame)
        return True

    def finish(self) -> None:
        """Ends the event if the frame was its last one."""
        step = self.step
        if step is not None and step.count >= self.sim.written.last_frames:
            self.go_on()

    def stop(self) -> bool:
        """Ends the event after the frames so far; False where it cannot end there: its frames go on."""
        step = self.step
        if step is None:
            return True
        if not step.count or not self.sim.stop(step.count, step.path):
            return False
        self._end(step)
        return True

    def rest_so_far(self) -> str:
        """The line of the event in which nothing happens, as if it ended now; empty where there is none."""
        step = self.step
        if step is None or step.event.get("do") != "idle" or not step.count:
            return ""
        return self.sim.written.cut_line(step.count)

    def _end(self, step: CurrentEvent) -> None:
        """Write down the event, which has been carried out."""
        self.step = None
        self.lines.append(self.sim.written.last_line())
        self.missed = step.event.get("do") in GRABBING and bool(step.refused)

    def _follow_hand(self, step: CurrentEvent, frame: ShownFrame) -> None:
        """Take note of what the hand holds after a frame."""
        do, cursor = step.event.get("do"), self.sim.replay.session.cursor
        if do in GRABBING and not frame.refused:
            self.hand = {"on": step.event.get("on"), "at": None}
        elif do == "release":
            self.hand = None
        if cursor is not None and self.hand is not None:
            self.hand = self.hand | {"at": list(cursor)}
            step.path.append(cursor)

    def take_lines(self) -> list[str]:
        """The lines that have come."""
        taken, self.lines = self.lines, []
        return taken

    def all_lines(self) -> list[str]:
        """The lines of all events that have ended."""
        lines = self.sim.written.text().splitlines()[1:]
        return lines[: len(lines) - (self.step is not None)]

    def reopen(self, lines: Sequence[str], predict: Predict, progress: Progress = quiet) -> None:
        """Begins again, and carries out the events of lines.

        Args:
            lines: of scripts in metres; predict: how frames are predicted.
            progress: takes how far it is.

        Raises:
            UserError: frames of this scene cannot be predicted so; all stays as it was.
        """
        sim = self._opened(predict)
        self.sim.abandon()
        self.sim, self.predict, self.step, self.hand = sim, predict, None, None
        for number, line in enumerate(lines):
            progress(number, len(lines))
            self.again(json.loads(line))
            if number + LATE >= len(lines):
                # A frame that was refused shows the marks of the answer before.
                self.application.marked(sim)
        self.lines = []
        self.picture.follow(self.sim)

    def again(self, event: Event) -> None:
        """Carries out an event of before, at its time."""
        self.begin_of_script(event, float("inf"))
        while self.go_on():
            pass

    def rates(self, of: str) -> dict[str, list[float]]:
        """How each quantity changes with an entity, or with a number of the scene.

        Raises:
            UserError: there is no derivative.
        """
        return {name: rate.reshape(-1).tolist() for name, rate in self.sim.frame.derivative(of).items()}

    def close(self) -> None:
        """Ends it."""
        self.stop()
        self.sim.close()
