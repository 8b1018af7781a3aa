"""The event that draws a dart."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from restshape.scene.event_line import Coordinate, EventLine, Position
from restshape.scene.units import UnitError
from restshape.scene.values import Angle, Name, Number


# More than 15 attributes: each is a key of the event.
class DrawnDart(EventLine):
    """A dart is drawn: by a line that begins at an edge or inside a panel, or by an edge and a place on it.

    Args:
        name: of the dart, whose table in the scene can be set afterwards.
        from: a point [m] of the pattern plane: its mouth at an edge, or beyond that, or the tip of one inside.
        to: its tip.
        edge, at, angle, length, width, widest, mouth, folded, stitched: as of ``[darts.NAME]``.
    """

    do: Literal["dart"]
    name: Name
    start: Annotated[Position | None, Field(alias="from")] = None
    to: Position | None = None
    edge: str | None = None
    at: Annotated[Number, Field(ge=0, le=1)] | None = None
    angle: Angle | None = None
    length: Annotated[Coordinate, Field(gt=0)] | None = None
    width: Annotated[Coordinate, Field(gt=0)]
    widest: Annotated[Number, Field(gt=0, lt=1)] | None = None
    mouth: Literal["kept", "straight"] | None = None
    folded: bool | None = None
    stitched: Literal["flat"] | None = None

    @model_validator(mode="after")
    def _has_one_place(self) -> Self:
        if (self.start is None) != (self.to is None) or (self.start is None) == (self.edge is None):
            raise UnitError(
                "a dart is drawn from one point to another, or at an edge", "give `from` and `to`, or `edge`"
            )
        return self

    @property
    def keys(self) -> dict[str, object]:
        """What it says of the dart's table, but for its points."""
        names = ("edge", "at", "angle", "length", "width", "widest", "mouth", "folded", "stitched")
        return {name: getattr(self, name) for name in names if getattr(self, name) is not None}
