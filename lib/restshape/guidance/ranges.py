"""Valid ranges of a design parameter: sampled, then bisected with the full test."""

from dataclasses import dataclass

import numpy as np

from restshape.guidance.force_space import ForceSpace
from restshape.physics.furniture import ALL, Furniture

SAMPLES = 192
"""Tests over the way that is looked at: apart by less than planks are thick, which must not go through one another."""
AROUND = 0.02
"""How far on both sides of a predicted end samples are put, in parts of its distance."""


@dataclass(frozen=True)
class Ranges:
    """Where a piece is valid along a direction.

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
        """Tell whether a parameter lies in one of the ranges."""
        return bool(np.any((self.intervals[:, 0] <= t) & (t <= self.intervals[:, 1])))


def predicted_ends(space: ForceSpace, direction: np.ndarray) -> np.ndarray:
    """Parameters t at which h + t K direction meets a side of the box, for a change (m,) of modes by each unit of t."""
    slope = direction @ space.K
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = np.concatenate([(space.low - space.h) / slope, (space.high - space.h) / slope])
    return np.unique(ends[np.isfinite(ends)])


def valid_ranges(
    furniture: Furniture,
    direction: np.ndarray,
    low: float,
    high: float,
    hints: np.ndarray | None = None,
    samples: int = SAMPLES,
    tolerance: float = 1e-6,
    wanted: int = ALL,
) -> Ranges:
    """Where the piece is valid for design parameters t times `direction`, low <= t <= high.

    Args:
        furniture: its piece is that of t = 0.
        direction: (n, 8) change of the design parameters by a unit of t.
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
    flaws = furniture.kernel.scan(direction, t, wanted)[0]
    good = flaws == 0
    turns = np.flatnonzero(good[1:] != good[:-1])
    ends, _, tests = bisected(
        furniture, direction, t[turns], t[turns + 1], good[turns], tolerance * (high - low), wanted
    )
    marks = np.concatenate([[low] if good[0] else [], ends, [high] if good[-1] else []])
    return Ranges(marks.reshape(-1, 2), t, flaws, len(t) + tests)


def bisected(
    furniture: Furniture,
    direction: np.ndarray,
    left: np.ndarray,
    right: np.ndarray,
    left_good: np.ndarray,
    tolerance: float,
    wanted: int = ALL,
) -> tuple[np.ndarray, np.ndarray, int]:
    """The last valid and the first invalid parameters (k,) in brackets with one valid end each; tests that it took."""
    ends, beyond, tests = np.empty(len(left)), np.empty(len(left)), 0
    for k in range(len(left)):
        a, b, good = float(left[k]), float(right[k]), bool(left_good[k])
        while b - a > tolerance:
            middle = 0.5 * (a + b)
            same = (furniture.kernel.scan(direction, np.array([middle]), wanted)[0][0] == 0) == good
            a, b, tests = (middle, b, tests + 1) if same else (a, middle, tests + 1)
        ends[k], beyond[k] = (a, b) if good else (b, a)
    return ends, beyond, tests
