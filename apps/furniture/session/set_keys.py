"""Edited pieces after a key of their scene was set, and what a note says of edits that this takes back."""

from __future__ import annotations

import numpy as np
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.session.without_effect import SAME
from restshape_apps.furniture.shape.plank_scene import redrawn, restated
from restshape_apps.furniture.shape.planks import Piece

from restshape.errors import UserError
from restshape.scene.model import Scene
from restshape.scene.source import split_key

EVENTS = {
    "planks": ("planks", "plank draws one, and delete removes one"),
    "weights": ("weights", "weight puts one on, and delete removes one"),
    "joints": ("joints", "connect joins a plank to what it is near"),
}
"""By the table of a piece: what is in it, and the events that add and remove some."""


def refuse_others(before: Scene, after: Scene) -> None:
    """Refuses a scene that has other planks, weights or joints by name than before: a piece gets them by events.

    Raises:
        UserError: what was added or removed, and the event that does that.
    """
    for table, (what, do) in EVENTS.items():
        old, new = (set(one.joints.named if table == "joints" else getattr(one, table)) for one in (before, after))
        if old != new:
            said = f"adds {', '.join(sorted(new - old))}" if new - old else f"removes {', '.join(sorted(old - new))}"
            raise UserError(f"this {said}, and set does not add or remove {what}", table, f"the event {do}")


def after_set(piece: Piece, before: Scene, after: Scene, key: str) -> Piece:
    """An edited piece after a key was set, its joints not closed yet.

    Args:
        piece: with closed joints.
        before, after: its scene.
        key: dotted.

    Raises:
        UserError: the piece cannot be had.
    """
    return restated(piece, before, after, Furniture(redrawn(piece, before)).moved(), _plank_of(key))


def taken_back(piece: Piece, before: Scene, after: Scene, key: str) -> str:
    """What a note says where a key of a plank sets what edits had changed of it; empty elsewhere."""
    name = _plank_of(key)
    if not name:
        return ""
    try:
        one, other = (Furniture(after_set(piece, before, after, each)).moved() for each in (key, ""))
    except UserError:
        return f"what edits had changed of {name} is taken back where {key} decides it"
    k = one.index(name)
    if np.abs(one.planks[k].corners() - other.planks[k].corners()).max() <= SAME:
        return ""
    return f"what edits had changed of {name} is taken back where {key} decides it"


def _plank_of(key: str) -> str:
    """The plank whose key it is; empty of other keys."""
    table, name, *_ = (*split_key(key), "", "")
    return name if table == "planks" else ""
