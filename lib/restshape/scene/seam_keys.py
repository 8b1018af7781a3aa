"""What a scene says about its seams."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from restshape.errors import UserError
from restshape.scene.plain_values import Table
from restshape.scene.pleat_keys import PlacedPleat, Pleat
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
        pleats: folds of the first side, by name.
    """

    start: Annotated[Entities, Field(alias="from", description="the edges of the first side")]
    to: Entities
    reverse: bool | None = None
    ease: Annotated[Number, Field(ge=0)] = 0.02
    stitched: Literal["flat"] | None = None
    stiffness: Annotated[Pressure, Field(gt=0)] | None = None
    slack: Annotated[Length, Field(ge=0)] = 0.0
    pleats: dict[str, Pleat] = Field(default_factory=dict)

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
        if self.pleats and self.stitched is not None:
            raise UnitError("nothing bends across a seam with pleats, of three layers", "leave `stitched` out")
        return self


def edges_of(names: str | Sequence[str]) -> tuple[str, ...]:
    """One name, or several, as a tuple."""
    return (names,) if isinstance(names, str) else tuple(names)


def placed_pleats(seams: Mapping[str, Seam], panels: Collection[str]) -> tuple[PlacedPleat, ...]:
    """All pleats of a scene's seams; arguments: these by name, and the names of its panels.

    Raises:
        UserError: one does not say on which of several edges it is, or names one that is not of its seam.
    """
    found = []
    for name, seam in seams.items():
        edges, _ = seam.sides
        for key, pleat in seam.pleats.items():
            edge = edges[0] if pleat.edge is None and len(edges) == 1 else pleat.edge
            if edge not in edges:
                what = (
                    "the pleat does not say on which edge it is" if edge is None else f"{edge!r} is no edge of `from`"
                )
                raise UserError(what, f"seams.{name}.pleats.{key}.edge", f"name one of {', '.join(edges)}")
            panel = edge.partition(".")[0]
            found.append(PlacedPleat(name, key, pleat, edge, panel if panel in panels else ""))
    return tuple(found)
