"""What to do about a piece that slides where no change of its shape holds it."""

from math import isfinite

from restshape_apps.furniture.physics import plank_findings as kinds
from restshape_apps.furniture.physics.furniture import Furniture, enough_mass
from restshape_apps.furniture.physics.plank_phrases import rounded_up
from restshape_apps.furniture.shape.planks import Piece


def why_slides(piece: Piece) -> str:
    """The friction of the floor and the mass that would hold a piece that only slides; empty of another one."""
    falls = [one for one in Furniture(piece).test().findings if one.kind == kinds.FALLS]
    if not falls or any(one.detail != kinds.SLIDES or one.value is None for one in falls):
        return ""
    needed = rounded_up(max(one.value or 0.0 for one in falls))
    mass = enough_mass(piece)
    more = f", or {rounded_up(mass)} kg more on it" if isfinite(mass) else ""
    return f"a friction of {needed} would hold it ([floor] friction is {piece.planes[0].mu:.4g}){more}"
