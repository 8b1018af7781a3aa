"""What scenes of furniture hold: planks of wood, joints, the floor, weights and pushes."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import ConfigDict, Field, model_validator

from restshape.scene.space_values import ORIGIN, Angles, Place
from restshape.scene.units import UnitError
from restshape.scene.values import Length, Strict, number_of, value_of

Size = value_of("length")
Parts = tuple[number_of("number"), number_of("number"), number_of("number")]
NEAR = 0.015
"""How near a drawn end must be to a face to be joined to it [m]."""

BESIDE = "give places from -0.5 to 0.5, in parts of its size from its middle"
"""What to do about a load that is not on its plank."""

SUGGESTIONS_BYTES, RANGES_BYTES, REDUNDANT_BYTES = 4000, 400, 160
"""Room for the suggestions of a frame, its valid ranges, and its redundant joints with the largest
utilisation, in a recording."""


class Wood(Strict):
    """``[wood]``: what planks are made of, and how thick [m] they are where they say nothing else.

    Args:
        name: of the material.
        thickness: of planks that say no other.
    """

    name: str = "mdf"
    thickness: Size = 0.012


class Fastening(Strict):
    """``[fastener]``: what joints are made with, and how far [m] one is from the next along a joint.

    Args:
        name: of the fastener.
        spacing: from one to the next along a joint.
    """

    name: str = "nail-thesis"
    spacing: Annotated[Length, Field(gt=0)] = 0.02


class PlankSpec(Strict):
    """``[planks.NAME]``: a board, by two drawn lines or by its middle.

    Two lines are its middle line ``from`` one point ``to`` another [m], and its ``width``, a vector [m] across it.
    Else it has a ``center`` [m], a ``size`` of length and width [m] along its x and y, and a ``turn`` about x, then y,
    then z. Without them it is thick and made as ``[wood]`` says.

    Args:
        from, to: the ends of its middle line.
        width: the vector across it.
        center: its centre, instead of lines.
        size: length and width along its x and y.
        turn: angles about x, then y, then z.
        thickness: left out, that of the wood.
        wood: left out, that of all planks.
    """

    model_config = ConfigDict(populate_by_name=True)

    start: Annotated[Place | None, Field(alias="from")] = None
    to: Place | None = None
    width: Place | None = None
    center: Place | None = None
    size: tuple[Size, Size] | None = None
    turn: Angles = ORIGIN
    thickness: Size | None = None
    wood: str | None = None

    @property
    def drawn(self) -> bool:
        """Whether it is given by two lines."""
        return self.start is not None

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        ways = {"from": self.start, "to": self.to, "width": self.width}, {"center": self.center, "size": self.size}
        given = [[key for key, value in way.items() if value is not None] for way in ways]
        if given[0] and (given[1] or "turn" in self.model_fields_set):
            fixed = given[1][0] if given[1] else "turn"
            both = f"here {fixed!r} stands beside {given[0][0]!r}"
            raise UnitError(f"a plank is given by two lines or by its middle, and {both}")
        for way, keys in zip(ways, given):
            missing = [key for key in way if key not in keys]
            if keys and missing:
                raise UnitError(f"the key {missing[0]!r} is missing", "add it")
        if not any(given):
            raise UnitError("the plank has no place", "give from, to and width, or center and size")
        return self


class JointSpec(Strict):
    """``[joints.NAME]``: the end of a plank against a face of another, through which its fasteners go.

    Args:
        plank: whose end is joined.
        end: of the plank.
        to: the other plank.
        face: of the other plank.
        fastener: left out, that of all joints.
    """

    plank: str
    end: Literal["-x", "+x", "-y", "+y"]
    to: str
    face: Literal["-z", "+z"]
    fastener: str | None = None


class Joints(Strict):
    """``[joints]``: every end within ``reach`` [m] of a face is joined to it, beside the joints that have names.

    With ``near = false`` those that have names are all.

    Args:
        near: whether joints are made by themselves.
        reach: the largest distance of an end from a face that it is joined to.
    """

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, JointSpec]

    near: bool = True
    reach: Annotated[Length, Field(gt=0)] = NEAR

    @property
    def named(self) -> dict[str, JointSpec]:
        """Joints by name."""
        return self.__pydantic_extra__ or {}


class Floor(Strict):
    """``[floor]``: how high it lies [m], and Coulomb's coefficient of friction on it.

    Args:
        height: of the floor.
        friction: Coulomb's coefficient on it.
    """

    height: Length = 0.0
    friction: Annotated[number_of("number"), Field(ge=0)] = 0.5


class WeightSpec(Strict):
    """``[weights.NAME]``: a mass [kg] put on a plank, ``at`` a place in parts of its size from its middle.

    Without ``at`` it lies on top: in the middle of the side that looks up most.

    Args:
        on: the plank that bears it.
        mass: its mass.
        at: where on the plank, in parts of its size from its centre.
    """

    on: str
    mass: value_of("mass")
    at: Parts | None = None


class PushSpec(Strict):
    """``[pushes.NAME]``: a force [N] on a plank, a case of its own beside the weights; ``at`` as of weights.

    Args:
        on: the plank that is pushed.
        force: its components.
        at: where on the plank, in parts of its size from its centre.
    """

    on: str
    force: tuple[value_of("force"), value_of("force"), value_of("force")]
    at: Parts = ORIGIN
