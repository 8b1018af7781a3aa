"""Events of edit scripts that are for furniture: what a hand does to planks."""

from math import pi
from typing import Annotated, Any, Literal, NamedTuple, Self, get_args

from pydantic import BeforeValidator, Field, ValidationInfo, WithJsonSchema, model_validator

from restshape.scene.event_line import Analyse, Coordinate, EventLine, Frames, Idle, Redo, Undo
from restshape.scene.units import UnitError, quantity
from restshape.scene.values import Name, number_of, only_one

Place = tuple[Coordinate, Coordinate, Coordinate]
Parts = tuple[number_of("number"), number_of("number"), number_of("number")]
Parameter = Literal["move x", "move y", "move z", "turn x", "turn y", "turn z", "length x", "length y"]


MOST_TURN = 20.0 * pi
"""How far a plank is turned at once [rad]: with much more its direction would be lost in rounding."""


class Dragged(NamedTuple):
    """How far a parameter is dragged, whichever it is; None where the unit is not of that kind.

    Args:
        length: of a move or a length [m].
        angle: of a turn [rad].
    """

    length: float | None
    angle: float | None


def _read_amount(raw: Any, info: ValidationInfo) -> Dragged:
    """A length and an angle: a plain number is in the units of the script's header, and in rad."""
    if isinstance(raw, Dragged):
        return raw
    if not isinstance(raw, str):
        value = quantity(raw, None)
        return Dragged(value * (info.context or {}).get("scale", 1.0), value)
    found: list[float | None] = []
    for dimension in ("length", "angle"):
        try:
            found.append(quantity(raw, dimension))
        except UnitError:
            found.append(None)
    if found == [None, None]:
        quantity(raw, "length")
    return Dragged(*found)


Amount = Annotated[
    Dragged,
    BeforeValidator(_read_amount),
    WithJsonSchema(
        {
            "anyOf": [{"type": "number"}, {"type": "string"}],
            "description": 'a length in the header\'s units, or "12 mm"; of turns an angle in rad, or "5 deg"',
        }
    ),
]


def _read_target(raw: Any) -> Any:
    """A point to drag to; a number is what parameters are dragged by."""
    if isinstance(raw, (int, float, str)) and not isinstance(raw, bool):
        raise UnitError(f"a plank is dragged to a point [x, y, z], not {raw!r}", "use 'by' for a parameter")
    return raw


Target = Annotated[Place, BeforeValidator(_read_target)]


def far_turn(angle: float) -> UnitError | None:
    """What is wrong with a turn by an angle [rad]; None if nothing is."""
    if abs(angle) <= MOST_TURN:
        return None
    return UnitError(f"a turn by {angle:g} rad is too far", f"at most {MOST_TURN:.4g} rad, ten turns")


class PlankPress(EventLine):
    """A hand takes hold of a plank, at a point [m] (else its middle), or of one ``parameter`` of it.

    Args:
        parameter: of the plank that the hand drags.
    """

    do: Literal["press"]
    on: str
    at: Place | None = None
    parameter: Parameter | None = None

    @model_validator(mode="after")
    def _is_one_kind(self) -> Self:
        if self.at is not None and self.parameter is not None:
            raise UnitError("a parameter is grabbed by its name, not at a point", "leave out at")
        return self


class PlankDrag(EventLine):
    """The cursor moves ``to`` a point, or along a ``path`` of points; a parameter ``by`` so much from its start.

    ``by`` is a length in the units of the header, and of turns an angle in rad; or a text with a unit.
    """

    do: Literal["drag"]
    to: Target | None = None
    path: Annotated[list[Target], Field(min_length=1)] | None = None
    by: Amount | None = None
    frames: Frames | None = None

    @model_validator(mode="after")
    def _has_one_target(self) -> Self:
        only_one(self, ("to", "path", "by"))
        return self


class PlankRelease(EventLine):
    """The hand lets go."""

    do: Literal["release"]


class PlankRotate(EventLine):
    """A plank turns by an angle [rad] about an axis of its own."""

    do: Literal["rotate"]
    on: str
    by: number_of("angle")
    about: Literal["x", "y", "z"] = "z"
    frames: Frames = 1

    @model_validator(mode="after")
    def _is_not_far(self) -> Self:
        if wrong := far_turn(self.by):
            raise wrong
        return self


class PlankScale(EventLine):
    """A plank becomes longer by a factor, along its x or y.

    Args:
        along: the axis of the plank along which it grows.
    """

    do: Literal["scale"]
    on: str
    factor: Annotated[number_of("number"), Field(gt=0)]
    along: Literal["x", "y"] = "x"
    frames: Frames = 1


class PlankSet(EventLine):
    """A key of the scene gets another value; in several frames a number, or a list of numbers, gets there evenly."""

    do: Literal["set"]
    key: Annotated[str, Field(min_length=1)]
    value: Any
    frames: Frames = 1


class DrawPlank(EventLine):
    """A new plank by two drawn lines: its middle line from one point to another, and its width across it.

    It is as thick and made as ``[wood]`` says, and joined as ``[fastener]`` does, where it says nothing else.

    Args:
        from, to: the ends of its middle line.
        width: the vector across it.
        thickness: left out, that of the wood.
        wood: left out, that of all planks.
        fastener: of its joints; left out, that of all.
    """

    do: Literal["plank"]
    name: Name
    start: Annotated[Place, Field(alias="from")]
    to: Place
    width: Place
    thickness: Annotated[Coordinate, Field(gt=0)] | None = None
    wood: str | None = None
    fastener: str | None = None


class Connect(EventLine):
    """A plank is joined to all that it has come near, with a ``fastener``, and stands on the floor if that is near.

    Args:
        fastener: of the new joints; left out, that of all.
    """

    do: Literal["connect"]
    on: str
    fastener: str | None = None


class PutWeight(EventLine):
    """A mass [kg] is put on a plank, ``at`` a place in parts of its size; one of the same name is replaced.

    Args:
        mass: its mass.
    """

    do: Literal["weight"]
    name: Name
    on: str
    mass: Annotated[number_of("mass"), Field(gt=0)]
    at: Parts | None = None


class Remove(EventLine):
    """A plank, with all that is on it, or a weight, goes away."""

    do: Literal["delete"]
    on: str


class Choose(EventLine):
    """A suggestion is taken, by its number from 1 on.

    Args:
        number: of the suggestion, from 1.
    """

    do: Literal["choose"]
    number: Annotated[int, Field(ge=1, le=99)]


class Slide(EventLine):
    """The chosen suggestion is followed to a part, 0 to 1, of its valid range.

    Args:
        to: the part of the suggestion that is followed, 0 to 1.
    """

    do: Literal["slide"]
    to: Annotated[number_of("number"), Field(ge=0, le=1)]
    frames: Frames = 1


PlankEvent = Annotated[
    PlankPress
    | PlankDrag
    | PlankRelease
    | PlankRotate
    | PlankScale
    | PlankSet
    | DrawPlank
    | Connect
    | PutWeight
    | Remove
    | Choose
    | Slide
    | Idle
    | Analyse
    | Undo
    | Redo,
    Field(discriminator="do"),
]
PLANK_EVENTS: dict[str, type[EventLine]] = {
    model.model_fields["do"].annotation.__args__[0]: model for model in get_args(get_args(PlankEvent)[0])
}
