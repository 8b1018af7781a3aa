"""What mends a weak piece without another drawing: closer or stronger fasteners, thicker planks."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
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

PAIRS = (("thicker", "closer"), ("other", "closer"), ("other", "thicker"))
"""Kinds that are combined where none is enough; of the second one more is taken to be as good."""

Setting = tuple[str, str | float]


@dataclass(frozen=True)
class Remedy:
    """A piece with other fasteners, or planks of another thickness, or both.

    Args:
        name: its kind.
        words: what is changed.
        settings: keys of the scene and their values.
        piece: with that.
    """

    name: str
    words: str
    settings: tuple[Setting, ...]
    piece: Piece


Kind = Callable[[Piece], Iterable[Remedy]]
Obeys = Callable[[Piece], bool]
Thickened = Callable[[Piece, float], Piece]
"""A piece with all planks of a thickness [m]; it raises `UserError` where there is none."""


def as_thick(piece: Piece, t: float) -> Piece:
    """The piece with all planks of a thickness [m], with faces where they lie on each other."""
    planks = tuple(replace(plank, size=np.array([*plank.size[:2], t])) for plank in piece.planks)
    return replace(piece, planks=kept_contacts(piece.planks, planks, piece.planes))


def remedies(
    piece: Piece, obeys: Obeys = lambda piece: True, strict: bool = False, thickened: Thickened = as_thick
) -> tuple[Remedy, ...]:
    """Of each kind the smallest change with which the full test holds; none where none does.

    Where no kind alone is enough, two are tried together: the smallest change of one with which any of the other is
    enough, and the smallest of that.

    Args:
        piece: that does not hold, or is doubtful.
        obeys: whether a piece keeps the limits of quantities; what does goes before smaller changes that do not.
        strict: changes that do not obey are none; thinner planks are tried too.
        thickened: what gives all planks another thickness.
    """

    def thicker(piece: Piece) -> Iterator[Remedy]:
        return _thicker(piece, thickened)

    kinds: dict[str, Kind] = {"closer": _closer, "other": _stronger, "thicker": thicker}
    found = {name: _first(kind(piece), obeys, strict) for name, kind in kinds.items()}
    if strict:
        found["thinner"] = _first(_thinner(piece, thickened), obeys, strict)
    if not any(found.values()):
        enough = obeys if strict else lambda piece: True
        found |= {f"{one} {other}": _pair(piece, kinds[one], kinds[other], enough) for one, other in PAIRS}
    return tuple(one for one in found.values() if one)


def _first(candidates: Iterable[Remedy], obeys: Obeys, strict: bool) -> Remedy | None:
    first = None
    for one in candidates:
        lasting = _lasting(one)
        if lasting and obeys(lasting.piece):
            return lasting
        first = first or (None if strict else lasting)
    return first


def _lasting(one: Remedy) -> Remedy | None:
    """The remedy with its joints closed; None where it does not hold."""
    try:
        furniture = Furniture(one.piece)
        return replace(one, piece=furniture.moved()) if furniture.test().valid else None
    except UserError:
        # These fasteners do not hold there.
        return None


def _pair(piece: Piece, one: Kind, other: Kind, obeys: Obeys) -> Remedy | None:
    """The smallest change of the first kind, together with the smallest of the other one, that is enough.

    More of the other kind is taken to be as good, so that bisection finds the smallest.
    """
    for first in one(piece):
        both = [_both(first, second) for second in other(first.piece)]
        made: dict[int, Remedy | None] = {}

        def enough(k: int, both: Sequence[Remedy] = both, made: dict[int, Remedy | None] = made) -> bool:
            lasting = _lasting(both[k])
            made[k] = lasting if lasting and obeys(lasting.piece) else None
            return made[k] is not None

        if not both or not enough(len(both) - 1):
            continue
        low, high = -1, len(both) - 1
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (low, middle) if enough(middle) else (middle, high)
        return made[high]
    return None


def _both(one: Remedy, other: Remedy) -> Remedy:
    return Remedy(
        f"{one.name} and {other.name}",
        f"{one.words}, and {other.words}",
        one.settings + other.settings,
        other.piece,
    )


def _closer(piece: Piece) -> Iterable[Remedy]:
    """Spacings by whole millimetres, the widest first."""
    least = max((CLOSEST * fastener(joint.fastener).diameter for joint in piece.joints), default=np.inf)
    for mm in range(ceil(1e3 * piece.spacing - 1e-9) - 1, ceil(1e3 * least - 1e-9) - 1, -1):
        words = f"fasteners {mm} mm apart, not {1e3 * piece.spacing:g} mm"
        yield Remedy("closer fasteners", words, (("fastener.spacing", 1e-3 * mm),), replace(piece, spacing=1e-3 * mm))


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
            "other fasteners", f"{name} in place of {usual}", (("fastener.name", name),), replace(piece, joints=joints)
        )


def _thicker(piece: Piece, thickened: Thickened) -> Iterator[Remedy]:
    """All planks thicker, where all are as thick, up to twice; the thinnest first."""
    thick = _thickness(piece)
    return _of_thickness(piece, [t for t in THICKNESSES if thick + 1e-9 < t <= 2.0 * thick], "thicker", thickened)


def _thinner(piece: Piece, thickened: Thickened) -> Iterator[Remedy]:
    """All planks thinner, where all are as thick, down to half; the thickest first."""
    thick = _thickness(piece)
    thinner = [t for t in THICKNESSES[::-1] if 0.5 * thick <= t < thick - 1e-9]
    return _of_thickness(piece, thinner, "thinner", thickened)


def _thickness(piece: Piece) -> float:
    """The thickness of all planks [m]; nan where they differ."""
    thick = float(piece.planks[0].size[2])
    return thick if all(abs(float(plank.size[2]) - thick) <= 1e-9 for plank in piece.planks) else np.nan


def _of_thickness(piece: Piece, thicknesses: Sequence[float], name: str, thickened: Thickened) -> Iterator[Remedy]:
    """All planks of each of these thicknesses [m] that can be had."""
    for t in thicknesses:
        try:
            other = thickened(piece, t)
        except UserError:
            # Formulas of the scene give no planks then.
            continue
        words = f"planks {1e3 * t:g} mm thick, not {1e3 * _thickness(piece):g} mm"
        yield Remedy(f"{name} planks", words, (("wood.thickness", t),), other)
