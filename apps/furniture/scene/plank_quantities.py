"""Which quantities furniture has, and of which places."""

from __future__ import annotations

from typing import Literal

from restshape.scene.model import Scene
from restshape.scene.quantity import ANY, Quantity, QuantityKind
from restshape.scene.source import Source, suggestion

OF_PLANKS = {
    "reaction": QuantityKind(
        Literal["x", "y", "z"], "force", "sum", reductions=ANY, summary="a component of the force of the floor"
    ),
    "utilisation": QuantityKind(
        Literal["pull", "shear", "largest"],
        "number",
        "max",
        renamed="use",
        summary="share of a joint's strength that is used",
    ),
    "deflection": QuantityKind(Literal[True], "length", "max", renamed="sag", summary="largest deflection of a plank"),
    "stability_margin": QuantityKind(
        Literal[True], "number", "min", whole=True, renamed="margin", summary="how far from tipping"
    ),
    "mass": QuantityKind(Literal[True], "mass", "sum", reductions=ANY, summary="mass of planks"),
    "length": QuantityKind(
        Literal["x", "y", "z"], "length", "sum", reductions=ANY, summary="size of a plank along its own axis"
    ),
}
"""Kinds of quantities that furniture adds: utilisation of joints, deflection, margin of what holds the piece
down, mass, and length along an axis of a plank's own."""

KINDS = tuple(OF_PLANKS)
"""Kinds of quantities that furniture has."""

ENDS = ("-x", "+x", "-y", "+y", "-z", "+z")
"""Sides of a plank: the joint of an end, or the foot of a side, is called by the plank's name and that side."""

OF_ENDS = ("utilisation", "reaction")
"""Kinds that one end may have."""


def place_of(quantity: Quantity) -> tuple[str, str]:
    """The name of the plank at which a quantity is looked at, and the end; both empty: all of the piece."""
    plank, _, end = (quantity.at or "").partition(" ")
    return plank, end


def check_plank_quantities(scene: Scene, source: Source) -> None:
    """Checks the quantities of a piece of furniture.

    Raises:
        UserError: the first thing that makes no sense.
    """
    for name, quantity in scene.quantities.items():
        key, kind = ("quantities", name), quantity.kind
        if kind not in KINDS:
            do = f"use one of: {', '.join(KINDS)}"
            raise source.error((*key, kind), f"furniture has no quantity of the kind {kind!r}", do)
        if kind == "deflection" and "bending" not in scene.effects:
            raise source.error(
                (*key, kind), "without bending planks do not sag", "leave it out, or add [effects.bending]"
            )
        plank, end = place_of(quantity)
        place = (*key, "at")
        if plank and kind == "stability_margin":
            raise source.error(place, "the margin is that of the whole piece", "leave it out")
        if plank and plank not in scene.planks:
            raise source.error(place, f"there is no plank {plank!r}", suggestion(plank, sorted(scene.planks)))
        if end and kind not in OF_ENDS:
            raise source.error(place, f"{kind} is that of a whole plank", f'write at = "{plank}"')
        if end and end not in ENDS:
            raise source.error(place, f"a plank has no end {end!r}", f"use one of: {', '.join(ENDS)}")
