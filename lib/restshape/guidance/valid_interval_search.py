"""Places where a design is valid along one freedom, looked for over the whole way on both sides."""

import numpy as np

from restshape.guidance.force_space import LONGEST, ForceSpace
from restshape.guidance.full_test import FullTest

BETTER, WORSE = 12, 3
"""Places, evenly spaced, on the side where to first order the largest flaw becomes less, and on the other one."""

BETWEEN = 3
"""More of them between two where the flaws differ, for a valid stretch lies between one flaw and the next."""

MOST, LEAST = 48, 8
"""Places within a range that is shown."""

CLOSER = 6000
"""Such places of all ranges, times the square of the number of parts, for a test takes longer the more there are."""

SMALL = 32
"""Freedoms up to which the whole way along all of them is looked at."""

PART = 0.1
"""Of what is too much in a force: less than that, to first order, a freedom does nothing about it."""


def may_alone(space: ForceSpace) -> dict[int, float]:
    """The side, 1 or -1, where to first order the largest flaw becomes less, of freedoms that may mend a design alone.

    Of many modes they are those that change each force outside the box to first order. A turn out of a plane of
    symmetry changes it to second order only: of few freedoms all are taken.
    """
    over = space.h - np.clip(space.h, space.low, space.high)
    largest, outside = int(np.argmax(np.abs(over))), over != 0.0
    enough = np.abs(LONGEST * space.K[:, outside]) >= PART * np.abs(over[outside])
    able = range(len(space.K)) if len(space.K) <= SMALL else np.flatnonzero(enough.all(axis=1))
    return {int(k): -1.0 if over[largest] * space.K[k, largest] > 0.0 else 1.0 for k in able}


def nearest_valid(
    test: FullTest, direction: np.ndarray, better: float, flaws: int, wanted: int
) -> tuple[float, float] | None:
    """The valid place nearest to 0 that is found on either side, after the invalid one before it; or None.

    Args:
        test: of a design that is invalid at 0.
        direction: change of the design parameters by a unit of t, -0.5 <= t <= 0.5.
        better: the side that is looked at more closely, 1 or -1.
        flaws: at 0.
        wanted: flaws that count.
    """
    sides = ((better, BETTER), (-better, WORSE))
    found = [
        (side * pair[0], side * pair[1])
        for side, places in sides
        if (pair := _on_side(test, side * direction, places, flaws, wanted))
    ]
    return min(found, key=lambda pair: abs(pair[1]), default=None)


def _on_side(test: FullTest, direction: np.ndarray, places: int, flaws: int, wanted: int) -> tuple[float, float] | None:
    t = LONGEST * np.arange(places + 1) / places
    seen = np.append(flaws, test.scan(direction, t[1:], wanted)[0])
    for k in np.flatnonzero(seen[1:] != seen[:-1]):
        cell = np.linspace(t[k], t[k + 1], BETWEEN + 2)
        inside = test.scan(direction, cell[1:-1], wanted)[0]
        good = np.append(inside, seen[k + 1]) == 0
        if good.any():
            first = int(np.argmax(good))
            return float(cell[first]), float(cell[first + 1])
    return None


def stretch(
    test: FullTest, direction: np.ndarray, span: tuple[float, float], shown: float, wanted: int, places: int
) -> tuple[tuple[float, float], tuple[float | None, float | None]]:
    """The part of a range around what is shown where all places hold; and the invalid place next to it on each side.

    There is None where the range is not cut.
    """
    t = np.unique(np.append(np.linspace(*span, places + 2), shown))
    bad = t[1:-1][test.scan(direction, t[1:-1], wanted)[0] != 0]
    below, above = bad[bad < shown], bad[bad > shown]
    low, high = below[-1] if len(below) else None, above[0] if len(above) else None
    left = span[0] if low is None else float(t[t > low][0])
    right = span[1] if high is None else float(t[t < high][-1])
    return (left, right), (None if low is None else float(low), None if high is None else float(high))


def places_within(parts: int, shown: int) -> int:
    """Places within each of the ranges that are shown of a design."""
    return int(np.clip(CLOSER // (parts**2 * max(shown, 1)), LEAST, MOST))
