"""What all edit scripts share: time, places in the units of the script, numbers of frames, events without an object."""

import math
from typing import Annotated, Literal

from pydantic import AfterValidator, BeforeValidator, Field, ValidationInfo, WithJsonSchema
from pydantic.json_schema import SkipJsonSchema

from restshape.scene.units import UnitError, finite_quantity
from restshape.scene.values import Number, Strict, Time


def _read_coordinate(raw: float | str, info: ValidationInfo) -> float:
    """A length in metres: plain numbers are in the units of the script's header."""
    scale = (info.context or {}).get("scale", 1.0)
    # However far it is: an edit that goes too far is a refused frame.
    return finite_quantity(raw, "length")[0] * (1.0 if isinstance(raw, str) else scale)


Coordinate = Annotated[
    float,
    BeforeValidator(_read_coordinate),
    WithJsonSchema(
        {"anyOf": [{"type": "number"}, {"type": "string"}], "description": 'in the header\'s units, or "12 mm"'}
    ),
]
Position = tuple[Coordinate, Coordinate]
HandPosition = Annotated[tuple[Coordinate, ...], Field(min_length=2, max_length=3)]
"""In the plane, or in space: there a z that is left out stays as it is."""


def _read_direction(raw: tuple[float, float]) -> tuple[float, float]:
    """The unit vector of a direction."""
    largest = max(map(abs, raw))
    if largest == 0.0:
        raise UnitError("a direction has a length, and this is zero", "write one such as [1, 0]")
    x, y = (value / largest for value in raw)
    return x / math.hypot(x, y), y / math.hypot(x, y)


def _read_line(raw: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
    """Two points of a line, if there is one through them."""
    if raw[0] == raw[1]:
        raise UnitError("a line goes through two points, and these are one", "write two that differ")
    return raw


Direction = Annotated[tuple[Number, Number], AfterValidator(_read_direction)]
"""A unit vector, however long it is written."""
MirrorLine = Annotated[tuple[Position, Position], AfterValidator(_read_line)]
"""The line through two points [m]."""
Frames = Annotated[int, Field(ge=1, le=1_000_000, strict=True)]


class EventLine(Strict):
    """What every event has: what it does, its edit time [s], its line (0 = not from a file), and room for a remark.

    Args:
        t: edit time at which it begins.
        note: for readers.
        gesture: number of the gesture that it is part of; edits of one that follow each other are undone at once.
        do: what happens.
        on: the entity that it happens to.
        name: of what it makes.
        at: where; left out, as the event says.
        to: where the cursor goes.
        path: points that the cursor goes through, one a frame.
        by: how far it turns or moves.
        about: the point, or axis, that stays; left out, its own.
        factor: how many times as large it becomes.
        frames: in how many frames it happens.
        key: of the scene, with dots.
        value: the value that the key gets.
        s: place on the edge, as a share of its length.
        through: a point of the arc.
        bulge: tan(angle / 4) of the arc.
        center: of the circle.
        radius: of the circle.
        polygon: corners of the polygon.
        pins: vertices, or places on the curve, that stay; left out, its ends.
        strength: share of a zigzag that goes away.
    """

    line: SkipJsonSchema[int] = Field(default=0, exclude=True)
    t: Annotated[Time, Field(ge=0)]
    note: str = ""
    gesture: Annotated[int, Field(ge=1, strict=True)] | None = None
    do: str

    @property
    def frame_count(self) -> int:
        """Number of frames that it takes; along a path without a number of its own, one for each place."""
        path = getattr(self, "path", None)
        return getattr(self, "frames", None) or (len(path) if path is not None else 1)


class Idle(EventLine):
    """Nothing happens for some frames."""

    do: Literal["idle"]
    frames: Frames = 1


class Analyse(EventLine):
    """One frame that is analysed, also where the header asks for analysis "on demand" only."""

    do: Literal["analyse"]


class Undo(EventLine):
    """The last edit, or gesture of several, is taken back."""

    do: Literal["undo"]


class Redo(EventLine):
    """What was taken back last is done again."""

    do: Literal["redo"]
