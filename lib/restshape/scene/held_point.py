"""A point of a sheet that a hand holds at a place in space."""

from __future__ import annotations

from typing import TYPE_CHECKING

from restshape.scene.values import Length, Point, Strict

if TYPE_CHECKING:
    from restshape.scene.model import Scene

CLOTH = "cloth"
"""What a press names that takes hold of a point of the sheet."""


class Hold(Strict):
    """``[hold]``: a point of the cloth that is held at a place, as a hand holds it; the nearest node of the mesh is.

    Args:
        at: the point in the pattern plane [m].
        to: the place in space where it is held [m].
    """

    at: Point
    to: tuple[Length, Length, Length]


def can_hold(scene: Scene) -> bool:
    """Whether points of what a scene simulates can be held: a physics of it has registered the table."""
    return Hold in scene.tables


def hold_of(scene: Scene) -> Hold | None:
    """The point that is held; None where none is."""
    key = scene.tables.get(Hold)
    found: Hold | None = getattr(scene, key) if key else None
    return found


def hold_words(hold: Hold) -> str:
    """What is held, for people."""
    at, to = (", ".join(f"{value:.4g}" for value in place) for place in (hold.at, hold.to))
    return f"the point ({at}) m of the pattern at ({to}) m"
