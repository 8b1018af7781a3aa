"""Edit scripts: what a hand did to a shape, one event a line, in edit time."""

import json
import math
from collections.abc import Collection
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Final, Literal, NoReturn, Self, get_args

from pydantic import Field, ValidationError, model_validator

from restshape.application import Application, application_of
from restshape.bounds import BULGE, NESTING, POLYLINE_POINTS, SCRIPT_BYTES
from restshape.errors import UserError
from restshape.scene.bodies import bodies_of, pins_of
from restshape.scene.event_line import (
    Analyse,
    Coordinate,
    Direction,
    EventLine,
    Frames,
    HandPosition,
    Idle,
    MirrorLine,
    Position,
    Redo,
    Undo,
)
from restshape.scene.held_point import CLOTH, can_hold
from restshape.scene.model import Scene
from restshape.scene.permits import outside
from restshape.scene.plain_values import Table, excess, named_files
from restshape.scene.source import Source, read_text, split_key, suggestion
from restshape.scene.units import UnitError, article, length_unit
from restshape.scene.validation_errors import user_error
from restshape.scene.values import Angle, Number, PartName, Strict, only_one

FORMAT: Final = "restshape-edits"
VERSION: Final = 1


class Header(Strict):
    """The first line: what the script is, for which scene, in which unit of length.

    Args:
        format: what the file is.
        version: of the format.
        scene: the file of the scene that it edits.
        units: unit of all lengths in the script.
        analysis: which frames are solved.
        note: for readers.
    """

    format: Literal["restshape-edits"]
    version: Literal[1]
    scene: str = ""
    units: str = "m"
    analysis: Literal["every frame", "on demand"] = "every frame"
    note: str = ""


class Press(EventLine):
    """A hand takes hold of an entity, a body or a support in space, at a point [m] (else its own).

    On "cloth" it takes hold of that point of the pattern, and drags say where in space it is held.

    Args:
        along: the one direction in which the entity goes; left out, it goes as the hand.
        as: the direction of the hand that counts for it; left out, the same.
        mirror: two points of a line, in which what the hand holds has mirror images that follow it.
    """

    do: Literal["press"]
    on: str
    at: HandPosition | None = None
    along: Direction | None = None
    counted: Annotated[Direction | None, Field(alias="as")] = None
    mirror: MirrorLine | None = None

    @model_validator(mode="after")
    def _goes_somewhere(self) -> Self:
        if self.counted is not None and self.along is None:
            what = "'as' says which direction of the hand counts, and there is no 'along', in which the entity goes"
            raise UnitError(what, 'add "along": [x, y]')
        return self


class Drag(EventLine):
    """The cursor moves to a point, or along a path in as many frames as it has points [m]."""

    do: Literal["drag"]
    to: HandPosition | None = None
    path: Annotated[list[HandPosition], Field(min_length=1)] | None = None
    frames: Frames | None = None

    @model_validator(mode="after")
    def _has_one_target(self) -> Self:
        only_one(self, ("to", "path"))
        return self


class Release(EventLine):
    """The hand lets go."""

    do: Literal["release"]


class Rotate(EventLine):
    """An entity turns by an angle [rad] about a point [m] (else its own)."""

    do: Literal["rotate"]
    on: str
    by: Angle
    about: Position | None = None
    frames: Frames = 1


class Scale(EventLine):
    """An entity grows by a factor about a point [m] (else its own)."""

    do: Literal["scale"]
    on: str
    factor: Annotated[Number, Field(gt=0)]
    about: Position | None = None
    frames: Frames = 1


class Set(EventLine):
    """A key of the scene gets another value; in several frames a number, or a list of numbers, gets there evenly."""

    do: Literal["set"]
    key: Annotated[str, Field(min_length=1)]
    value: object
    frames: Frames = 1


class Insert(EventLine):
    """An edge gets a vertex, near a point [m] or at a part 0 < s < 1 of its length."""

    do: Literal["insert"]
    on: str
    name: PartName
    at: Position | None = None
    s: Annotated[float, Field(gt=0, lt=1)] | None = None

    @model_validator(mode="after")
    def _has_one_place(self) -> Self:
        only_one(self, ("at", "s"))
        return self


