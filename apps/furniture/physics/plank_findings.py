"""What is wrong with a piece of furniture, as findings that name its planks, joints and loads."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf

from restshape_apps.furniture.shape.directions import room_words
from restshape_apps.furniture.shape.face_contacts import flat_between_parts
from restshape_apps.furniture.shape.free_ends import ASIDE, FreeEnd, free_ends
from restshape_apps.furniture.shape.overlap_sizes import Overlap, overlap_sizes
from restshape_apps.furniture.shape.plank_gaps import Gap, gap_between_parts, gap_of
from restshape_apps.furniture.shape.planks import FLUSH, SIDES, Piece, parts_of

from restshape.findings import Finding

SLANT, LENGTH, GAP, MISSED, FOOT, BEHIND = 1, 2, 3, 4, 5, 6
"""Numbers of faults of the geometry."""
FAULTS = {SLANT: "slant", LENGTH: "length", GAP: "gap", MISSED: "missed", FOOT: "foot", BEHIND: "behind"}
"""Details of what is lost, by the numbers of faults."""
FAR_SLANT = "far slant"
"""The same of a slant where the two planks are farther from each other than joints reach."""
APART, LOST, OVERLAPPING, FALLS, WEAK, UNBALANCED = "apart", "lost", "overlapping", "falls", "weak", "unbalanced"
"""Kinds of findings."""
SLIDES = "slides"
"""Detail of what falls by friction alone: more of it would hold it."""
PART, NEAREST = "part", "nearest"
"""Details of what is apart: a part, with the number of its planks, and how far two parts are from each other."""
DOUBTFUL = "doubtful"
"""Kind of findings on what holds only because something is not counted in the constraint status."""
OVERBENT = "overbent"
"""Kind of findings on planks that bend beyond their strength, of which the constraint status is not made."""
ACROSS = "across"
"""Detail of a plank that bends beyond its strength across its fibres."""
DEPENDS = "depends"
"""Kind of findings on joints whose compliance, which nobody knows, decides whether the piece holds."""
FREE = "free"
"""Kind of findings on ends that nothing holds, near a face that they may have missed."""
FLAT = "flat"
"""Detail of parts that are apart although two of their planks lie face to face: joints hold ends."""
RESTS = "rests"
"""Detail of parts that are apart although a plank lies flat on another one: only joints and the floor hold planks."""
BEFORE, BEYOND, BESIDE, TILTED, NEAR = "before", "beyond", "beside", "tilted", "near"
"""Details of a free end: before a face, in or behind it, beside it, with its edge across it, or near what cannot hold
it."""
TOUCHES = "touches"
"""Detail of a free end as near a face as joints reach, which only has to be connected."""
EDGE = "edge"
"""Detail of an end that is at the edge of a plank, which takes no joint."""
GAPS = (NEAREST, BEYOND, BESIDE, FLAT, RESTS, EDGE)
"""Details of what keeps two parts from being joined."""
PULL, SHEAR, LINE, TWIST = "pull", "shear", "line", "twist"
"""Details of a weak joint, by what overloads it; the moments along its line and about its normal count where a scene
says so, and are doubts elsewhere."""
LOADS = (PULL, SHEAR, LINE, TWIST)
"""The same by their numbers."""
MOST_UTILISATION = 1e12
"""Of a joint: a single fastener does not bear a twist at all."""
INTERFERENCE = 1e-4
"""How far planks may be in each other to count as touching [m]."""
LEVEL = 0.999
"""Least cosine with the vertical of the normal of a plank that lies level on another one."""
WEIGHTS = "weights"
"""The case of the weights alone."""


@dataclass(frozen=True)
class FlawNumbers:
    """What is wrong, by numbers.

    Args:
        faults: number of `FAULTS`, and the end (4 plank + side) of a slant or from behind, the plank of a length, else
            the joint or foot.
        overlaps: pairs of planks; a plank and -1 - k where it goes through plane k.
        falls: case, and the first plank of the part of the piece that falls in it.
        unbalanced: cases without an equilibrium.
        overloaded: joint, case, utilisation in parts of its strength, and by what, a number of `LOADS`.
        doubts: the same of moments that do not count.
    """

    faults: Sequence[tuple[int, int]] = ()
    overlaps: Sequence[tuple[int, int]] = ()
    falls: Sequence[tuple[int, int]] = ()
    unbalanced: Sequence[int] = ()
    overloaded: Sequence[tuple[int, int, float, int]] = ()
    doubts: Sequence[tuple[int, int, float, int]] = ()


def lost(piece: Piece, found: FlawNumbers) -> list[Finding]:
    """Joints and feet that are lost, and how; of each the first fault."""
    # An end that cannot be closed is not flush either.
    first: dict[tuple[str, int], Finding] = {}
    for fault, where in found.faults:
        key, plank, other = _place(piece, fault, where)
        if key not in first:
            subjects = (piece.planks[plank].name, other) if other else (piece.planks[plank].name,)
            first[key] = _lost(piece, fault, key, subjects)
    return list(first.values()) or [Finding(LOST)]


def overlapping(piece: Piece, found: FlawNumbers) -> list[Finding]:
    """Planks that are in each other, and in the floor; how far, along which axes of the room, and where."""
    return [_overlap(piece, one) for one in overlap_sizes(piece, found.overlaps)] or [Finding(OVERLAPPING)]


def _overlap(piece: Piece, one: Overlap) -> Finding:
    name = piece.planks[one.plank].name
    if one.other < 0:
        return Finding(OVERLAPPING, "", (name, _plane(-1 - one.other)), one.depth, INTERFERENCE, "m")
    place = ", ".join(f"{round(1e3 * x) + 0}" for x in one.place.tolist())
    way = room_words(one.way).replace("+", "").replace("-", "")
    return Finding(
        OVERLAPPING, "", (name, piece.planks[one.other].name, way, f"({place}) mm"), one.depth, INTERFERENCE, "m"
    )


def apart(piece: Piece) -> list[Finding]:
    """The parts that no joint connects, and what keeps two of them from being joined where that is known."""
    nearest = _missed(piece) or _nearest(piece)
    return [*(_part(piece, part, APART) for part in parts_of(piece)), *([nearest] if nearest else [])]


def _missed(piece: Piece) -> Finding | None:
    """The end that missed another part by least, where it passes beside it or goes through it."""
    part = {k: number for number, planks in enumerate(parts_of(piece)) for k in planks}
    ends = [one for one in free_ends(piece) if one.other >= 0 and part[one.plank] != part[one.other]]
    nearest = min(ends, key=lambda one: abs(one.gap) + one.aside, default=None)
    if nearest is None or not (nearest.passes or nearest.edge or nearest.gap < -piece.reach):
        return None
    return replace(_free_end(piece, nearest), kind=APART)


def _nearest(piece: Piece) -> Finding | None:
    """How far an end is from another part; or two planks that lie face to face, where no end is as near."""
    ends, faces = gap_between_parts(piece), flat_between_parts(piece, ASIDE)
    if faces is None or (ends is not None and ends.size <= faces[2]):
        return beyond_reach(piece, ends)
    i, j, gap = faces
    upper, lower = sorted((i, j), key=lambda k: -float(piece.planks[k].centre[2]))
    rests = gap == 0.0 and abs(float(piece.planks[i].axes[2, 2])) > LEVEL
    names = tuple(piece.planks[k].name for k in ((upper, lower) if rests else (i, j)))
    return Finding(APART, RESTS if rests else FLAT, names, gap, piece.reach, "m")


def beyond_reach(piece: Piece, gap: Gap | None) -> Finding | None:
    """How far an end is from a plank, farther than joints reach; None where it is not, or where there is no gap."""
    if gap is None or gap.size <= piece.reach:
        return None
    subjects = (piece.planks[gap.i].name, SIDES[gap.side], piece.planks[gap.j].name)
    return Finding(APART, NEAREST, subjects, gap.size, piece.reach, "m")


def falls(piece: Piece, found: FlawNumbers, needed: Mapping[int, float]) -> list[Finding]:
    """Loads that it falls or slides under, and what falls in each of them where it is in parts.

    Args:
        piece: that falls.
        found: in which cases.
        needed: the friction of the floor that would hold it, of cases in which it slides; inf where that is not known.
    """
    parts = parts_of(piece)
    if len(parts) == 1:
        cases = dict.fromkeys(case for case, _ in found.falls)
        return [_fall(piece, case, needed.get(case)) for case in cases] or [Finding(FALLS)]
    down = [(case, next(part for part in parts if first in part)) for case, first in found.falls]
    return [_part(piece, part, FALLS, load_case(piece, case)) for case, part in dict.fromkeys(down)] or [Finding(FALLS)]


def _fall(piece: Piece, case: int, needed: float | None) -> Finding:
    """A case that a piece in one part falls in, or slides in by friction that is too low."""
    if needed is None:
        return Finding(FALLS, case=load_case(piece, case))
    if needed == inf:
        return Finding(FALLS, SLIDES, case=load_case(piece, case))
    return Finding(FALLS, SLIDES, value=needed, bound=piece.planes[0].mu, case=load_case(piece, case))


def weak(piece: Piece, found: FlawNumbers) -> list[Finding]:
    """Joints that break, the worst first."""
    return _overloaded(piece, WEAK, found.overloaded) or [Finding(WEAK)]


def doubts(piece: Piece, found: FlawNumbers) -> list[Finding]:
    """Joints that moments overload which the constraint status does not count, the worst first."""
    return _overloaded(piece, DOUBTFUL, found.doubts)


def free(piece: Piece, ends: Sequence[FreeEnd]) -> list[Finding]:
    """Ends that nothing holds, each by what keeps it from the face that it is near."""
    return [_free_end(piece, one) for one in ends]


def unbalanced(piece: Piece, found: FlawNumbers) -> list[Finding]:
    """Loads without an equilibrium."""
    return [Finding(UNBALANCED, case=load_case(piece, case)) for case in found.unbalanced] or [Finding(UNBALANCED)]


def joint_planks(piece: Piece, joint: int) -> tuple[str, str]:
    """The plank whose end a joint holds, and the one whose face it is at."""
    one = piece.joints[joint]
    return piece.planks[one.i].name, piece.planks[one.j].name


def load_case(piece: Piece, case: int) -> str:
    """What a case is called: the weights alone, or a push beside them."""
    return WEIGHTS if case == 0 else f"push {piece.pushes[case - 1].name}"


def _free_end(piece: Piece, one: FreeEnd) -> Finding:
    """What keeps an end from the face that it is near; beside it, the side too."""
    other = _plane(0) if one.other < 0 else piece.planks[one.other].name
    subjects = (piece.planks[one.plank].name, SIDES[one.side], other)
    if one.edge:
        return Finding(FREE, EDGE, subjects, one.gap if one.gap > FLUSH else 0.0, piece.reach, "m")
    if one.passes:
        return Finding(FREE, BESIDE, (*subjects, one.beside), one.aside, piece.reach, "m")
    if abs(one.gap) > piece.reach:
        return Finding(FREE, BEFORE if one.gap > 0.0 else BEYOND, subjects, abs(one.gap), piece.reach, "m")
    if one.tilted or not one.joins(piece):
        return Finding(FREE, TILTED if one.tilted else NEAR, subjects, 0.0, piece.reach, "m")
    # What is less than a flush joint leaves open is rounding.
    return Finding(FREE, TOUCHES, subjects, abs(one.gap) if abs(one.gap) > FLUSH else 0.0, piece.reach, "m")


def _overloaded(piece: Piece, kind: str, joints: Sequence[tuple[int, int, float, int]]) -> list[Finding]:
    """Overloaded joints, the worst first."""
    # Joints that differ by rounding alone stay in their order.
    worst = sorted(joints, key=lambda one: -round(min(one[2], MOST_UTILISATION), 6))
    return [
        Finding(kind, LOADS[by], joint_planks(piece, k), utilisation, 1.0, case=load_case(piece, case))
        for k, case, utilisation, by in worst
    ]


def _lost(piece: Piece, fault: int, key: tuple[str, int], subjects: tuple[str, ...]) -> Finding:
    """What is lost, of a joint with how far its two planks are from each other."""
    what, number = key
    if what != "joint":
        return Finding(LOST, FAULTS[fault], subjects)
    joint = piece.joints[number]
    size = gap_of(piece, joint.i, joint.side, joint.j).size
    detail = FAR_SLANT if fault == SLANT and size > piece.reach else FAULTS[fault]
    return Finding(LOST, detail, subjects, size, piece.reach, "m")


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


def _part(piece: Piece, planks: Sequence[int], kind: str, case: str = "") -> Finding:
    """A part of the piece, by the first of its planks and how many there are."""
    return Finding(kind, PART, (piece.planks[planks[0]].name,), len(planks), case=case)
