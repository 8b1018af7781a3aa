"""Quantiles of many numbers in bounded memory."""

import random
from array import array

import numpy as np

SIZE = 4096
"""Numbers that are kept: quantiles of up to as many are exact."""
SEED = 0


class Reservoir:
    """A uniform random sample of numbers that come one by one: Vitter's algorithm R, with a fixed seed.

    A quantile p of `count` numbers is that of p with a standard deviation of sqrt(p (1 - p) / SIZE): of the 95th
    percentile 0.34 of a percent of the numbers.

    Source: J. S. Vitter, Random sampling with a reservoir, ACM TOMS 11 (1985) 37-57.

    Attributes:
        count: of all numbers so far.
        largest: of all; NaN where there is none.
    """

    def __init__(self) -> None:
        self.count = 0
        self.largest = float("nan")
        self._kept = array("d")
        self._random = random.Random(SEED)

    def add(self, value: float) -> None:
        """Takes one number."""
        self.count += 1
        self.largest = value if not value <= self.largest else self.largest
        if self.count <= SIZE:
            self._kept.append(value)
        elif (place := self._random.randrange(self.count)) < SIZE:
            self._kept[place] = value

    def quantiles(self, percents: tuple[float, ...]) -> list[float]:
        """Percentiles; zeros where there are no numbers."""
        return [float(value) for value in np.percentile(self._kept, percents)] if self._kept else [0.0] * len(percents)