class Delete(EventLine):
    """A vertex, a hole or a region goes away."""

    do: Literal["delete"]
    on: str


class Arc(EventLine):
    """An edge becomes an arc, through a point [m] or of a bulge tan(angle / 4)."""

    do: Literal["arc"]
    on: str
    through: Position | None = None
    bulge: Annotated[float, Field(ge=-BULGE, le=BULGE)] | None = None
    frames: Frames = 1

    @model_validator(mode="after")
    def _has_one_form(self) -> Self:
        only_one(self, ("through", "bulge"))
        return self


class Hole(EventLine):
    """A new hole: a circle by centre and radius [m], or a polygon [m]."""

    do: Literal["hole"]
    name: PartName
    center: Position | None = None
    radius: Annotated[Coordinate, Field(gt=0)] | None = None
    polygon: Annotated[list[Position], Field(min_length=3, max_length=POLYLINE_POINTS)] | None = None

    @model_validator(mode="after")
    def _is_one_kind(self) -> Self:
        if only_one(self, ("center", "polygon")) == "center":
            only_one(self, ("radius",))
        return self


Pins = list[Annotated[str | Position, Field(description="a vertex, or a place on the curve")]]


class Pull(EventLine):
    """A hand takes hold of a curve near a point [m] (else in its middle); drags then bend it between the pins.

    Pins are vertices, or places on the curve [m] of which the nearest control point stays; by default the curve's ends.
    """

    do: Literal["pull"]
    on: str
    at: Position | None = None
    pins: Pins | None = None


class Smooth(EventLine):
    """A curve is faired: `strength`, between 0 and 1, is the share of a zigzag of its points that goes away."""

    do: Literal["smooth"]
    on: str
    strength: Annotated[float, Field(gt=0, lt=1)] = 0.5
    pins: Pins | None = None
    frames: Frames = 1


Event = Annotated[
    Press
    | Drag
    | Release
    | Rotate
    | Scale
    | Set
    | Insert
    | Delete
    | Arc
    | Hole
    | Pull
    | Smooth
    | Idle
    | Analyse
    | Undo
    | Redo,
    Field(discriminator="do"),
]
EVENTS: dict[str, type[EventLine]] = {
    model.model_fields["do"].annotation.__args__[0]: model for model in get_args(get_args(Event)[0])
}
PLAIN_EVENTS: dict[str, type[EventLine]] = {"idle": Idle, "analyse": Analyse, "undo": Undo, "redo": Redo}
"""Events that every session has."""
SUPPORTS = "supports."
"""Before the name of a support that an event means, where an entity or a body has the same name."""
PLACED = (Press, Drag)
"""Events with places of the hand, which may be in space."""
GRABBING = ("press", "pull")
WHILE_GRABBED = ("drag", "release", "idle", "set", "analyse")
"""What may happen while the hand holds something."""


@dataclass(frozen=True)
class Script:
    """An edit script.

    Args:
        header: its first line; its `analysis` "on demand" leaves frames unsolved until an event `analyse`.
        events: the events before the first line that cannot be used.
        torn: why the last line is only part of a line; None when the file is whole.
        error: what is wrong with the first line that cannot be used; None when all can.
        warnings: what is odd, though it stops nothing.
        path: the file; None when it came from none.
        text: its lines, as they were read or written; empty where it was made of events.
    """

    header: Header
    events: tuple[EventLine, ...]
    torn: str | None = None
    error: UserError | None = None
    warnings: tuple[str, ...] = ()
    path: Path | None = None
    text: str = ""

    @classmethod
    def empty(cls, scene: Scene) -> Self:
        """The script that leaves the scene's shape as it is."""
        return cls(Header(format="restshape-edits", version=1, scene=scene.path.name), ())

    @property
    def frame_count(self) -> int:
        """Frames that a replay has: the first shape, and those of all events."""
        return 1 + sum(event.frame_count for event in self.events)


