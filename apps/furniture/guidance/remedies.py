"""What mends a weak piece without another drawing: closer or stronger fasteners, thicker planks."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from math import ceil

import numpy as np
from restshape_apps.furniture.physics.fasteners import fastener
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.shape.face_contacts import kept_contacts
from restshape_apps.furniture.shape.planks import Piece

from restshape.errors import UserError

CLOSEST = 5.0
"""Least distance of fasteners in diameters (EN 1995-1-1:2004, table 8.2, across the grain)."""
USUAL = ("nail", "screw", "dowel")
"""Fasteners that are suggested: those of the thesis and its experiment are models of one nail."""
THICKNESSES = (0.012, 0.015, 0.016, 0.018, 0.019, 0.022, 0.025, 0.028, 0.03, 0.038, 0.04)
"""Usual thicknesses of boards [m]."""

Setting = tuple[str, str | float]


@dataclass(frozen=True)
class Remedy:
    """A piece with other fasteners or thicker planks that holds.

    Args:
        name: its kind.
        words: what is changed.
        setting: key of the scene and its value.
        piece: with that, its joints closed.
    """

    name: str
    words: str
    setting: Setting
    piece: Piece


def remedies(piece: Piece, obeys: Callable[[Piece], bool] = lambda piece: True) -> tuple[Remedy, ...]:
    """Of each kind the smallest change with which the full test holds; none where none does.

    Args:
        piece: that does not hold.
        obeys: whether a piece keeps the limits of quantities; what does goes before smaller changes that do not.
    """
    found = (_first(kind(piece), obeys) for kind in (_closer, _stronger, _thicker))
    return tuple(one for one in found if one)


def _first(candidates: Iterable[Remedy], obeys: Callable[[Piece], bool]) -> Remedy | None:
    first = None
    for one in candidates:
        try:
            furniture = Furniture(one.piece)
            if furniture.test().valid:
                lasting = replace(one, piece=furniture.moved())
                if obeys(lasting.piece):
                    return lasting
                first = first or lasting
        except UserError:
            # These fasteners do not hold there.
            continue
    return first


def _closer(piece: Piece) -> Iterable[Remedy]:
    """Spacings by whole millimetres, the widest first."""
    least = max((CLOSEST * fastener(joint.fastener).diameter for joint in piece.joints), default=np.inf)
    for mm in range(ceil(1e3 * piece.spacing - 1e-9) - 1, ceil(1e3 * least - 1e-9) - 1, -1):
        words = f"fasteners {mm} mm apart, not {1e3 * piece.spacing:g} mm"
        yield Remedy("closer fasteners", words, ("fastener.spacing", 1e-3 * mm), replace(piece, spacing=1e-3 * mm))


def _stronger(piece: Piece) -> Iterable[Remedy]:
    """Other fasteners in all joints that have the usual ones."""
    names = [joint.fastener for joint in piece.joints]
    usual = max(dict.fromkeys(names), key=names.count)
    for name in USUAL:
        # Those that stand too close for their diameter are no remedy.
        if name == usual or CLOSEST * fastener(name).diameter > piece.spacing + 1e-9:
            continue
        joints = tuple(replace(one, fastener=name) if one.fastener == usual else one for one in piece.joints)
        yield Remedy(
            "other fasteners", f"{name} in place of {usual}", ("fastener.name", name), replace(piece, joints=joints)
        )


def _thicker(piece: Piece) -> Iterable[Remedy]:
    """All planks thicker, where all are as thick, with faces where they lie on each other; the thinnest first."""
    thick = float(piece.planks[0].size[2])
    if any(abs(float(plank.size[2]) - thick) > 1e-9 for plank in piece.planks):
        return
    for t in THICKNESSES:
        if thick + 1e-9 < t <= 2.0 * thick:
            planks = tuple(replace(plank, size=np.array([*plank.size[:2], t])) for plank in piece.planks)
            planks = kept_contacts(piece.planks, planks, piece.planes)
            words = f"planks {1e3 * t:g} mm thick, not {1e3 * thick:g} mm"
            yield Remedy("thicker planks", words, ("wood.thickness", t), replace(piece, planks=planks))
