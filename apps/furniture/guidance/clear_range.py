"""Parts of a range in which a condition holds that has no derivative: sampled, then bisected."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

SAMPLES, FEWEST = 12, 3
"""Places of a whole range where the condition is looked at, and in the least part of it."""

Interval = tuple[float, float]


def clear_ranges(clear: Callable[[float], bool], parts: Sequence[Interval], tolerance: float) -> list[Interval]:
    """Where a condition holds, in order; anything narrower than two samples are apart may be missed.

    Args:
        clear: the condition.
        parts: that are looked at, in order.
        tolerance: of an end; it lies where the condition holds.
    """
    whole = sum(high - low for low, high in parts)
    found: list[Interval] = []
    for low, high in parts:
        count = max(FEWEST, round(SAMPLES * (high - low) / whole)) if high > low else 1
        t = np.linspace(low, high, count)
        good = [clear(float(one)) for one in t]
        ends = [float(low)] if good[0] else []
        for k in range(count - 1):
            if good[k] != good[k + 1]:
                inside, outside = (t[k], t[k + 1]) if good[k] else (t[k + 1], t[k])
                ends.append(range_end(clear, float(inside), float(outside), tolerance))
        ends += [float(high)] if good[-1] else []
        found += zip(ends[::2], ends[1::2])
    return found


def complement(found: Sequence[Interval], low: float, high: float, least: float) -> list[Interval]:
    """What of an interval lies in none of the ranges that were found, without what is narrower than `least`."""
    marks = [low, *(end for one in found for end in one), high]
    return [(left, right) for left, right in zip(marks[::2], marks[1::2]) if right - left > least]


def range_end(clear: Callable[[float], bool], inside: float, outside: float, tolerance: float) -> float:
    """The last place from inside on where the condition holds."""
    while abs(outside - inside) > tolerance:
        middle = 0.5 * (inside + outside)
        inside, outside = (middle, outside) if clear(middle) else (inside, middle)
    return inside
