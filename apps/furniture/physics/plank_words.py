"""What is wrong with a piece of furniture, in words that name its planks, joints and loads."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np
from restshape_apps.furniture.shape.plank_gaps import Gap, gap_between_parts, gap_of
from restshape_apps.furniture.shape.planks import SIDES, Piece, parts_of

USES = re.compile(r" at \S+ of its (?:shear )?strength")

GAPS = re.compile(r" \([^()]* is (\S+) mm from [^()]*, beyond the reach of \S+ mm of joints\)")
"""How far two parts of a piece are from each other."""

DISTANCES = re.compile(r", (\S+) mm from it")
"""How far a plank is from the one that a joint should hold it to."""

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

FAR_SLANT = "{plank} does not point at {other}"
"""What is said of a slant where the two planks are farther from each other than joints reach."""


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
    told: dict[tuple[str, int], str] = {}
    for fault, where in found.faults:
        key, plank, other = _place(piece, fault, where)
        # An end that cannot be closed is not flush either.
        if key not in told:
            told[key] = _fault(piece, fault, key).format(plank=piece.planks[plank].name, other=other)
    return f"lost: {_listed(told.values())}" if told else "a joint is lost"


def overlapping(piece: Piece, found: Findings) -> str:
    """Planks that are in each other, and in the floor."""
    names = [plank.name for plank in piece.planks]
    pairs = [f"{names[i]} and {names[j] if j >= 0 else _plane(-1 - j)}" for i, j in found.overlaps]
    return f"overlapping: {_listed(pairs)}" if pairs else "planks overlap"


def apart(piece: Piece) -> str:
    """The parts that no joint connects, and how far two of them are from each other where no joint could reach."""
    parts = parts_of(piece)
    gap = beyond_reach(piece, gap_between_parts(piece))
    return f"in {_count(len(parts))} parts: {_listed(_part(piece, part) for part in parts)}" + f" ({gap})" * bool(gap)


def beyond_reach(piece: Piece, gap: Gap | None) -> str:
    """How far an end is from a plank, farther than joints reach; empty where it is not, or where there is no gap."""
    if gap is None or gap.size <= piece.reach:
        return ""
    far, reach = _two_lengths(gap.size, piece.reach)
    end = f"{piece.planks[gap.i].name} {SIDES[gap.side]}"
    return f"{end} is {far} mm from {piece.planks[gap.j].name}, beyond the reach of {reach} mm of joints"


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
    """What is wrong, without how much of its strength each joint bears and how far planks are from each other, which
    change from frame to frame."""
    return DISTANCES.sub("", GAPS.sub("", USES.sub("", words)))


def held_by_springs(piece: Piece, cases: Sequence[int]) -> str:
    """Loads under which contacts act as springs that also pull; empty without any."""
    if not cases:
        return ""
    told = _listed(_load(piece, case) for case in cases)
    return f"forces under {told} are of feet that springs hold: with feet that only push no equilibrium was found"


def uncounted(piece: Piece, bent: Sequence[int], twisted: Sequence[int]) -> str:
    """Joints with moments that the verdict does not count, more than their fasteners bear; empty without any."""
    told = [
        f"{how} {_listed(joint_name(piece, k) for k in joints)}"
        for how, joints in (("bends joint", bent), ("twists joint", twisted))
        if joints
    ]
    return f"not in the verdict: what {' and '.join(told)} is more than the fasteners bear" if told else ""


def _fault(piece: Piece, fault: int, key: tuple[str, int]) -> str:
    """What is said of a fault, with how far the two planks of a joint are from each other if joints do not reach."""
    what, number = key
    if what != "joint":
        return FAULTS[fault]
    joint = piece.joints[number]
    size = gap_of(piece, joint.i, joint.side, joint.j).size
    if size <= piece.reach:
        return FAULTS[fault]
    said = FAR_SLANT if fault == SLANT else FAULTS[fault]
    return f"{said}, {_two_lengths(size, piece.reach)[0]} mm from it"


def _two_lengths(one: float, other: float) -> tuple[str, str]:
    """Two lengths [m] in mm, with as many digits as tell them apart."""
    texts = [tuple(_digits(1e3 * length, n) for length in (one, other)) for n in (4, 8, 17)]
    return next((pair for pair in texts if pair[0] != pair[1]), texts[-1])


def _digits(value: float, count: int) -> str:
    """A number with so many digits, without a power of ten."""
    return np.format_float_positional(value, count, unique=False, fractional=False, trim="-")


def _place(piece: Piece, fault: int, where: int) -> tuple[tuple[str, int], int, str]:
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
