"""Events of edit scripts that are for furniture: what a hand does to planks."""

from typing import Annotated, Any, Literal, Self, get_args

from pydantic import Field, model_validator

from restshape.scene.event_line import Analyse, Coordinate, EventLine, Frames, Idle, Redo, Undo
from restshape.scene.units import UnitError
from restshape.scene.values import Length, Name, number_of, only_one

Place = tuple[Coordinate, Coordinate, Coordinate]
Parts = tuple[number_of("number"), number_of("number"), number_of("number")]
Parameter = Literal["move x", "move y", "move z", "turn x", "turn y", "turn z", "length x", "length y"]


class PlankPress(EventLine):
    """A hand takes hold of a plank, at a point [m] (else its middle), or of one ``parameter`` of it."""

    do: Literal["press"]
    on: str
    at: Place | None = None
    parameter: Parameter | None = None

    @model_validator(mode="after")
    def _is_one_kind(self) -> Self:
        if self.at is not None and self.parameter is not None:
            raise UnitError("a parameter is held by its name, not at a point: leave out at")
        return self


class PlankDrag(EventLine):
    """The cursor moves ``to`` a point, or along a ``path`` of points [m]; a parameter ``by`` so much from its start.

    ``by`` is in m, and of turns in rad.
    """

    do: Literal["drag"]
    to: Place | None = None
    path: Annotated[list[Place], Field(min_length=1)] | None = None
    by: float | None = None
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


class PlankScale(EventLine):
    """A plank becomes longer by a factor, along its x or y."""

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
    """A new plank by two drawn lines: its middle line from one point to another [m], and its width across it [m]."""

    do: Literal["plank"]
    name: Name
    start: Annotated[Place, Field(alias="from")]
    to: Place
    width: Place
    thickness: Annotated[Length, Field(gt=0)] | None = None


class Connect(EventLine):
    """A plank is joined to all that it has come near, and stands on the floor if it reaches it."""

    do: Literal["connect"]
    on: str


class PutWeight(EventLine):
    """A mass [kg] is put on a plank, ``at`` a place in parts of its size; one of the same name is replaced."""

    do: Literal["weight"]
    name: Name
    on: str
    mass: Annotated[number_of("mass"), Field(gt=0)]
    at: Parts = (0.0, 0.0, 0.5)


class Remove(EventLine):
    """A plank, with all that is on it, or a weight, goes away."""

    do: Literal["delete"]
    on: str


class Choose(EventLine):
    """A suggestion is taken, by its number from 1 on."""

    do: Literal["choose"]
    number: Annotated[int, Field(ge=1, le=99)]


class Slide(EventLine):
    """The chosen suggestion is followed to a part, 0 to 1, of its valid range."""

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
