"""Valid ranges of a design parameter: sampled, then bisected with the full test."""

from dataclasses import dataclass

import numpy as np

from restshape.guidance.force_space import ForceSpace
from restshape.guidance.full_test import EVERY_FLAW, FullTest

SAMPLES = 192
"""Tests over the way that is looked at: apart by less than parts are thick, which must not go through one another."""
AROUND = 0.02
"""How far on both sides of a predicted end samples are put, in parts of its distance."""


@dataclass(frozen=True)
class Ranges:
    """Where a design is valid along a direction.

    Args:
        intervals: (k, 2) from and to; an end that is one of the limits is open.
        samples: (s,) parameters that were tested besides those of the bisection; between two, anything narrower may
            hide.
        flaws: (s,) what was found there.
        tests: full tests made.
    """

    intervals: np.ndarray
    samples: np.ndarray
    flaws: np.ndarray
    tests: int

    def holds(self, t: float) -> bool:
        """Whether a parameter lies in one of the ranges."""
        return bool(np.any((self.intervals[:, 0] <= t) & (t <= self.intervals[:, 1])))


def predicted_ends(space: ForceSpace, direction: np.ndarray) -> np.ndarray:
    """Parameters t at which h + t K direction meets a side of the box, for a change (m,) of modes by each unit of t."""
    slope = direction @ space.K
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = np.concatenate([(space.low - space.h) / slope, (space.high - space.h) / slope])
    return np.unique(ends[np.isfinite(ends)])


def valid_ranges(
    test: FullTest,
    direction: np.ndarray,
    low: float,
    high: float,
    hints: np.ndarray | None = None,
    samples: int = SAMPLES,
    tolerance: float = 1e-6,
    wanted: int = EVERY_FLAW,
) -> Ranges:
    """Where a design is valid for design parameters t times `direction`, low <= t <= high.

    Args:
        test: of the design at t = 0.
        direction: change of the design parameters by a unit of t.
        hints: parameters where an end is expected, such as `predicted_ends`.
        samples: evenly spaced, besides 0 and those around hints.
        tolerance: of an end, in parts of the whole of `low` to `high`.
        wanted: flaws that count.
    """
    places = [np.linspace(low, high, samples), [0.0] if low <= 0.0 <= high else []]
    if hints is not None and len(hints):
        near = np.asarray(hints)[np.argsort(np.abs(hints))[:6]]
        places += [near * (1.0 - AROUND), near * (1.0 + AROUND)]
    t = np.unique(np.concatenate(places))
    t = t[(t >= low) & (t <= high)]
    flaws = test.scan(direction, t, wanted)[0]
    good = flaws == 0
    turns = np.flatnonzero(good[1:] != good[:-1])
    ends, tests = [], len(t)
    for k in turns:
        bracket = (t[k], t[k + 1]) if good[k] else (t[k + 1], t[k])
        end, _, more = test.bisect(direction, *bracket, tolerance * (high - low), wanted)
        ends, tests = [*ends, end], tests + more
    marks = np.concatenate([[low] if good[0] else [], ends, [high] if good[-1] else []])
    return Ranges(marks.reshape(-1, 2), t, flaws, tests)
