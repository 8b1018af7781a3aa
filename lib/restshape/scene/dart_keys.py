"""What a scene says of a dart, and where that lies in the pattern plane."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from restshape.scene.seam_keys import Seam
from restshape.scene.units import UnitError
from restshape.scene.values import Angle, Length, Number, Point, Pressure, Strict

Pair = tuple[float, float]


IMAGE = "mirror"
"""What names of the other half of a panel that is cut on the fold begin with, and the name of the region that it is."""

END = 1e-9
"""Share of an edge's length from an end up to which a place is that end."""


# More than 15 attributes: each is a key of a table.
class Dart(Strict):
    """``[darts.NAME]``: a dart on an edge, whose legs meet at its tip, or like a diamond inside a panel.

    Its legs have one length, and become the seam of its name.

    Args:
        panel: the panel that it is in; left out, that of the edge, or the only one.
        edge: the edge that it opens at; left out, it lies inside, along its line.
        at: where the middle of its mouth is along that edge, as a share of its length.
        angle: from the edge's normal, which points into the cloth, to the dart, counter-clockwise.
        line: two points of the panel: the middle of its mouth, which goes to the nearest place of the edge, and its
            tip; or both tips of one inside.
        length: from the edge to its tip; left out, that of the line.
        width: of its mouth, or where it is widest: how much cloth it takes in.
        widest: where one inside is widest, as a share of its line.
        mouth: "kept", the edge stays as it is beside the dart; "straight", both parts of it are turned so that they
            are one straight line where the dart is sewn.
        folded: the cloth between the legs stays, as a fold behind the seam; else it is cut out.
        stitched, stiffness, ease: of the seam.
    """

    panel: str | None = None
    edge: str | None = None
    at: Annotated[Number, Field(ge=0, le=1)] | None = None
    angle: Angle = 0.0
    line: tuple[Point, Point] | None = None
    length: Annotated[Length, Field(gt=0)] | None = None
    width: Annotated[Length, Field(gt=0)]
    widest: Annotated[Number, Field(gt=0, lt=1)] = 0.5
    mouth: Literal["kept", "straight"] = "kept"
    folded: bool = False
    stitched: Literal["flat"] | None = None
    stiffness: Annotated[Pressure, Field(gt=0)] | None = None
    ease: Annotated[Number, Field(ge=0)] = 0.02

    @model_validator(mode="after")
    def _has_one_place(self) -> Self:
        if self.edge is None and self.line is None:
            raise UnitError("the dart has no place", "give it an edge that it opens at, or a line inside a panel")
        if self.line is None and self.length is None:
            raise UnitError("the dart has no length", "give it a length, or a line from its mouth to its tip")
        if self.line is not None and self.line[0] == self.line[1]:
            raise UnitError("both points of the dart's line are one", "give two that differ")
        of_edge = [key for key in ("at", "angle", "mouth", "length") if key in self.model_fields_set]
        if self.edge is None and of_edge:
            raise UnitError(f"{of_edge[0]!r} is of a dart on an edge, and this one names none", "leave it out")
        twice = [key for key in ("at", "angle") if key in self.model_fields_set]
        if self.line is not None and twice:
            raise UnitError(f"the dart's line and {twice[0]!r} both say where it lies", "keep one of them")
        if self.folded and self.stitched is not None:
            raise UnitError(
                "a folded dart has cloth on both sides of its seam, which nothing bends across", "leave `stitched` out"
            )
        if self.edge is not None and "widest" in self.model_fields_set:
            raise UnitError("a dart on an edge is widest there", "leave `widest` out")
        return self


@dataclass(frozen=True)
class PlacedDart:
    """A dart in the pattern plane.

    Args:
        name: what names of its parts begin with; key: of the scene's table.
        dart: what the scene says of it.
        edge: the edge that it opens at; None: it lies inside.
        at: share of the edge's length; None: by the line.
        line: two points [m] of the pattern plane, as of `Dart`, or None.
        angle: from the edge's normal [rad].
        image: it is the mirror image of a dart in the other half of its panel: its left and right are the other's.
        fold: the edge that its panel is unfolded about, if it lies on that; else empty.
    """

    name: str
    key: str
    dart: Dart
    edge: str | None
    at: float | None
    line: tuple[Pair, Pair] | None
    angle: float
    image: bool = False
    fold: str = ""

    @property
    def where(self) -> str:
        """The key of its table."""
        return f"darts.{self.key}"

    @property
    def seam_name(self) -> str:
        """The name of its seam."""
        return f"{IMAGE}_{self.key}" if self.image else self.key

    @property
    def legs(self) -> tuple[list[str], list[str]]:
        """Edges of its left and its right leg, seen from its mouth."""
        left, right = ([f"{self.name}.{side}"] for side in ("left", "right"))
        if self.edge is not None:
            return left, right
        return [f"{left[0]}.{i}" for i in (1, 2)], [f"{right[0]}.{i}" for i in (1, 2)]

    def kinds(self) -> dict[str, str]:
        """Every name that it gives, with what it names."""
        inside, folded = self.edge is None, self.dart.folded
        points = ("foot", "tip", "widest_left", "widest_right") if inside else ("tip", "mouth_left", "mouth_right")
        edges = ["left", "right", *(["fold"] if folded else []), *(["mouth"] if folded and not inside else [])]
        found = {self.name: "hole" if inside and not folded else "group"}
        found |= {f"{self.name}.{point}": "vertex" for point in points}
        found |= {f"{self.name}.{edge}": "edge" for edge in edges}
        found |= {f"{self.name}.half_{side}": "region" for side in ("left", "right") if folded}
        return found | {leg: "edge" for side in self.legs for leg in side}

    @property
    def seam(self) -> Seam:
        """What sews its legs together."""
        keys = {key: getattr(self.dart, key) for key in ("stitched", "stiffness", "ease")}
        left, right = self.legs
        return Seam.model_construct(start=left, to=right, reverse=None, **keys)


def dart_of_part(darts: Sequence[PlacedDart], name: str) -> PlacedDart | None:
    """The dart that has a part of this name."""
    return next((dart for dart in darts if name in dart.kinds()), None)
