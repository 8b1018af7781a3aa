"""Edit scripts for programs: read, made of events, written down as they are done, and saved."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from math import ceil, isfinite
from pathlib import Path
from typing import Literal

from restshape.errors import UserError, quoted
from restshape.interface.plain import plain
from restshape.interface.saved import save_text
from restshape.scene import edit_script
from restshape.scene.edit_script import FORMAT, VERSION, Header, Script
from restshape.scene.event_line import EventLine
from restshape.scene.model import Scene
from restshape.scene.plain_values import Table
from restshape.scene.source import suggestion
from restshape.shape.script_session import FRAME_TIME

When = Literal["every frame", "on demand"]
PLACE = Path("script")
"""Where messages say that an event is, with its line."""
TICKS = 1e4
"""Edit times in a second at which events begin that have no time of their own."""

_LINE = json.JSONEncoder(allow_nan=False)
_DRAG, _NUMBERS = ["t", "do", "to"], {float}
MOTION = {"line", "t", "do", "to"}
"""What the motion of a hand to a place has, and no other event."""


class WrittenScript:
    """The script of what is done, written as it is done: each event is validated as those of files are.

    Args:
        scene: that is edited.
        analysis: which frames are solved.

    Attributes:
        t: edit time [s] at which the next event begins, where it has no time of its own.
        last_frames: of the last event.

    Raises:
        UserError: the scene moves in time, so that no frame can be left out.
    """

    def __init__(self, scene: Scene, analysis: When = "every frame") -> None:
        self._header = Header(format=FORMAT, version=VERSION, scene=scene.path.name, units="m", analysis=analysis)
        self._reader = edit_script.reader_of(scene, self._header, PLACE)
        self._tables: list[Table] = []
        self.t = 0.0
        self.last_frames = 0
        self._motion: EventLine | None = None

    def add(self, do: str, keys: Mapping[str, object]) -> EventLine:
        """Takes in an event, which begins at `t` unless it says otherwise.

        Args:
            do: what happens; keys: of the event, without those that are None; a key that is a word of Python has the
                name of its field in the event's model, such as `start` for "from".

        Raises:
            UserError: it is not valid, or cannot come now; the script stays as it is.
        """
        if do == "drag" and (motion := self._moved_on(keys)):
            return motion
        number, known = len(self._tables) + 2, self._reader.known
        if do not in known:
            raise UserError(f"there is no event {do!r}", f"{PLACE}: line {number}", suggestion(do, list(known)))
        fields = known[do].model_fields
        table: Table = {"t": self.t, "do": do}
        for key, value in keys.items():
            if value is not None:
                field = fields.get(key)
                table[(field.alias if field else None) or key] = plain(value, f"{PLACE}: line {number}: {key}")
        # No event may begin while the frames of the one before it last.
        return self._take_in(number, table, self.t)

    def _moved_on(self, keys: Mapping[str, object]) -> EventLine | None:
        """The motion of a hand that goes on, as of `moved_on`; None where it says more than a place."""
        to = keys.get("to")
        if not isinstance(to, list):
            return None
        for key, value in keys.items():
            if key != "to" and value is not None:
                return None
        return self.moved_on(to)

    def moved_on(self, to: list[object]) -> EventLine | None:
        """The motion of a hand that goes on from that of the event before to another place, which is all that is new.

        It is for the hand that asks for many frames a second. All else of the event was validated in the one before.

        Args:
            to: the place.

        Returns:
            The event, None where it is to be validated as any other.
        """
        events = self._reader.events
        last = events[-1] if events else None
        if last is None or (last is not self._motion and not _is_motion(last)) or len(to) != len(last.to):  # type: ignore[attr-defined]
            return None
        for one in to:
            if not isinstance(one, float) or not isfinite(one):
                return None
        # NumPy's numbers are of a kind that JSON does not know.
        place, t = [*map(float, to)], self.t  # type: ignore[arg-type]
        event = self._motion = _at_another_place(last, len(events) + 2, t, tuple(place))
        events.append(event)
        self._reader.t, self.last_frames = t, 1
        self._tables.append({"t": t, "do": "drag", "to": place})
        self.t = _end(t, 1)
        return event

    def follow(self, table: Mapping[str, object]) -> EventLine:
        """Takes in an event of another script as it stands there, at its own time.

        Args:
            table: its keys, "t" and "do" among them, in the units of this script.

        Raises:
            UserError: it is not valid, or cannot come now; the script stays as it is.
        """
        number = len(self._tables) + 2
        given = {str(key): plain(value, f"{PLACE}: line {number}: {key}") for key, value in table.items()}
        return self._take_in(number, given, self._reader.events[-1].t if self._reader.events else 0.0)

    def _take_in(self, number: int, table: Table, earliest: float) -> EventLine:
        """The event of a table, validated and written down; the script stays as it is where it is not valid.

        Args:
            number: of its line; table: its keys; earliest: edit time [s] before which it cannot begin.
        """
        grabbed = self._reader.grabbed
        self._reader.check_excess(number, table)
        self._reader.t = earliest
        try:
            event = self._reader.event(number, table)
        except UserError:
            self._reader.grabbed = grabbed
            raise
        self._tables.append(table)
        self.last_frames = event.frame_count
        self.t = _end(event.t, self.last_frames)
        return event

    def cut_last(self, frames: int, path: Sequence[Sequence[float]]) -> bool:
        """Ends the last event after some of its frames.

        Args:
            frames: that were computed, one at least; path: where the hand was in each of them.

        Returns:
            Whether it can end there: an event "idle" and a drag to places can.
        """
        table = self._cut(frames, path)
        if table is None:
            return False
        self._reader.events.pop()
        self._tables.pop()
        grabbed = self._reader.grabbed
        self.follow(table)
        self._reader.grabbed = grabbed
        return True

    def _cut(self, frames: int, path: Sequence[Sequence[float]]) -> Table | None:
        """The keys of the last event if it ended after some of its frames; None where it cannot."""
        last, table = self._reader.events[-1], dict(self._tables[-1])
        if last.do == "idle":
            return table | {"frames": frames}
        if last.do == "drag" and len(path) == frames:
            table = {key: value for key, value in table.items() if key not in ("to", "path", "frames")}
            return table | {"path": [list(place) for place in path]}
        return None

    def cut_line(self, frames: int) -> str:
        """The text of the last event as it would be after some of its frames; empty where it cannot end there."""
        table = self._cut(frames, ())
        return _LINE.encode(table) if table else ""

    def drop_last(self) -> None:
        """The last event has not been carried out."""
        self._tables.pop()
        events = self._reader.events
        events.pop()
        self.last_frames = events[-1].frame_count if events else 0

    @property
    def count(self) -> int:
        """Events so far."""
        return len(self._tables)

    def last_line(self) -> str:
        """The text of the last event, without the end of its line."""
        return _line_of(self._tables[-1])

    @property
    def largest_gesture(self) -> int:
        """The largest number of a gesture of several edits; 0: there is none."""
        return max((event.gesture for event in self._reader.events if event.gesture), default=0)

    def annotate(self, note: str) -> None:
        """Puts a note for readers into the header."""
        self._header = self._header.model_copy(update={"note": note})

    def header_line(self) -> str:
        """The text of the first line, without its end."""
        return _LINE.encode(self._header.model_dump(exclude_defaults=True))

    def text(self) -> str:
        """The text of the script so far."""
        lines = [self._header.model_dump(exclude_defaults=True), *self._tables]
        return "".join(f"{_LINE.encode(line)}\n" for line in lines)

    def script(self) -> Script:
        """The script so far."""
        text = self.text()
        return Script(self._header, tuple(self._reader.events), warnings=tuple(self._reader.odd), text=text)


def _is_motion(event: EventLine) -> bool:
    """Whether an event is the motion of a hand to a place alone; applications have events of their own by this name."""
    return event.do == "drag" and event.model_fields_set == MOTION and getattr(event, "to", None) is not None


def _at_another_place(last: EventLine, line: int, t: float, to: tuple[float, ...]) -> EventLine:
    """A drag as another one, which is valid, but for its line, time and place.

    It is what `model_copy` makes of it with an update, which would look at each field first.
    """
    event = type(last).__new__(type(last))
    put = object.__setattr__
    put(event, "__dict__", last.__dict__ | {"line": line, "t": t, "to": to})
    for name in ("__pydantic_fields_set__", "__pydantic_extra__", "__pydantic_private__"):
        put(event, name, getattr(last, name))
    return event


def _line_of(table: Table) -> str:
    """The text of an event, without the end of its line."""
    if [*table] == _DRAG:
        t, do, to = table.values()
        if do == "drag" and type(t) is float and type(to) is list and {*map(type, to)} == _NUMBERS:
            # The same as the encoder writes, which finds out first what there is.
            return f'{{"t": {t!r}, "do": "drag", "to": [{", ".join(map(repr, to))}]}}'
    return _LINE.encode(table)


def _end(t: float, frames: int) -> float:
    """Edit time [s] at which the next event may begin, after one at `t` of so many frames."""
    # A whole number of ticks, and never so few that the frames of the event would have to come closer.
    return ceil((t + frames * FRAME_TIME) * TICKS + 0.01) / TICKS


def load_script(path: str | Path, scene: Scene | None = None) -> Script:
    """The edit script of a JSON Lines file, validated.

    Args:
        path: the file; scene: that it will be replayed on, whose names are checked; None: any.

    Raises:
        UserError: naming file, line and key of what is wrong, and what to do.
    """
    return edit_script.load_script(path, scene)


def refuse_names(value: object, reader: str) -> None:
    """Refuses the name of a file where what is in it is wanted.

    Args:
        value: a scene or a script; reader: what reads one of a file, such as ``load``.

    Raises:
        UserError: it is a text or a path.
    """
    if isinstance(value, str | Path):
        what = f"{quoted(str(value))} is the name of a file"
        raise UserError(what, do=f"give what is in it: restshape.{reader}({str(value)!r})")


def new_script(scene: Scene, events: Iterable[Mapping[str, object]], analysis: When = "every frame") -> Script:
    """An edit script of events, validated for a scene as one of a file is.

    Args:
        scene: that it edits.
        events: in order, the keys of each: "do" and what the event has; one without "t" begins as soon as the frames of
            the one before it are over. Lengths without a unit are in metres.
        analysis: which frames are solved: "every frame", or "on demand" those of events `analyse`.

    Raises:
        UserError: naming the line that the event would be, and the key of what is wrong.
    """
    refuse_names(scene, "load")
    written = WrittenScript(scene, analysis)
    for event in events:
        written.add(str(event.get("do", "")), {key: value for key, value in event.items() if key != "do"})
    return written.script()


def save_script(script: Script, path: str | Path, force: bool = False) -> None:
    """Writes an edit script that `load_script` and `restshape replay` read.

    Args:
        script: `Simulation.script`, or one that `load_script` or `new_script` gave.
        path: of the file, ending in .jsonl; force: replace a file that is there.

    Raises:
        UserError: there is a file already, or it cannot be written.
    """
    if script.path is not None and not script.text:
        raise UserError("this script holds no text", str(script.path), "load it again")
    save_text(Path(path), script.text, force)