def load_script(path: str | Path, scene: Scene | None = None, keep_good: bool = False) -> Script:
    """The edit script of a JSON Lines file.

    A last line that is torn stops nothing: `Script.torn` reports it, and the events before it are there.

    Args:
        path: the file.
        scene: the scene that it will be replayed on.
        keep_good: with a bad line, give the events before it and the error as `Script.error`, rather than raise.

    Raises:
        UserError: the header is missing, of another version, or asks for analysis on demand where the scene moves in
            time; or (without keep_good) a line is bad.
    """
    path = Path(path)
    return read_script(read_text(path, "edit script", SCRIPT_BYTES), path, scene, keep_good)


def read_script(text: str, path: Path, scene: Scene | None = None, keep_good: bool = False) -> Script:
    """The validated edit script of a text; all else as of `load_script`, whose path is for messages here."""
    lines = [(number, line) for number, line in enumerate(text.split("\n"), start=1) if line.strip()]
    if not lines:
        raise UserError("the edit script is empty", path.name, _first_line())
    known = EVENTS if scene is None else events_of(application_of(scene))
    reader = ScriptReader(path, text.endswith("\n"), lines[-1][0], known, names_in_space(scene), scene)
    header = reader.header(*lines[0])
    _check_analysis(header, scene, path, lines[0][0])
    try:
        for number, line in lines[1:]:
            reader.event(number, reader.table(number, line))
    except _Torn as torn:
        reader.torn, reader.error = str(torn.error), torn.error
    except UserError as error:
        if not keep_good:
            raise
        reader.error = error
    odd = _warnings(header, scene, reader.odd)
    return Script(header, tuple(reader.events), reader.torn, reader.error, odd, path, text)


def events_of(application: Application) -> dict[str, type[EventLine]]:
    """The events of an application's edit scripts: those of its physics, and of what its scripts edit."""
    return {**application.events, **shared_events(application)}


def shared_events(application: Application) -> dict[str, type[EventLine]]:
    """The events of its edit scripts that other applications have too."""
    return dict(application.editing.shared_events())


def names_in_space(scene: Scene | None) -> Collection[str] | None:
    """What a hand may hold in space: bodies, and supports in space; None where no scene says."""
    if scene is None:
        return None
    pins, points = pins_of(scene), (CLOTH,) if can_hold(scene) else ()
    return {*bodies_of(scene), *pins, *points, *(f"{SUPPORTS}{name}" for name in pins)}


def _refuse_outside(event: EventLine, scene: Scene | None, path: Path) -> None:
    """Refuses an event that names a file which the scene may not name."""
    if scene is None or not isinstance(event, Set):
        return
    value = event.value
    for part in reversed(split_key(event.key)):
        value = {part: value}
    for key, file in named_files(value) if isinstance(value, dict) else ():
        if file not in scene._source.named and (refused := outside(file, scene.folder)):
            raise UserError(refused[0], f"{path.name}: line {event.line}: {'.'.join(key)}", refused[1])


def _first_line() -> str:
    """What to do about a missing header."""
    return f'let the first line be {{"format": "{FORMAT}", "version": {VERSION}, "scene": "my.toml", "units": "m"}}'


def _check_analysis(header: Header, scene: Scene | None, path: Path, line: int) -> None:
    """Refuses analysis on demand of what is integrated in time."""
    if header.analysis == "every frame" or scene is None or not application_of(scene).transient(scene):
        return
    raise UserError(
        f"time integration goes on from frame to frame, so that none can be left out: "
        f"{scene.app!r} has no analysis on demand for this scene",
        f"{path.name}: line {line}",
        'leave "analysis" out',
    )


def _warnings(header: Header, scene: Scene | None, odd: list[str]) -> tuple[str, ...]:
    """What is odd about the script for this scene."""
    if scene is None or not header.scene or Path(header.scene).name == scene.path.name:
        return tuple(odd)
    return (f"the script was written for the scene {header.scene!r}, not for {scene.path.name!r}", *odd)


