"""What sessions of all kinds share: when the frames of a script are, and what can be undone."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Generic, TypedDict, TypeVar

import numpy as np

from restshape.application import Application
from restshape.application import application as application_named
from restshape.errors import Refusal, UserError
from restshape.scene.edit_script import Script
from restshape.scene.event_line import Analyse, EventLine, Idle, Redo, Undo
from restshape.scene.model import Scene
from restshape.scene.source import split_key
from restshape.shape.hand.gesture import Gesture
from restshape.shape.script_frame import ScriptFrame

FRAME_TIME = 1.0 / 60.0
"""Edit time of a frame [s] where the script leaves room for it."""

UNDO_STEPS = 100
"""Edit steps that can be undone; older ones are forgotten, so that memory does not grow with the script."""

FIXED = ("format", "version", "app", "shape", "quantities", "solve", "predict")
"""Tables and keys of a scene that hold for a whole session."""

LIMITS = {"min": None, "max": None}
"""Values of quantities that follow parameters in a session: nothing is made for them."""
STILL = (0.0, 0.0)
Edited = TypeVar("Edited")
State = tuple[Edited, Scene]
"""What an undo brings back: what is edited, and the scene."""


@dataclass(slots=True)
class Step:
    """What one frame of an event did, before it gets its number and time."""

    change: str
    refused: str | None = None
    note: str = ""
    gesture: Gesture | None = None
    c: tuple[float, float] = STILL


class GrabbedStep(TypedDict, total=False):
    """Gesture and coefficients of a `Step` in which nothing moves; empty where the hand holds none."""

    gesture: Gesture
    c: tuple[float, float]


class ScriptSession(ABC, Generic[Edited]):
    """Replays a script's events: each kind of them is carried out by the method of its name.

    Args:
        scene: where the session starts.
        script: validated events.
        application: whose effects the scene may name; default: the scene's own.
    """

    def __init__(self, scene: Scene, script: Script, application: Application | None) -> None:
        self.scene, self._script = scene, script
        self._application = application or application_named(scene.app)
        self._past: tuple[State[Edited], ...] = ()
        self._future: tuple[State[Edited], ...] = ()
        self._gesture: int | None = None
        self._begun: tuple[int | None, tuple[State[Edited], ...]] = None, ()
        self._index = 0

    def frames(self) -> Iterator[ScriptFrame]:
        """All frames, one after the other; the first shows what there is before any event."""
        yield self.first()
        events = self._script.events
        for event, after in zip(events, (*events[1:], None)):
            yield from self.frames_of(event, np.inf if after is None else after.t - event.t)

    def first(self) -> ScriptFrame:
        """The frame that shows what there is before any event."""
        self._index = 0
        return self._frame((0, 0.0, 0, "start"), self._first_step(), True, False)

    def frames_of(self, event: EventLine, room: float = np.inf) -> Iterator[ScriptFrame]:
        """The frames of an event, which follow those of the events before it.

        Args:
            event: of the script, or one that comes as it is done.
            room: edit time [s] from its beginning to that of the next event.
        """
        analysed = self._script.header.analysis == "every frame" or event.do == "analyse"
        count = event.frame_count
        pace = min(FRAME_TIME, room / count)
        for i, step in enumerate(self.steps(event)):
            self._index += 1
            when = (self._index, event.t + i * pace, event.line, event.do)
            yield self._frame(when, step, analysed, i == count - 1)

    def steps(self, event: EventLine) -> Iterator[Step]:
        """What each frame of one event does; the session follows as the steps are taken."""
        steps, self._gesture = self._carried_out(event), event.gesture
        while True:
            self._mark()
            step = next(steps, None)
            if step is None:
                return
            yield step

    def _carried_out(self, event: EventLine) -> Iterator[Step]:
        found: Iterator[Step] = getattr(self, f"_do_{event.do}")(event)
        return found

    def _first_step(self) -> Step:
        """What there is before any event."""
        return Step("start")

    @abstractmethod
    def _frame(self, when: tuple[int, float, int, str], step: Step, analysed: bool, last: bool) -> ScriptFrame:
        """The frame of a step, the last one of its event or not; `when` is its index, time, line and event."""

    @abstractmethod
    def _mark(self) -> None:
        """Note the state that `rollback` restores."""

    @abstractmethod
    def _state(self) -> State[Edited]:
        """What an undo brings back."""

    @abstractmethod
    def _go_to(self, then: State[Edited], kind: str) -> Step:
        """Bring a state back, by "undo" or "redo"."""

    def _do_idle(self, event: Idle) -> Iterator[Step]:
        for _ in range(event.frames):
            yield Step("none", **self._grabbed())

    def _do_analyse(self, event: Analyse) -> Iterator[Step]:
        yield Step("none", **self._grabbed())

    def _do_undo(self, event: Undo) -> Iterator[Step]:
        if not self._past:
            yield Step("none", "there is nothing to undo")
            return
        *past, then = self._past
        self._past, self._future = tuple(past), (*self._future, self._state())
        yield self._go_to(then, "undo")

    def _do_redo(self, event: Redo) -> Iterator[Step]:
        if not self._future:
            yield Step("none", "there is nothing to redo")
            return
        *future, then = self._future
        self._past, self._future = (*self._past, self._state()), tuple(future)
        yield self._go_to(then, "redo")

    def _remember(self, before: State[Edited]) -> None:
        """End an edit step: it can be undone from now on, if it changed anything."""
        if all(old is new for old, new in zip(before, self._state())):
            return
        gesture, past = self._begun
        # What was undone, or rolled back, since then has left another past.
        goes_on = gesture is not None and gesture == self._gesture and past is self._past
        self._past, self._future = self._past if goes_on else (*self._past, before)[-UNDO_STEPS:], ()
        self._begun = self._gesture, self._past

    def _grabbed(self) -> GrabbedStep:
        """The gesture and coefficients of a frame in which nothing moves."""
        return {}

    def _refusal(self, why: str | UserError) -> Step:
        if isinstance(why, UserError):
            what = f"{why.where}: {why.what}" if why.where else why.what
            why = Refusal(f"{what} ({why.do})" if why.do else what, what, why.do)
        return Step("none", why, **self._grabbed())

    def _refused(self, frames: int, why: str | UserError) -> Iterator[Step]:
        """All frames of an event that cannot be carried out."""
        for _ in range(frames):
            yield self._refusal(why)

    def _refuse_fixed(self, key: str) -> None:
        """Refuses a key of the scene that cannot be set.

        Raises:
            UserError: it holds for the whole session.
        """
        if next(iter(split_key(key)), "") in FIXED:
            raise UserError(f"{key} cannot be set during an edit", do="change the scene, or use --set")

    def _refuse_fixed_changes(self, before: Scene) -> None:
        """Refuses a parameter that changes, besides, what holds for the whole session.

        Raises:
            UserError: it has changed such a table since a scene before.
        """
        for key in FIXED:
            was, now = _but_limits(before, key), _but_limits(self.scene, key)
            if key == "shape" or was == now:
                continue
            if isinstance(was, dict) and isinstance(now, dict):
                named = next((name for name in now if now[name] != was.get(name)), "")
                key = f"{key}.{named}".rstrip(".")
            what = f"this changes {key} as well, which cannot be set during an edit"
            raise UserError(what, do=f"write numbers in {key}, change the scene, or use --set")


def _but_limits(scene: Scene, key: str) -> object:
    """What a scene holds at a key, of quantities all but their limits."""
    if key != "quantities":
        return getattr(scene, key)
    return {name: one.model_copy(update=LIMITS) for name, one in scene.quantities.items()}
