"""Findings on a piece of furniture in words."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from math import ceil, floor, log10

import numpy as np
from restshape_apps.furniture.physics import plank_findings as kinds
from restshape_apps.furniture.physics.plank_findings import joint_planks, load_case
from restshape_apps.furniture.shape.free_ends import to_a_face
from restshape_apps.furniture.shape.planks import Piece, parts_of

from restshape.findings import OMITTED, Finding
from restshape.replay.constraints import LIMIT, formatted_constraint, value_and_bound

SHOWN = 3
"""Names of one kind that are shown; of more it is said how many there are."""

FAULTS = {
    "slant": "{0} lies too flat on {1}",
    "length": "{0} has no length left",
    "gap": "{0} is not flush with {1}",
    "missed": "{0} misses {1}",
    "foot": "{0} does not stand flat on {1}",
    "behind": "{0} comes to {1} from behind",
    kinds.FAR_SLANT: "{0} does not point at {1}",
}
"""What is said of what is lost, by its detail."""

FREE_ENDS = {
    kinds.BEFORE: "{0} {1} is {far} mm from {2}",
    kinds.BEYOND: "{0} {1} is {far} mm beyond the face of {2}",
    kinds.BESIDE: "the centre line of {0} {1} passes {far} mm beside {2}, on its {3} side",
    kinds.TOUCHES: "{0} {1} is {far} mm from {2}, not joined: connect {0}",
    kinds.EDGE: "{0} {1} is {far} mm from the edge of {2}, which takes no joint: " + to_a_face("{0}", "{2}"),
    kinds.TILTED: "the edge of {0} {1} does not lie along {2}",
    kinds.NEAR: "{0} {1} is near {2}, which cannot hold it",
}
"""What is said of free ends, by their details."""

RESTS = (
    "{0} lies on {1}, but planks are held by joints alone, an end at a face: "
    "stand {0} on upright planks, or put its weights on {1} and leave it out"
)
"""What is said of a plank that lies flat on another one, and what to do."""

STRENGTHS = {kinds.SHEAR: "shear strength", kinds.LINE: "strength along its line", kinds.TWIST: "strength in twist"}
"""What is overloaded, by details of a weak joint."""

Worst = Collection[Finding]
"""Findings whose amount is the worst of several frames."""


def phrases(findings: Sequence[Finding], worst: Worst = ()) -> tuple[str, ...]:
    """What is wrong, a phrase a kind, and one for each violated limit of a quantity.

    Args:
        findings: of a frame.
        worst: those whose amount is the worst of several frames: it is "up to" that.
    """
    groups: dict[str, list[Finding]] = {}
    for one in findings:
        groups.setdefault(one.kind, []).append(one)
    found: list[str] = []
    for kind, group in groups.items():
        if kind == LIMIT:
            found += [formatted_constraint(one, one in worst) for one in group if one.detail != OMITTED]
        elif kind == kinds.FALLS:
            found.append(_falls(group, [one.subjects for one in groups.get(kinds.APART, ())], worst))
        else:
            found.append(PHRASES[kind](group, worst))
    return tuple(found)


def amount(finding: Finding) -> str:
    """The amount that a finding has, as its phrase shows it; empty without one."""
    if finding.value is None or finding.bound is None:
        return ""
    if finding.detail == kinds.SLIDES:
        return rounded_up(finding.value)
    if finding.kind in (kinds.WEAK, kinds.DOUBTFUL, kinds.OVERBENT):
        return "" if _bears_no_twist(finding) else _share(finding.value)
    if finding.kind in (kinds.FREE, kinds.OVERLAPPING) or finding.detail in (kinds.BESIDE, kinds.FLAT, kinds.EDGE):
        return _digits(1e3 * finding.value, 4)
    return value_and_bound(finding)[0] if finding.kind == LIMIT else _two_lengths(finding)[0]


def _bears_no_twist(finding: Finding) -> bool:
    """Whether a joint is twisted that has a single fastener, so that no amount of it is borne."""
    return finding.detail == kinds.TWIST and (finding.value or 0.0) > kinds.MOST_UTILISATION


def amount_beyond_reach(finding: Finding, worst: bool = False) -> str:
    """How far an end is from a plank, farther than joints reach."""
    far, reach = _two_lengths(finding)
    plank, side, other = finding.subjects
    more = "up to " if worst else ""
    return f"{plank} {side} is {more}{far} mm from {other}, beyond the reach of {reach} mm of joints"


def joint_name(piece: Piece, joint: int) -> str:
    """What a joint is called: the plank whose end it holds, on the one whose face it is at."""
    return " on ".join(joint_planks(piece, joint))


def balanced_by_springs(piece: Piece, cases: Sequence[int]) -> str:
    """Loads under which contacts act as springs that also pull; empty without any."""
    if not cases:
        return ""
    under = _listed([_load(load_case(piece, case)) for case in cases])
    return f"forces under {under} are of feet that springs hold: with feet that only push no equilibrium was found"


def _apart(findings: list[Finding], worst: Worst) -> str:
    nearest = next((one for one in findings if one.detail in kinds.GAPS), None)
    parts = [_part(one) for one in findings if one.detail == kinds.PART]
    omitted = _omitted(findings)
    gap = f" ({_gap(nearest, nearest in worst)})" if nearest else ""
    return f"in {_count(len(parts) + omitted)} parts: {_listed(parts, omitted)}{gap}"


def _gap(nearest: Finding, worst: bool) -> str:
    """What keeps two parts from being joined."""
    if nearest.detail == kinds.NEAREST:
        return amount_beyond_reach(nearest, worst)
    far = ("up to " if worst else "") + amount(nearest)
    if nearest.detail == kinds.RESTS:
        return RESTS.format(*nearest.subjects)
    if nearest.detail == kinds.FLAT:
        one, other = nearest.subjects
        off = f", {far} mm from it" if far != "0" else ""
        return f"{one} lies face to face with {other}{off}: a joint needs an end at a face"
    return _free_end(nearest, worst)


def _lost(findings: list[Finding], worst: Worst) -> str:
    lost = [_fault(one, one in worst) for one in findings if one.subjects]
    return f"lost: {_listed(lost, _omitted(findings))}" if lost else "a joint is lost"


def lying(piece: Piece, plank: int) -> list[str]:
    """What is said of a plank that lies on another one, or face to face with it, where that keeps it from the rest."""
    name, found = piece.planks[plank].name, kinds.apart(piece) if len(parts_of(piece)) > 1 else []
    return [_gap(one, False) for one in found if one.detail in (kinds.RESTS, kinds.FLAT) and one.subjects[0] == name]


def _fault(one: Finding, worst: bool) -> str:
    """What is said of a fault, with how far the two planks of a joint are from each other if joints do not reach."""
    words = FAULTS[one.detail].format(*one.subjects)
    if one.value is None or one.bound is None or one.value <= one.bound:
        return words
    return f"{words}, {'up to ' if worst else ''}{_two_lengths(one)[0]} mm from it"


def _overlapping(findings: list[Finding], worst: Worst) -> str:
    pairs = [_overlap(one, one in worst) for one in findings if one.subjects]
    return f"overlapping: {_listed(pairs, _omitted(findings))}" if pairs else "planks overlap"


def _overlap(one: Finding, worst: bool) -> str:
    """Which two overlap, by how much, along which axis and where."""
    names = " and ".join(one.subjects[:2])
    # Recordings of old versions have the names alone, and some planks have no size of their own to be named.
    if one.value is None or one.bound is None or one.value <= one.bound:
        return names
    by = f"{names} by {'up to ' if worst else ''}{amount(one)} mm"
    return f"{by} along {one.subjects[2]} at {one.subjects[3]}" if len(one.subjects) > 2 else by


def _falls(findings: list[Finding], parts: Sequence[tuple[str, ...]], worst: Worst) -> str:
    """Loads that it falls under, and which of the parts, in their order."""
    sliding = [one for one in findings if one.detail == kinds.SLIDES]
    slides = list(dict.fromkeys(_load(one.case) for one in sliding))
    cases = list(dict.fromkeys(_load(one.case) for one in findings if one.case and one.detail != kinds.SLIDES))
    if slides:
        return "; ".join(
            [
                *([f"falls under {_listed(cases)}"] if cases else []),
                f"slides under {_listed(slides)}{_friction(sliding, worst)}",
            ]
        )
    if not cases:
        return "falls"
    falling = {one.subjects: one for one in findings if one.subjects}
    order = sorted(falling.values(), key=lambda one: parts.index(one.subjects) if one.subjects in parts else len(parts))
    return f"falls under {_listed(cases)}" + (f": {_listed([_part(one) for one in order])}" if order else "")


def _friction(sliding: list[Finding], worst: Worst) -> str:
    """The friction that would hold what slides, and that of the floor; empty where it is not known."""
    most = max((one for one in sliding if one.value is not None), key=lambda one: one.value or 0.0, default=None)
    if most is None:
        return ""
    more = "up to " if most in worst else ""
    return f" (needs friction of {more}{rounded_up(most.value or 0.0)}, the floor has {most.bound:.4g})"


def _weak(findings: list[Finding], worst: Worst) -> str:
    joints = [
        f"{' on '.join(one.subjects)} {_overload(one, worst)}"
        + (f" under {_load(one.case)}" if one.case != kinds.WEIGHTS else "")
        for one in findings
        if one.subjects
    ]
    return f"weak: joint {_listed(joints, _omitted(findings))}" if joints else "a joint is weak"


def _overload(one: Finding, worst: Worst) -> str:
    """By how much a joint is overloaded, in which way."""
    if _bears_no_twist(one):
        return "in twist, which its single fastener does not bear"
    return f"at {'up to ' if one in worst else ''}{amount(one)} of its {STRENGTHS.get(one.detail, 'strength')}"


def _depends(findings: list[Finding], worst: Worst) -> str:
    joints = [f"{' on '.join(one.subjects)} {_between(one.bound, one.value)}" for one in findings if one.subjects]
    what = f": the utilisation of {_listed(joints, _omitted(findings))} over their compliances" if joints else ""
    return f"depends on joints{what}"


def _between(least: float, most: float) -> str:
    """The least and the largest utilisation of a joint; a single fastener bears no twist."""
    return f"from {least:.2f} to {_share(most) if most < kinds.MOST_UTILISATION else 'infinite'}"


def _doubtful(findings: list[Finding], worst: Worst) -> str:
    return _weak(findings, worst).replace("weak: joint", "not counted: joint", 1)


def _overbent(findings: list[Finding], worst: Worst) -> str:
    planks = [
        f"{one.subjects[0]} at {'up to ' if one in worst else ''}{amount(one)} of its bending strength"
        + (" across its fibres" if one.detail == kinds.ACROSS else "")
        + (f" under {_load(one.case)}" if one.case != kinds.WEIGHTS else "")
        for one in findings
        if one.subjects
    ]
    return f"not counted: plank {_listed(planks, _omitted(findings))}"


def _free(findings: list[Finding], worst: Worst) -> str:
    ends = [_free_end(one, one in worst) for one in findings if one.subjects]
    return f"free end: {_listed(ends, _omitted(findings))}"


def _free_end(one: Finding, worst: bool) -> str:
    """What keeps an end from the face that it is near, or that it touches it."""
    touches = one.detail in (kinds.TOUCHES, kinds.EDGE) and not one.value
    words = FREE_ENDS[one.detail].format(*one.subjects, far=("up to " if worst else "") + amount(one))
    return words.replace("is 0 mm from", "touches", 1) if touches else words


def _unbalanced(findings: list[Finding], worst: Worst) -> str:
    cases = [_load(one.case) for one in findings if one.case]
    return f"no equilibrium was found{' under ' + _listed(cases, _omitted(findings)) if cases else ''}"


PHRASES: dict[str, Callable[[list[Finding], Worst], str]] = {
    kinds.APART: _apart,
    kinds.LOST: _lost,
    kinds.OVERLAPPING: _overlapping,
    kinds.WEAK: _weak,
    kinds.DOUBTFUL: _doubtful,
    kinds.OVERBENT: _overbent,
    kinds.DEPENDS: _depends,
    kinds.FREE: _free,
    kinds.UNBALANCED: _unbalanced,
}


def _omitted(findings: Iterable[Finding]) -> int:
    """How many findings there are besides."""
    return sum(int(one.value or 0) for one in findings if one.detail == OMITTED)


def _two_lengths(finding: Finding) -> tuple[str, str]:
    """Value and bound [m] in mm, with as many digits as distinguish them."""
    lengths = finding.value, finding.bound
    texts = [tuple(_digits(1e3 * length, n) for length in lengths) for n in (4, 8, 17)]
    return next((pair for pair in texts if pair[0] != pair[1]), texts[-1])


def _digits(value: float, count: int) -> str:
    """A number with so many digits, without a power of ten."""
    return np.format_float_positional(value, count, unique=False, fractional=False, trim="-")


def _load(case: str) -> str:
    """What a load case is called in a phrase."""
    return "its weights" if case == kinds.WEIGHTS else case


def _part(one: Finding) -> str:
    """What a part of the piece is called."""
    more = int(one.value or 1) - 1
    return f"{one.subjects[0]} with {more} more" if more else one.subjects[0]


def _count(number: int) -> str:
    return {2: "two", 3: "three"}.get(number, str(number))


def rounded_up(value: float) -> str:
    """A positive number with three digits that is not below it, but for rounding."""
    unit = 10.0 ** (floor(log10(value)) - 2)
    return f"{ceil(value / unit - 1e-2) * unit:.3g}"


def _share(utilisation: float) -> str:
    """A utilisation of more than 1, which does not look like 1."""
    return f"{ceil(utilisation * 100) / 100:.2f}" if utilisation < 100 else f"{utilisation:.3g}"


def _listed(names: Sequence[str], omitted: int = 0) -> str:
    """Names, the first of them where there are many."""
    more = len(names) + omitted - len(names[:SHOWN])
    return ", ".join(names[:SHOWN]) + (f" and {more} more" if more > 0 else "")
