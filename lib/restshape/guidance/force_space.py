"""Force space: forces in parts of what is allowed, how freedoms of a design change them, and combinations that help."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import comb

import numpy as np

from restshape import _kernels

LONGEST = 0.5
"""Of a step along a unit direction: half the body's size, or half a radian."""

LEAST_GAIN = 1e-3
"""Of the norm of the change of forces along a unit direction."""

SECONDS_EACH = 4e-8
"""Nominal time of a combination of three; one of k takes k / 3 of it. A named input, not a clock."""


@dataclass(frozen=True)
class ForceSpace:
    """Forces h (r,) with their box low <= h <= high, and their change K (m, r) by m freedoms.

    `gap` (r,) is what a step should take away: all of h for durability (6.19), what lies outside for stability (6.21).
    """

    K: np.ndarray
    h: np.ndarray
    gap: np.ndarray
    low: np.ndarray
    high: np.ndarray


@dataclass(frozen=True)
class Rays:
    """Combinations of freedoms that lead into the box.

    Args:
        modes: (k, M) numbers of freedoms, -1 where there are fewer.
        parts: (k, M) unit directions in them.
        spans: (k, 2) where along it the box is entered and left.
        tried: combinations tried of each number of freedoms.
    """

    modes: np.ndarray
    parts: np.ndarray
    spans: np.ndarray
    tried: tuple[int, ...]

    def each(self) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Freedoms, parts and span of each."""
        for modes, parts, span in zip(self.modes, self.parts, self.spans):
            used = modes >= 0
            yield modes[used], parts[used], span


@dataclass(frozen=True)
class Forecast:
    """How many combinations there are of at most so many modes, and how long they take [s], before any is tried."""

    combinations: int
    seconds: float


def forecast(freedoms: int, most: int) -> Forecast:
    """What a search over all combinations of at most `most` of so many freedoms would take."""
    counts = [comb(freedoms, k) for k in range(1, most + 1)]
    return Forecast(sum(counts), SECONDS_EACH * sum(count * k / 3 for k, count in enumerate(counts, 1)))


def combinations(
    space: ForceSpace,
    most: int = 3,
    least: int = 1,
    barred: Sequence[tuple[int, ...]] = (),
    keep: int = 0,
    longest: float = LONGEST,
    least_gain: float = LEAST_GAIN,
) -> Rays:
    """Combinations of `least` to `most` freedoms whose least squares direction leads into the box.

    Left out are those with too small a change, and those that hold a barred combination.

    Args:
        space: forces and their derivatives.
        barred: combinations that already work, each with its freedoms in rising order.
        keep: rays kept for each number of freedoms and leading freedom, the widest first; 0 keeps all.
        longest: step along a unit direction.
        least_gain: norm of the change of forces along a unit direction.

    Source: (6.18) to (6.21) of the thesis.
    """
    modes, parts, spans, tried = _kernels.combinations(
        space.K, space.h, space.gap, space.low, space.high, most, least, least_gain, longest, barred, keep
    )
    return Rays(modes, parts, spans, tuple(tried))
