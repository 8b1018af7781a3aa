"""What the page sends, validated: the same as `FromPage` of `page/src/protocol.ts`."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import cache
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from restshape.errors import quoted

LONGEST = 1 << 20
"""Characters of a message of the page at most; a longer one is refused unread."""
RESUMES = '{"type":"resume"'
"""Begins the one message that may be longer, which is the server's."""
Number = Annotated[int, Field(ge=0, le=2**53)]


class FromPage(BaseModel):
    """A message of the page.

    Args:
        id: its number, which answers name.
        shown: frames that the page has taken since its message before; for the server.
    """

    # Models are built as the first message is read, after the first frame was shown.
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, defer_build=True)

    id: Number
    shown: Number = 0


class EventMessage(FromPage):
    """An event of edit scripts.

    Args:
        event: its keys, with "do"; the models of scripts validate it.
        latest: it takes the place of one of its kind that waits.
        gesture: number that the events of one gesture share; 0: it is all of one. Scripts have another number of it.
    """

    type: Literal["event"]
    event: dict[str, Any]
    latest: bool = False
    gesture: Number = 0

    @property
    def kind(self) -> tuple[str, ...]:
        """What a later one must have in common to take its place."""
        return tuple(str(self.event.get(key)) for key in ("do", "on", "key"))


class ShowMessage(FromPage):
    """What frames show: the field that gives colours, predicted or solved answers, marks at the hand."""

    type: Literal["show"]
    field: str | None = None
    predict: Literal["none", "linear", "gmls"] | None = None
    marks: bool | None = None


class RatesMessage(FromPage):
    """How quantities change with an entity, or with a number of the scene."""

    type: Literal["rates"]
    of: str


class StrikeMessage(FromPage):
    """The shape is struck at a place [m]."""

    type: Literal["strike"]
    at: Annotated[list[float], Field(min_length=2, max_length=3)] | None = None


class PlayMessage(FromPage):
    """The script is played on, at a speed over that of its edit time."""

    type: Literal["play"]
    speed: Annotated[float, Field(gt=0, le=1000)] | None = None


class PauseMessage(FromPage):
    """The script stops where it is."""

    type: Literal["pause"]


class SeekMessage(FromPage):
    """A frame of the script is shown."""

    type: Literal["seek"]
    frame: Number


class TakeMessage(FromPage):
    """The hand goes on from the frame that is shown."""

    type: Literal["take"]


class RunMessage(FromPage):
    """What goes on in time does so, while nothing else happens; or no more."""

    type: Literal["run"]
    on: bool


class RecordMessage(FromPage):
    """Frames are recorded, or no more."""

    type: Literal["record"]
    on: bool


class SaveMessage(FromPage):
    """The script is written."""

    type: Literal["save"]


class CancelMessage(FromPage):
    """The frame in work is given up; the server does it, by ending this process."""

    type: Literal["cancel"]


class RestartMessage(FromPage):
    """The simulation begins again, with the script so far."""

    type: Literal["restart"]


class ResumeMessage(FromPage):
    """What was done before, of the server: all of it is done again, and its last frame shown.

    Args:
        lines: of the script, an event a line; predict: how frames were predicted; None: as at first.
        field: that gave the colours; None: the one at first.
    """

    id: Number = 0
    type: Literal["resume"]
    lines: str
    predict: Literal["none", "linear", "gmls"] | None = None
    field: str | None = None


class EndMessage(FromPage):
    """The session ends; it is of the server."""

    id: Number = 0
    type: Literal["end"]


Message = (
    EventMessage
    | ShowMessage
    | RatesMessage
    | StrikeMessage
    | PlayMessage
    | PauseMessage
    | SeekMessage
    | TakeMessage
    | RunMessage
    | RecordMessage
    | SaveMessage
    | CancelMessage
    | RestartMessage
    | ResumeMessage
    | EndMessage
)


@cache
def _reader() -> Callable[[str], Message]:
    adapter: TypeAdapter[Message] = TypeAdapter(Annotated[Message, Field(discriminator="type")])
    adapter.rebuild()
    # Without the adapter's own look at options that nobody gives.
    return adapter.validator.validate_json


class MalformedMessage(ValueError):
    """A message that is none.

    Args:
        id: its number where it has one that can be read; 0.
    """

    def __init__(self, what: str, id: int = 0) -> None:
        self.id = id
        super().__init__(what)


def read(content: str | bytes) -> Message:
    """The message of a text.

    Raises:
        MalformedMessage: it is none.
    """
    if isinstance(content, bytes):
        raise MalformedMessage("the page sends texts, and this is binary")
    if len(content) > LONGEST and not content.startswith(RESUMES):
        raise MalformedMessage(f"a message has {LONGEST} characters at most, and this one {len(content)}")
    try:
        return _reader()(content)
    except ValidationError as error:
        first = error.errors(include_url=False, include_context=False)[0]
        where = ".".join(map(str, first["loc"][1:])) if first["loc"] else ""
        what = f"{where}: {first['msg']}" if where else str(first["msg"])
        raise MalformedMessage(quoted(what), _number(content)) from error


def _number(content: str) -> int:
    """The number of a message that is none otherwise: 0 where it has none that can be read."""
    try:
        given = json.loads(content)
    except (ValueError, RecursionError):
        return 0
    number = given.get("id") if isinstance(given, dict) else None
    return number if type(number) is int and 0 <= number <= 2**53 else 0


def merged(waiting: list[Message], new: Message) -> None:
    """Adds a message to those that wait; a `latest` event takes the place of one of its kind.

    It overtakes no message but such events: what is pressed, let go or played keeps its order. A frame of the player
    that is asked for takes the place of another one.
    """
    if isinstance(new, SeekMessage) and waiting and isinstance(waiting[-1], SeekMessage):
        waiting.pop()
    if isinstance(new, EventMessage) and new.latest:
        for place in range(len(waiting) - 1, -1, -1):
            old = waiting[place]
            if not (isinstance(old, EventMessage) and old.latest):
                break
            if old.kind == new.kind:
                del waiting[place]
                break
    waiting.append(new)
