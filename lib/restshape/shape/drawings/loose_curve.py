"""Loose curves, as drawing files hold them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from restshape.arrays import Reals
from restshape.bounds import OUTLINE_PIECES
from restshape.errors import UserError


@dataclass
class Curve:
    """A loose curve.

    Args:
        points: (n, 2) [m]: start, what it interpolates, end.
        bulge: of an arc of two points; kind: "line", "arc", "spline" or "polyline".
        label: name of its layer or Physical group; "" for none.
        source: what it is in the file, for messages.
        region: the name of the region that it bounds, if any.
        loop: the name that a loop of such curves alone has; "": none.
        knots, ends: of a spline, see `restshape.shape.outline.Edge`; no knots: by the lengths of its chords.
    """

    points: Reals
    kind: str
    label: str = ""
    bulge: float = 0.0
    source: str = ""
    region: str | None = None
    loop: str = ""
    knots: tuple[float, ...] = ()
    ends: tuple[str, str] = ("natural", "natural")


@dataclass
class LooseCurves:
    """What a reader finds in a file.

    Args:
        curves: in metres.
        notes: what was chosen of the file.
        doubt: what the file does not say of its unit, and what is taken; "": it says its unit.
        points: (2,) by name [m]: of vertices where they lie at ends of curves, else inside of the material.
    """

    curves: list[Curve]
    notes: tuple[str, ...] = ()
    doubt: str = ""
    points: dict[str, Reals] = field(default_factory=dict)


def gathered(parts: Iterable[list[Curve]], where: str) -> list[Curve]:
    """All curves of a drawing, as far as a shape may have so many.

    Args:
        parts: curves, made one after the other.
        where: the file, for messages.

    Raises:
        UserError: they have more points than `bounds.OUTLINE_PIECES`; no further part is made.
    """
    found: list[Curve] = []
    points = 0
    for part in parts:
        found += part
        points += sum(len(curve.points) for curve in part)
        if points > 2 * OUTLINE_PIECES:
            what = f"the curves of the drawing have more than {2 * OUTLINE_PIECES} points"
            raise UserError(what, where, "draw less, or read some layers alone: shape.layers")
    return found
