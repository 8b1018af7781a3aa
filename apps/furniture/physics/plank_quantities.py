"""Quantities of interest of furniture: numbers that a scene asks for, taken from a piece and its forces."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from restshape_apps.furniture.physics.furniture import Forces, Geometry
from restshape_apps.furniture.physics.plank_findings import beyond_reach
from restshape_apps.furniture.physics.plank_phrases import amount_beyond_reach
from restshape_apps.furniture.scene.plank_quantities import ENDS, place_of
from restshape_apps.furniture.shape.plank_gaps import gap_at
from restshape_apps.furniture.shape.planks import Piece

from restshape.errors import UserError
from restshape.fem.observer import REDUCTIONS
from restshape.scene.model import Quantity

AXES = "xyz"


@dataclass(frozen=True)
class Observed:
    """What is known of a piece in a frame.

    Args:
        piece: its planks, joints and feet by number.
        geometry: as it is in the frame.
        forces: of each case; empty where there is no equilibrium.
        deflection: (n,) of the planks over all cases [m], nan where it is not known.
        stability_margin: the least of what holds it down.
    """

    piece: Piece
    geometry: Geometry
    forces: Sequence[Forces]
    deflection: np.ndarray
    stability_margin: float


def plank_quantities(quantities: Mapping[str, Quantity], known: Observed) -> dict[str, float]:
    """All quantities by name; not a number where the piece has no such plank, joint or foot, or no equilibrium."""
    found = {}
    for name, quantity in quantities.items():
        values = _values(quantity, known)
        found[name] = float(REDUCTIONS[quantity.reduce](values)) if len(values) else np.nan
    return found


def require_places(quantities: Mapping[str, Quantity], piece: Piece) -> None:
    """Make sure that a piece has the joints and feet that quantities name.

    Raises:
        UserError: it does not.
    """
    for name, quantity in quantities.items():
        rows = {"utilisation": joints_at, "reaction": feet_at}.get(quantity.kind)
        if rows is None or not quantity.at or len(rows(quantity, piece)):
            continue
        what = "joint" if quantity.utilisation else "foot"
        ends = [(joint.i, joint.side) for joint in piece.joints] if quantity.utilisation else []
        ends += [] if quantity.utilisation else [(foot.plank, foot.side) for foot in piece.feet]
        there = ", ".join(f"{piece.planks[plank].name} {ENDS[side]}" for plank, side in ends) or "none"
        far = _too_far(quantity, piece) if quantity.utilisation else ""
        do = f"there are: {there}" + f"; {far}" * bool(far)
        raise UserError(f"there is no {what} at {quantity.at!r}", f"quantities.{name}.at", do)


def _too_far(quantity: Quantity, piece: Piece) -> str:
    """How far a plank, or an end of it, is from what a joint could hold it to; empty where joints reach it."""
    plank, end = place_of(quantity)
    number = next((k for k, one in enumerate(piece.planks) if one.name == plank), None)
    if number is None or end in ENDS[4:]:
        # Faces take ends, and are joined by no end of their own.
        return ""
    far = beyond_reach(piece, gap_at(piece, number, ENDS.index(end) if end else None))
    return amount_beyond_reach(far) if far else ""


def joints_at(quantity: Quantity, piece: Piece) -> list[int]:
    """The joints of a plank, through which its ends are held or hold others, or the one of an end of it; or all."""
    plank, end = place_of(quantity)
    names = [one.name for one in piece.planks]
    return [
        k
        for k, joint in enumerate(piece.joints)
        if not plank
        or (names[joint.i] == plank and end in ("", ENDS[joint.side]))
        or (names[joint.j] == plank and not end)
    ]


def feet_at(quantity: Quantity, piece: Piece) -> list[int]:
    """The feet of a plank, or the one of an end of it; or all."""
    plank, end = place_of(quantity)
    return [
        k
        for k, foot in enumerate(piece.feet)
        if not plank or (piece.planks[foot.plank].name == plank and end in ("", ENDS[foot.side]))
    ]


def _values(quantity: Quantity, known: Observed) -> np.ndarray:
    """The numbers (k,) of which a quantity is one."""
    piece = known.piece
    if quantity.stability_margin:
        return np.array([known.stability_margin])
    if quantity.utilisation:
        rows = joints_at(quantity, piece)
        return _utilisation(quantity.utilisation, known.forces)[rows] if known.forces else np.zeros(0)
    if quantity.reaction:
        if not known.forces:
            return np.zeros(0)
        feet = known.forces[0].contacts.reshape(-1, 4, 3).sum(axis=1)
        return feet[feet_at(quantity, piece), AXES.index(quantity.reaction)]
    plank, _ = place_of(quantity)
    chosen = np.array([not plank or one.name == plank for one in piece.planks])
    if quantity.length:
        return known.geometry.size[chosen, AXES.index(quantity.length)]
    return (known.geometry.mass if quantity.mass else known.deflection)[chosen]


def _utilisation(kind: str, forces: Sequence[Forces]) -> np.ndarray:
    """The utilisation (j,) of each joint's strength, the largest of all cases."""
    pull, shear = (
        np.max([getattr(one, name) for one in forces], axis=0) for name in ("pull_utilisation", "shear_utilisation")
    )
    return {"pull": pull, "shear": shear, "largest": np.max([one.utilisation for one in forces], axis=0)}[kind]
