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
