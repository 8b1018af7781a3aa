"""Suggestions that bring free ends to what they missed: planks move sideways, grow or shrink, and are joined."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from restshape_apps.furniture.guidance import amounts
from restshape_apps.furniture.guidance.connecting import Connection
from restshape_apps.furniture.physics.furniture import (
    LOST,
    OVERLAPPING,
    UNSTABLE,
    WEAK,
    Furniture,
    TestResult,
)
from restshape_apps.furniture.shape.directions import room_words
from restshape_apps.furniture.shape.free_ends import FreeEnd, free_ends
from restshape_apps.furniture.shape.plank_edits import connected
from restshape_apps.furniture.shape.planks import FLUSH, SIDES, Piece, Plank, parts_of

from restshape.errors import UserError

NAME = "a free end joined"
"""Kind of these suggestions."""


def lengthenings(piece: Piece, shown: int = 8) -> tuple[Connection, ...]:
    """Planks made longer, or shorter, until their free ends meet what they missed; what leaves nothing wrong first.

    Where ends pass beside what they missed, the plank goes sideways too, until all of each end lies on the face.

    All free ends of a plank go at once, or where that is no joint each alone; and at once those of all planks that can
    be joined. Of a piece in parts only what makes parts fewer is shown, of another one only what leaves less wrong.

    Args:
        piece: with closed joints.
        shown: at most so many.
    """
    before, apart, found = _wrong(Furniture(piece).test()), len(parts_of(piece)), []
    for one in _joinable(piece):
        if len(parts_of(one.piece)) > apart:
            continue
        if len(parts_of(one.piece)) < apart or _wrong(Furniture(one.piece).test()) < before:
            found.append(one)
    return tuple(sorted(found, key=lambda one: one.flaws != 0)[:shown])


def _wrong(result: TestResult) -> tuple[int, bool, bool, int, float, float]:
    """How much is wrong with a piece, what counts most first: flaws, whether others than weak joints, whether it falls,
    under how many loads, how much of them is not balanced, and the largest utilisation of a joint."""
    falls = bool(result.flaws & UNSTABLE)
    return (
        bin(result.flaws).count("1"),
        bool(result.flaws & ~(UNSTABLE | WEAK)),
        falls,
        len({case for case, _ in result.found.falls}),
        round(result.unbalanced, 6) if falls else 0.0,
        max(result.pull, result.shear),
    )


def rejoined(piece: Piece) -> tuple[Connection, ...]:
    """Planks of a piece that holds made longer, or shorter, until fewer of their ends are free; all hold.

    Args:
        piece: with closed joints, that holds.
    """
    free = len(free_ends(piece))
    return tuple(one for one in _joinable(piece) if one.flaws == 0 and len(free_ends(one.piece)) < free)


def free_end_warnings(piece: Piece, holds: bool) -> tuple[str, ...]:
    """What each free end missed, what to do, and if the piece holds whether it would not then.

    Ends below the floor are left out, whose planks overlap it.
    """
    worse = worse_if_joined(piece) if holds else {}
    return tuple(
        one.words(piece) + (f", but then {worse[one.plank][1]}" if one.plank in worse else "")
        for one in free_ends(piece)
        if not one.sunk(piece)
    )


def worse_if_joined(piece: Piece) -> dict[int, tuple[str, str]]:
    """What is done to each plank of a piece that holds whose free ends can be joined, and what is wrong with it then;
    only planks that are in no such piece that holds.

    Args:
        piece: with closed joints, that holds.
    """
    worse: dict[int, tuple[str, str]] = {}
    for plank in dict.fromkeys(one.plank for one in free_ends(piece) if not (one.tilted or one.edge)):
        ends = tuple(one for one in free_ends(piece, [plank]) if not (one.tilted or one.edge))
        made = [one for _, one in _that_join(piece, [ends, *((one,) for one in ends if len(ends) > 1)])]
        if made and all(one.flaws for one in made):
            worse[plank] = made[0].words, "; ".join(Furniture(made[0].piece).test().words)
    return worse


def _joinable(piece: Piece) -> Iterator[Connection]:
    """The piece with free ends at what they missed: those of each plank, and of each that can be joined all at once."""
    missed = [one for one in free_ends(piece) if not (one.tilted or one.edge)]
    first: list[tuple[FreeEnd, ...]] = []
    for plank in dict.fromkeys(one.plank for one in missed):
        ends = tuple(one for one in missed if one.plank == plank)
        made = _that_join(piece, [ends]) or (_that_join(piece, [(one,) for one in ends]) if len(ends) > 1 else [])
        yield from (one for _, one in made)
        first += [some for some, _ in made[:1]]
    if len(first) > 1:
        yield from (one for _, one in _that_join(piece, [tuple(one for ends in first for one in ends)]))


def _that_join(piece: Piece, sets: Sequence[tuple[FreeEnd, ...]]) -> list[tuple[tuple[FreeEnd, ...], Connection]]:
    """Of sets of free ends those that can be joined, each with the piece where it is."""
    made = ((ends, _joined(piece, ends)) for ends in sets)
    return [(ends, one) for ends, one in made if one is not None]


def _joined(piece: Piece, ends: Sequence[FreeEnd]) -> Connection | None:
    """The piece with these ends at what they missed; None where one of them is not joined there."""
    planks = list(piece.planks)
    shifts = _sideways(piece, ends)
    for k, shift in shifts.items():
        planks[k] = replace(planks[k], centre=planks[k].centre + shift)
    for one in ends:
        planks[one.plank] = _longer(planks[one.plank], one)
    feet = tuple(foot for foot in piece.feet if foot.plank not in shifts)
    grown = replace(piece, planks=tuple(planks), feet=feet)
    fastener = piece.joints[0].fastener if piece.joints else "nail-thesis"
    try:
        for plank in dict.fromkeys([*(one.plank for one in ends), *shifts]):
            grown = connected(grown, plank, piece.reach, fastener)
        made = Furniture(grown).moved()
        flaws = Furniture(made).test().flaws
    except UserError:
        # The fastener does not suit these planks.
        return None
    joined = {(joint.i, joint.side) for joint in made.joints} | {(foot.plank, foot.side) for foot in made.feet}
    if flaws & (LOST | OVERLAPPING) or any((one.plank, one.side) not in joined for one in ends):
        return None
    way = sum(one.gap * _outwards(piece.planks[one.plank], one.side) for one in ends) + sum(shifts.values())
    left = len(free_ends(made, {one.plank for one in ends}))
    return Connection("; ".join(_words(piece, ends)), made, way, flaws, left, NAME)


def _sideways(piece: Piece, ends: Sequence[FreeEnd]) -> dict[int, np.ndarray]:
    """How far (3,) planks go sideways whose ends pass beside what they missed, with all that is joined to them."""
    parts, shifts = parts_of(piece), {}
    for one in sorted(ends, key=lambda end: np.linalg.norm(end.way)):
        if one.passes:
            part = next(part for part in parts if one.plank in part)
            moved = part if part is not parts[0] and one.other not in part else (one.plank,)
            shifts.update(dict.fromkeys(moved, np.array(one.way)))
    return shifts


def _longer(plank: Plank, one: FreeEnd) -> Plank:
    """The plank with one end where it meets what it missed."""
    a = one.side // 2
    size = plank.size.copy()
    size[a] += one.gap
    return replace(plank, centre=plank.centre + 0.5 * one.gap * _outwards(plank, one.side), size=size)


def _outwards(plank: Plank, side: int) -> np.ndarray:
    """The unit vector (3,) in which one end of a plank looks."""
    return plank.axes[:, side // 2] * (1.0 if side % 2 else -1.0)


def _words(piece: Piece, ends: Sequence[FreeEnd]) -> Iterator[str]:
    """What each plank does, and what it meets."""
    shifts = _sideways(piece, ends)
    for plank in dict.fromkeys(one.plank for one in ends):
        own = [one for one in ends if one.plank == plank]
        ways = [_moved(shifts[plank])] if plank in shifts else []
        ways += [f"{_amount(one.gap)} at its end {SIDES[one.side]}" for one in own if abs(one.gap) > FLUSH]
        met = dict.fromkeys("the floor" if one.other < 0 else piece.planks[one.other].name for one in own)
        if not ways:
            touching = (
                f"ends {SIDES[own[0].side]} and {SIDES[own[1].side]} touch"
                if own[1:]
                else f"end {SIDES[own[0].side]} touches"
            )
            yield f"{piece.planks[plank].name} connected to {' and '.join(met)}, which its {touching}"
            continue
        done = " and ".join(filter(None, [", ".join(ways[:-1]), ways[-1]]))
        yield f"{piece.planks[plank].name} {done}, to meet {' and '.join(met)}"


def _moved(shift: np.ndarray) -> str:
    size = float(np.linalg.norm(shift))
    return f"moved {amounts.amount(size, 'm')} towards {room_words(shift / size)}"


def _amount(gap: float) -> str:
    return f"{amounts.amount(abs(gap), 'm')} {'longer' if gap > 0.0 else 'shorter'}"
