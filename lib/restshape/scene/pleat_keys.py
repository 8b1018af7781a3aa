"""Pleats of seams: what a scene says of them, and where their folds lie on an edge of the pattern."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from pydantic import Field

from restshape.scene.values import Length, Number, Strict

FOLDS = ("first", "second")
"""Last parts of the names of folds."""


class Pleat(Strict):
    """``[seams.NAME.pleats.PLEAT]``: the first side is laid back over a depth, in three layers, all of which are sewn.

    Args:
        edge: of the seam's first side; left out, the only one.
        at: where the middle of the layer that goes back is, as a share of the edge's length from its start.
        depth: of each layer [m]: the seam is shorter by twice as much.
        toward: the end of the edge that the fold on the face of the cloth looks to.
    """

    edge: str | None = None
    at: Annotated[Number, Field(gt=0, lt=1)]
    depth: Annotated[Length, Field(gt=0)]
    toward: Literal["end", "start"] = "end"


@dataclass(frozen=True)
class PlacedPleat:
    """A pleat on an edge of the pattern.

    Args:
        seam, key: its seam, and its name there.
        pleat: what the scene says of it; edge: that it is on.
        panel: that has the edge; "" in a scene of one sheet.
    """

    seam: str
    key: str
    pleat: Pleat
    edge: str
    panel: str = ""

    @property
    def where(self) -> str:
        """The key of its table."""
        return f"seams.{self.seam}.pleats.{self.key}"

    @property
    def folds(self) -> tuple[str, str]:
        """Vertices at its first and its second fold, from the edge's start."""
        before = f"{self.panel}." if self.panel else ""
        first, second = (f"{before}{self.seam}.{self.key}.{fold}" for fold in FOLDS)
        return first, second


def is_fold(vertex: str, seam: str) -> bool:
    """Whether a vertex, as its panel names it, has the name of a fold of a pleat of this seam."""
    return vertex.startswith(f"{seam}.") and vertex.rpartition(".")[2] in FOLDS