class _Torn(Exception):
    """The last line is only part of a line."""

    def __init__(self, error: UserError) -> None:
        self.error = error
        super().__init__(str(error))


@dataclass
class ScriptReader:
    """Reads a script line by line, and knows what is grabbed.

    Args:
        path: for messages; whole: its last line, of number `last`, ends.
        known: events by name; in_space: as `names_in_space` gives it.
        scene: that events are for; None: none is known.

    Attributes:
        events: that have been read.
        torn, error: as of `Script`; odd: its warnings.
        grabbed: what the hand holds; t: edit time of the last event [s]; scale: of lengths without a unit [m].
    """

    path: Path
    whole: bool
    last: int
    known: dict[str, type[EventLine]]
    in_space: Collection[str] | None
    scene: Scene | None = None
    events: list[EventLine] = field(default_factory=list)
    torn: str | None = None
    error: UserError | None = None
    grabbed: str | None = None
    t: float = 0.0
    scale: float = 1.0
    odd: list[str] = field(default_factory=list)

    def fail(self, number: int, what: str, do: str = "") -> NoReturn:
        """Raises the error that names file and line."""
        raise UserError(what, f"{self.path.name}: line {number}", do)

    def table(self, number: int, line: str) -> Table:
        """The JSON object of a line."""
        try:
            found = json.loads(line, parse_constant=_refuse_constant)
        except json.JSONDecodeError as error:
            if number == self.last and not self.whole and number > 1:
                where = f"{self.path.name}: line {number}"
                do = "remove that line: the ones before it are whole"
                raise _Torn(UserError("the last line is torn: it ends in the middle", where, do)) from error
            # Some of its messages end in "at" themselves.
            what = error.msg.lower().removesuffix(" at")
            self.fail(number, f"this is not JSON: {what} at column {error.colno}", "one JSON object a line")
        except RecursionError:
            self.fail(number, f"there are more than {NESTING} tables and lists within each other", "write flatter ones")
        except ValueError as error:
            what = str(error) if len(line) < 4000 else "there is a number that is too large"
            self.fail(number, what, "write finite numbers")
        if not isinstance(found, dict):
            self.fail(number, f"a JSON object is wanted on each line, not {line.strip()[:40]}", "write {...}")
        self.check_excess(number, found)
        return found

    def check_excess(self, number: int, table: Table) -> None:
        """Refuses a table with a value beyond a bound of all values."""
        if wrong := excess(table):
            key, what, do = wrong
            self.fail(number, f"{'.'.join(part[:40] for part in key[:4])}: {what}", do)

    def header(self, number: int, line: str) -> Header:
        """The header of the first line."""
        table = self.table(number, line)
        if "do" in table or "format" not in table:
            self.fail(number, "the header is missing", _first_line())
        if table["format"] != FORMAT:
            self.fail(number, f"this is not an edit script: its format is {table['format']!r}", _first_line())
        if table.get("version") != VERSION:
            self.fail(number, f"version {table.get('version')!r} is not known", f"this program reads version {VERSION}")
        try:
            header = Header.model_validate(table)
        except ValidationError as error:
            raise self.reported(error, number, Header) from error
        self.scale = length_unit(header.units, f"{self.path.name}: line {number}: units")
        return header

    def event(self, number: int, table: Table) -> EventLine:
        """Reads the event of a line's table, and keeps it."""
        do = table.get("do")
        if do is None:
            self.fail(number, "the key 'do' is missing", f"use one of: {', '.join(self.known)}")
        if not isinstance(do, str) or do not in self.known:
            self.fail(number, f"there is no event {do!r}", suggestion(str(do), list(self.known)))
        if "line" in table:
            self.fail(number, "there is no key 'line' here", suggestion("line", list(self.known[do].model_fields)[1:]))
        try:
            event = self.known[do].model_validate(table | {"line": number}, context={"scale": self.scale})
        except ValidationError as error:
            raise self.reported(error, number, self.known[do]) from error
        self.check_place(event, number)
        self.check_order(event, number)
        _refuse_outside(event, self.scene, self.path)
        self._note_odd(event, table)
        self.events.append(event)
        return event

    def _note_odd(self, event: EventLine, table: Table) -> None:
        """Notes what is odd about the event that a table gives, though it stops nothing."""
        turn = table.get("by") if isinstance(event, Rotate) else None
        if isinstance(turn, int | float) and abs(turn) > 2.0 * math.pi:
            choice = f'"{turn:g} deg" or "{turn:g} rad"'
            self.odd.append(
                f"line {event.line}: an angle without a unit is in radians, and {turn:g} is more than a turn: {choice}?"
            )

    def reported(self, error: ValidationError, number: int, model: type[Strict]) -> UserError:
        """The error that names file, line and key."""
        return user_error(error, Source(Path(f"{self.path.name}: line {number}")), model)

    def check_place(self, event: EventLine, number: int) -> None:
        """Refuses a place in space where the hand holds a part of a shape, which is in the plane."""
        if not isinstance(event, PLACED):
            return
        name = str(getattr(event, "on", self.grabbed))
        if self._is_in_space(name):
            return
        given = [("at", event.at)] if isinstance(event, Press) else [("to", event.to)]
        given += [(f"path.{k}", place) for k, place in enumerate(getattr(event, "path", None) or ())]
        for key, place in given:
            if place is not None and len(place) > 2:
                what = f"a place in the plane has 2 numbers, and there are 3: {name} is no body and no support in space"
                there = ", ".join(sorted(one for one in self.in_space or () if one.startswith(SUPPORTS)))
                do = f"leave out z, or press on one of: {there}" if there else "leave out z"
                raise UserError(what, f"{self.path.name}: line {number}: {key}", do)

    def _is_in_space(self, name: str) -> bool:
        """Whether a name may be that of a body or a support in space, one that an edit adds too."""
        known = self.in_space
        if known is None or name in known:
            return True
        return len(known) > 0 and (name.startswith(SUPPORTS) or name in self._added())

    def _added(self) -> set[str]:
        """Names of the supports that edits have set so far; no edit adds a body."""
        found: set[str] = set()
        for event in self.events:
            table, *below = split_key(event.key) if isinstance(event, Set) else ("",)
            if table == SUPPORTS.rstrip("."):
                value = getattr(event, "value", None)
                found |= {below[0]} if below else set(value) if isinstance(value, dict) else set()
        return found

    def check_order(self, event: EventLine, number: int) -> None:
        """Refuses time that runs backwards, and a hand that drags what it does not hold."""
        if event.t < self.t:
            self.fail(number, f"time runs backwards: t = {event.t:g} after t = {self.t:g}", "let t never decrease")
        self.t, what = event.t, article(event.do)
        if self.grabbed is None and event.do in ("drag", "release"):
            self.fail(number, f"there is {what} before a press or a pull", 'add {"do": "press", "on": ...} before it')
        if self.grabbed is not None and event.do not in WHILE_GRABBED:
            self.fail(number, f"there is {what} while {self.grabbed!r} is still grabbed", "add a release before it")
        if event.do in GRABBING:
            self.grabbed = getattr(event, "on", None)
        elif event.do == "release":
            self.grabbed = None


def reader_of(scene: Scene, header: Header, path: Path) -> ScriptReader:
    """What validates events for a scene as they come, as those of a file with that header; the path is for messages.

    Raises:
        UserError: the header asks for analysis on demand where the scene moves in time, or has no unit of length.
    """
    _check_analysis(header, scene, path, 1)
    scale = length_unit(header.units, f"{path.name}: line 1: units")
    return ScriptReader(path, True, 0, events_of(application_of(scene)), names_in_space(scene), scene, scale=scale)


def _refuse_constant(name: str) -> NoReturn:
    """Refuses NaN and infinities, which Python's JSON would take."""
    raise ValueError(f"{name} is not a finite number")
