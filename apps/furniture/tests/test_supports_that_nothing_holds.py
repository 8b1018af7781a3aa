"""Support planks of a wood in which no strength of their fasteners is known."""

from dataclasses import replace

from restshape_apps.furniture.guidance.support_planks import support_planks
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.pieces import shelf_1


def test_supports_whose_fasteners_do_not_hold_are_left_out() -> None:
    piece = shelf_1()
    assert len(support_planks(model(piece))) == 1
    # Supports take the fastener of the first joint, and the wood of the plank beside which they stand, MDF.
    first, *others = piece.joints
    planks = list(piece.planks)
    planks[first.i] = replace(planks[first.i], wood="pine")
    furniture = model(replace(piece, planks=tuple(planks), joints=(replace(first, fastener="nail"), *others)))
    assert support_planks(furniture) == ()


def model(piece) -> Furniture:
    """A tested model of a piece."""
    furniture = Furniture(piece)
    furniture.test()
    return furniture
