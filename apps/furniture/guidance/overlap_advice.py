"""What to do about planks that overlap."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

import numpy as np
from restshape_apps.furniture.guidance import amounts
from restshape_apps.furniture.shape.directions import room_words
from restshape_apps.furniture.shape.free_ends import goes_through
from restshape_apps.furniture.shape.overlap_sizes import Overlap, overlap_sizes
from restshape_apps.furniture.shape.planks import LEAST_SLANT, SIDES, Piece


def overlap_advice(piece: Piece, pairs: Sequence[tuple[int, int]]) -> tuple[str, ...]:
    """What to do about each plank that overlaps others or the floor.

    Args:
        piece: with closed joints.
        pairs: of planks; a plank and -1 - k where it goes through plane k.
    """
    said, names = [], [plank.name for plank in piece.planks]
    off: dict[tuple[int, str], list[str]] = {}
    count = Counter(k for pair in pairs for k in pair)
    for one in overlap_sizes(piece, pairs):
        if one.other < 0:
            said.append(_up(piece, one))
            continue
        through = [pair for pair in _both(one) if goes_through(*(piece.planks[k] for k in pair))]
        if through:
            first, other = (names[k] for k in through[0])
            said.append(f"{first} goes through {other}: draw it as two planks, one on each side of {other}")
            continue
        first = count[one.plank] > count[one.other]
        moved, rest = (one.plank, one.other) if first else (one.other, one.plank)
        way = f"{amounts.amount(one.depth, 'm')} along {room_words(-one.way if first else one.way)}"
        off.setdefault((moved, way), []).append(names[rest])
    return (*said, *(f"move {names[k]} {way}, off {' and '.join(rest)}" for (k, way), rest in off.items()))


def _both(one: Overlap) -> Iterator[tuple[int, int]]:
    yield one.plank, one.other
    yield one.other, one.plank


def _up(piece: Piece, one: Overlap) -> str:
    """What to do about a plank that goes into a fixed plane."""
    plank, deep = piece.planks[one.plank], amounts.amount(one.depth, "m")
    what = f"{plank.name} goes {deep} into {'the floor' if one.other == -1 else f'plane {-1 - one.other}'}"
    slopes = one.way @ plank.axes[:, :2]
    axis = int(np.argmax(np.abs(slopes)))
    slope = float(abs(slopes[axis]))
    least = 0.5 * plank.size[1 - axis] * abs(slopes[1 - axis])
    if slope <= LEAST_SLANT or least > one.depth:
        return f"{what}: raise it"
    side = SIDES[2 * axis + (slopes[axis] < 0.0)]
    return f"{what}: make it {amounts.amount((one.depth - least) / slope, 'm')} shorter at {side}, or raise it"
