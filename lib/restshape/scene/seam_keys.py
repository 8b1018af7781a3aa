"""What a scene says about its seams."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from restshape.scene.plain_values import Table
from restshape.scene.units import UnitError
from restshape.scene.values import Entities, Length, Number, Pressure, Strict


class Seam(Strict):
    """``[seams.NAME]``: edges that are sewn together, paired by share of their lengths.

    Several edges on one side are one line, in their order.

    Args:
        start: the edges of the first side.
        to: those of the second side.
        reverse: false where the same face of the cloth is outside on both sides, true where it changes; left out, the
            ends that are nearer to each other at first are sewn together, see `seam_lines.turned_round`.
        ease: how much longer one side may be than the other one, over the length of that, without a note.
        stitched: "flat", the cloth bends across the seam as if it went on; left out, it turns there freely.
        stiffness: of the springs by length [N/m^2]; left out, 100 times the membrane's over the mesh size.
        slack: distance [m] between both sides up to which the seam does not pull: what is gathered folds within it.
    """

    start: Annotated[Entities, Field(alias="from", description="the edges of the first side")]
    to: Entities
    reverse: bool | None = None
    ease: Annotated[Number, Field(ge=0)] = 0.02
    stitched: Literal["flat"] | None = None
    stiffness: Annotated[Pressure, Field(gt=0)] | None = None
    slack: Annotated[Length, Field(ge=0)] = 0.0

    @property
    def sides(self) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """Names of the edges of both sides."""
        return edges_of(self.start), edges_of(self.to)

    @property
    def keys(self) -> Table:
        """What is written of it besides its sides, in SI units."""
        return self.model_dump(exclude={"start", "to"}, exclude_unset=True, exclude_none=True)

    @model_validator(mode="after")
    def _has_two_sides(self) -> Self:
        first, second = self.sides
        both = [*first, *second]
        twice = next((name for name in both if both.count(name) > 1), None)
        if twice is not None:
            raise UnitError(f"the edge {twice!r} would be sewn to itself", "name each edge once in a seam")
        return self


def edges_of(names: str | Sequence[str]) -> tuple[str, ...]:
    """One name, or several, as a tuple."""
    return (names,) if isinstance(names, str) else tuple(names)
