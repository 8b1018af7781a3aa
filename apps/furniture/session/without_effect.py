"""Why a key of a scene that was set changes nothing of a piece."""

from __future__ import annotations

import numpy as np
from restshape_apps.furniture.shape.planks import Piece

from restshape.scene.given_numbers import given_numbers, value_at
from restshape.scene.model import Scene
from restshape.scene.source import split_key

OF_PIECES = ("planks", "wood", "fastener", "joints", "floor", "weights", "pushes")
"""Tables that a piece is made of."""
SAME = 1e-9
"""How far corners of the same piece may be apart [m]."""


def without_effect(key: str, before: tuple[Piece, Scene], after: tuple[Piece, Scene]) -> str:
    """What a note says of a key that was set to another value and changes nothing; empty where it changes something.

    Args:
        key: dotted.
        before, after: the piece and its scene, before and after it was set.
    """
    if value_at(before[1], key) == value_at(after[1], key) or not same_piece(before[0], after[0]):
        return ""
    table, *_ = split_key(key)
    followers = _followers(after[1], key) if table == "parameters" else [key]
    if not followers:
        return f"{key} changes nothing: no formula uses it now"
    if any(split_key(one)[0] not in OF_PIECES for one in followers):
        # Limits and settings of effects are none of the piece.
        return ""
    also = f" through {', '.join(followers[:3])}{' and more' * (len(followers) > 3)}" if followers != [key] else ""
    return f"{key} changes nothing{also}: joints, feet or earlier edits decide that"


def same_piece(one: Piece, other: Piece) -> bool:
    """Whether two pieces are the same to rounding."""
    if len(one.planks) != len(other.planks):
        return False
    tables = ("joints", "feet", "planes", "weights", "pushes", "gravity", "spacing", "reach", "moments")
    return all(getattr(one, name) == getattr(other, name) for name in tables) and all(
        a.name == b.name and a.wood == b.wood and np.abs(a.corners() - b.corners()).max() <= SAME
        for a, b in zip(one.planks, other.planks)
    )


def _followers(scene: Scene, key: str) -> list[str]:
    """Keys whose formulas have a parameter, or one that follows it."""
    given, names, found = given_numbers(scene), {split_key(key)[1]}, dict[str, None]()
    for _ in given:
        for one in given:
            if names & set(one.formula.parameters):
                found[".".join(one.key)] = None
                names |= {one.key[1]} if one.key[0] == "parameters" else set()
    return [one for one in found if split_key(one)[0] != "parameters"]
