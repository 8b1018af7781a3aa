"""What is wrong with a piece of furniture, in words that name its planks, joints and loads."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import ceil

from restshape.shape.planks import Piece, parts_of

USES = re.compile(r" at \S+ of its (?:shear )?strength")

SHOWN = 3
"""Names of one kind that are told; of more it is told how many there are."""

SLANT, LENGTH, GAP, MISSED, FOOT, BEHIND = 1, 2, 3, 4, 5, 6
"""Numbers of faults of the geometry."""

FAULTS = {
    SLANT: "{plank} lies too flat on {other}",
    LENGTH: "{plank} has no length left",
    GAP: "{plank} is not flush with {other}",
    MISSED: "{plank} misses {other}",
    FOOT: "{plank} does not stand flat on {other}",
    BEHIND: "{plank} comes to {other} from behind",
}


@dataclass(frozen=True)
class Findings:
    """What is wrong, by numbers.

    Args:
        faults: number of `FAULTS`, and the end (4 plank + side) of a slant or from behind, the plank of a length, else
            the joint or foot.
        overlaps: pairs of planks; a plank and -1 - k where it goes through plane k.
        falls: case, and the first plank of the part of the piece that falls in it.
        unbalanced: cases without an equilibrium.
        broken: joint, case, use in parts of its strength, and whether that is of shear.
    """

    faults: Sequence[tuple[int, int]] = ()
    overlaps: Sequence[tuple[int, int]] = ()
    falls: Sequence[tuple[int, int]] = ()
    unbalanced: Sequence[int] = ()
    broken: Sequence[tuple[int, int, float, bool]] = ()


def joint_name(piece: Piece, joint: int) -> str:
    """What a joint is called: the plank whose end it holds, on the one whose face it is at."""
    one = piece.joints[joint]
    return f"{piece.planks[one.i].name} on {piece.planks[one.j].name}"


def lost(piece: Piece, found: Findings) -> str:
    """Joints and feet that are lost, and how."""
    told: dict[object, str] = {}
    for fault, where in found.faults:
        key, plank, other = _place(piece, fault, where)
        # An end that cannot be closed is not flush either.
        told.setdefault(key, FAULTS[fault].format(plank=piece.planks[plank].name, other=other))
    return f"lost: {_listed(told.values())}" if told else "a joint is lost"


def overlapping(piece: Piece, found: Findings) -> str:
    """Planks that are in each other, and in the floor."""
    names = [plank.name for plank in piece.planks]
    pairs = [f"{names[i]} and {names[j] if j >= 0 else _plane(-1 - j)}" for i, j in found.overlaps]
    return f"overlapping: {_listed(pairs)}" if pairs else "planks overlap"


def apart(piece: Piece) -> str:
    """The parts that no joint connects."""
    parts = parts_of(piece)
    return f"in {_count(len(parts))} parts: {_listed(_part(piece, part) for part in parts)}"


def falls(piece: Piece, found: Findings) -> str:
    """Loads that it falls under, and what falls where it is in parts."""
    if not found.falls:
        return "falls"
    cases = dict.fromkeys(_load(piece, case) for case, _ in found.falls)
    parts = parts_of(piece)
    down = {first for _, first in found.falls}
    named = [_part(piece, part) for part in parts if down & set(part)] if len(parts) > 1 else []
    return f"falls under {_listed(cases)}" + (f": {_listed(named)}" if named else "")


def weak(piece: Piece, found: Findings) -> str:
    """Joints that break, the worst first."""
    # Joints that differ by rounding alone stay in their order.
    broken = sorted(found.broken, key=lambda one: -round(one[2], 6))
    told = [
        f"{joint_name(piece, k)} at {_share(use)} of its {'shear ' if sheared else ''}strength"
        + (f" under {_load(piece, case)}" if case else "")
        for k, case, use, sheared in broken
    ]
    return f"weak: joint {_listed(told)}" if told else "a joint is weak"


def unbalanced(piece: Piece, found: Findings) -> str:
    """Loads without an equilibrium."""
    cases = [_load(piece, case) for case in found.unbalanced]
    return f"no equilibrium was found{' under ' + _listed(cases) if cases else ''}"


def without_uses(words: str) -> str:
    """What is wrong, without how much of its strength each joint bears, which changes from frame to frame."""
    return USES.sub("", words)


def held_by_springs(piece: Piece, cases: Sequence[int]) -> str:
    """Loads under which contacts act as springs that also pull; empty without any."""
    if not cases:
        return ""
    told = _listed(_load(piece, case) for case in cases)
    return f"forces under {told} are of feet that springs hold: with feet that only push no equilibrium was found"


def _place(piece: Piece, fault: int, where: int) -> tuple[object, int, str]:
    """What has a fault (a joint, a foot or a plank), the plank, and what that is held by."""
    if fault == LENGTH:
        return ("plank", where), where, ""
    if fault in (GAP, MISSED):
        return ("joint", where), piece.joints[where].i, piece.planks[piece.joints[where].j].name
    if fault == FOOT:
        return ("foot", where), piece.feet[where].plank, _plane(piece.feet[where].plane)
    for k, joint in enumerate(piece.joints):
        if (joint.i, joint.side) == divmod(where, 4):
            return ("joint", k), joint.i, piece.planks[joint.j].name
    k, foot = next((k, foot) for k, foot in enumerate(piece.feet) if (foot.plank, foot.side) == divmod(where, 4))
    return ("foot", k), foot.plank, _plane(foot.plane)


def _plane(number: int) -> str:
    """What a plane is called: the floor is the first."""
    return "the floor" if number == 0 else f"plane {number}"


def _load(piece: Piece, case: int) -> str:
    """What a case is called: the weights alone, or a push beside them."""
    return "its weights" if case == 0 else f"push {piece.pushes[case - 1].name}"


def _part(piece: Piece, planks: Sequence[int]) -> str:
    """What a part of the piece is called."""
    first = piece.planks[planks[0]].name
    return first if len(planks) == 1 else f"{first} with {len(planks) - 1} more"


def _count(number: int) -> str:
    return {2: "two", 3: "three"}.get(number, str(number))


def _share(use: float) -> str:
    """A use of more than 1, which does not look like 1."""
    return f"{ceil(use * 100) / 100:.2f}" if use < 100 else f"{use:.3g}"


def _listed(names: Iterable[str]) -> str:
    """Names, the first of them where there are many."""
    names = list(names)
    more = len(names) - SHOWN
    return ", ".join(names[:SHOWN]) + (f" and {more} more" if more > 0 else "")
