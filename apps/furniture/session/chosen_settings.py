"""Keys that a suggestion sets where formulas of parameters give their values: the parameter is set."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

from restshape_apps.furniture.guidance.remedies import Thickened, as_thick
from restshape_apps.furniture.session.set_keys import after_set
from restshape_apps.furniture.shape.planks import Piece

from restshape.errors import UserError
from restshape.scene.given_numbers import edited_number, given_number
from restshape.scene.load import revise
from restshape.scene.model import Scene
from restshape.scene.source import split_key

THICKNESS = "wood.thickness"
SAME = 1e-9
"""How far thicknesses that are the same may be apart [m]."""


def setting_key(scene: Scene, key: str, value: str | float) -> str:
    """The key that a suggestion sets: that of the parameter where it alone gives the value."""
    try:
        return edited_number(scene, key, value)
    except UserError:
        # A number takes the place of another formula.
        return key


def setting_note(scene: Scene, key: str, value: str | float) -> str:
    """What a note says of a suggestion that sets a key whose value a formula gives; empty elsewhere."""
    given = given_number(scene, split_key(key))
    if not given:
        return ""
    other = setting_key(scene, key, value)
    return (
        f"; set by {other}" if other != key else f"; it takes the place of the formula {given.formula.text.strip()!r}"
    )


def thickened_by(scene: Scene) -> Thickened:
    """What gives all planks of a piece of a scene another thickness, by its parameter where that gives it."""
    if given_number(scene, split_key(THICKNESS)) is None:
        return as_thick

    @cache
    def other(t: float) -> tuple[str, Scene | None]:
        key = setting_key(scene, THICKNESS, t)
        return key, revise(scene, key, t) if key != THICKNESS else None

    def thickened(piece: Piece, t: float) -> Piece:
        key, after = other(t)
        made = after and after_set(piece, scene, after, key)
        if made is None or any(abs(plank.size[2] - t) > SAME for plank in made.planks):
            # Some planks have a thickness of their own.
            return as_thick(piece, t)
        return replace(made, spacing=piece.spacing, joints=piece.joints)

    return thickened
