"""Edits of a piece that change what it is made of: planks added and deleted, joints made by nearness, weights put."""

from collections.abc import Iterable
from dataclasses import replace

from restshape_apps.furniture.shape.planks import NEAR, Foot, Load, Piece, Plank, feet_near, joints_near

from restshape.errors import UserError


def added(piece: Piece, plank: Plank, near: float = NEAR, fastener: str = "nail-thesis") -> Piece:
    """The piece with a plank more, joined to what is near it and standing on the floor if it reaches it.

    Raises:
        UserError: there is a plank of that name.
    """
    if any(plank.name == other.name for other in piece.planks):
        raise UserError(f"there is a plank {plank.name} already", piece.name, "give it another name")
    grown = replace(piece, planks=(*piece.planks, plank))
    return connected(grown, len(piece.planks), near, fastener)


def connected(piece: Piece, plank: int, near: float = NEAR, fastener: str = "nail-thesis") -> Piece:
    """The piece with joints and feet wherever a plank has come near others or the floor; those it has are kept.

    The rule is that of drawn pieces: see `joints_near` and `feet_near`.
    """
    more = joints_near(piece.planks, near, (plank,), fastener, piece.joints, piece.feet)
    joints = (*piece.joints, *more)
    standing = {(foot.plank, foot.side) for foot in piece.feet}
    feet = [
        foot
        for foot in feet_near(piece.planks, near, piece.planes, joints)
        if foot.plank == plank and (foot.plank, foot.side) not in standing
    ]
    return replace(piece, joints=joints, feet=(*piece.feet, *feet))


def removed(piece: Piece, plank: int) -> Piece:
    """The piece without a plank, its joints, feet and loads.

    Raises:
        UserError: it is the only one.
    """
    if len(piece.planks) == 1:
        raise UserError("a piece keeps at least one plank", piece.name, "delete another one, or start again")
    number = [k - (k > plank) for k in range(len(piece.planks))]

    def kept(loads: Iterable[Load]) -> tuple[Load, ...]:
        return tuple(replace(load, plank=number[load.plank]) for load in loads if load.plank != plank)

    return replace(
        piece,
        planks=(*piece.planks[:plank], *piece.planks[plank + 1 :]),
        joints=tuple(
            replace(joint, i=number[joint.i], j=number[joint.j])
            for joint in piece.joints
            if plank not in (joint.i, joint.j)
        ),
        feet=tuple(Foot(number[foot.plank], foot.side, foot.plane) for foot in piece.feet if foot.plank != plank),
        weights=kept(piece.weights),
        pushes=kept(piece.pushes),
    )


def loaded(piece: Piece, load: Load) -> Piece:
    """The piece with a weight more; one of the same name is replaced."""
    return replace(piece, weights=(*(old for old in piece.weights if old.name != load.name), load))
