"""What a scene says of the edges of its shape."""

from itertools import pairwise
from typing import Annotated, Literal, Self

from pydantic import BaseModel, Discriminator, Field, Tag, model_validator

from restshape.bounds import BULGE, POLYLINE_POINTS, SPLINE_POINTS
from restshape.scene.units import UnitError
from restshape.scene.values import Number, PartName, Point, Strict, only_one


def tag_by_key(keys: tuple[str, ...]) -> Discriminator:
    """A discriminator that distinguishes models by which of the keys is there."""

    def tag(raw: object) -> str | None:
        given = raw if isinstance(raw, dict) else type(raw).model_fields if isinstance(raw, BaseModel) else ()
        present = [key for key in keys if key in given]
        return f"<{present[0]}>" if present else None

    wanted = f"one of {', '.join(keys)} is wanted here"
    context: dict[str, int | str | float] = {"keys": ", ".join(keys)}
    return Discriminator(tag, custom_error_type="kind", custom_error_message=wanted, custom_error_context=context)


class EdgePart(Strict):
    """What any edge may say: ``part_of``, the edge that it was cut from, whose name stands for all its parts.

    Args:
        part_of: the edge that it was cut from, whose name stands for all its parts.
    """

    part_of: PartName | None = None

    @property
    def kind(self) -> str:
        """Which of line, arc, spline and polyline this edge is."""
        return next(key for key in type(self).model_fields if key != "part_of")


class LineSpec(EdgePart):
    """A straight edge: ``{ line = ["a", "b"] }``.

    Args:
        line: the vertices where it begins and ends.
    """

    line: tuple[str, str]

    @model_validator(mode="after")
    def _has_length(self) -> Self:
        _check_ends(self.line)
        return self


class ArcSpec(EdgePart):
    """A circular edge: ``{ arc = ["a", "b"], through = [x, y] }``, or ``bulge`` = tan(angle / 4).

    A positive bulge lies to the right of the way from a to b, as in DXF.

    Args:
        arc: the vertices where it begins and ends.
        through: a point between its ends.
        bulge: tan(angle / 4), instead of a point.
    """

    arc: tuple[str, str]
    through: Point | None = None
    bulge: Annotated[Number, Field(ge=-BULGE, le=BULGE)] | None = None

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        _check_ends(self.arc)
        only_one(self, ("through", "bulge"))
        return self


class SplineSpec(EdgePart):
    """An edge that interpolates points by a cubic: ``{ spline = ["a", "b"], through = [[x, y], ...] }``.

    ``knots`` are its parameters at these points, rising between 0 and 1 (left out: by the lengths of the chords).
    ``ends`` says for each end whether the second derivative is 0 there ("natural") or the third one is continuous at
    the next point ("smooth").

    Args:
        spline: the vertices where it begins and ends.
        through: points between them, in order.
        knots: its parameters at these points, rising between 0 and 1; left out, by the lengths of the chords.
        ends: the condition at each end.
    """

    spline: tuple[str, str]
    through: Annotated[list[Point], Field(min_length=1, max_length=SPLINE_POINTS)]
    knots: list[Annotated[Number, Field(gt=0, lt=1)]] | None = None
    ends: tuple[Literal["natural", "smooth"], Literal["natural", "smooth"]] = ("natural", "natural")

    @model_validator(mode="after")
    def _is_determined(self) -> Self:
        if self.knots is not None:
            if len(self.knots) != len(self.through):
                raise UnitError(f"there are {len(self.knots)} knots for {len(self.through)} points: give one a point")
            if any(b <= a for a, b in pairwise(self.knots)):
                raise UnitError("the knots do not rise from each point to the next: put them in order")
        if self.ends == ("smooth", "smooth") and len(self.through) < 2:
            raise UnitError("a spline with two smooth ends goes through two points or more: add one")
        return self


class PolylineSpec(EdgePart):
    """An edge of straight pieces: ``{ polyline = ["a", "b"], through = [[x, y], ...] }``.

    Args:
        polyline: the vertices where it begins and ends.
        through: its corners between them, in order.
    """

    polyline: tuple[str, str]
    through: Annotated[list[Point], Field(min_length=1, max_length=POLYLINE_POINTS)]


def _check_ends(ends: tuple[str, str]) -> None:
    """Refuses an edge from a vertex to itself."""
    if ends[0] == ends[1]:
        raise UnitError(f"the edge has zero length: it goes from {ends[0]!r} to itself")


EdgeSpec = Annotated[
    Annotated[LineSpec, Tag("<line>")]
    | Annotated[ArcSpec, Tag("<arc>")]
    | Annotated[SplineSpec, Tag("<spline>")]
    | Annotated[PolylineSpec, Tag("<polyline>")],
    tag_by_key(("line", "arc", "spline", "polyline")),
]
