"""By how much values of a motion may be off for its time steps, from the estimated errors of single ones."""

from __future__ import annotations

import math
import sys
from collections import deque
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from restshape.analysis.row_values import number

if TYPE_CHECKING:
    from restshape.analysis.row_values import RowValue

UNKNOWN = sys.float_info.max
"""What a value may be off by, to either side, where nothing says by how much it is."""
RESOLVED = 10.0
"""Steps a period below which a motion is not resolved: its errors are then no small part of it."""
FRAMES = 5
"""Over which the largest error of a step counts: a frame may end where the motion hardly changes."""


class StepErrors:
    """Adds up the errors of single time steps over a period of the motion that makes them.

    A step of the average acceleration is off by (w dt)^3 / 12 of a motion of the angular frequency w. That gives the
    steps a period, and the error of all of them: that of the phase, w dt being off by (w dt)^2 / 12 of itself.

    Source: docs/theory/error-estimates.md, "Time steps".
    """

    def __init__(self) -> None:
        self._local: deque[float] = deque(maxlen=FRAMES)
        self._largest: dict[str, float] = {}

    def take(self, row: Mapping[str, RowValue], names: Iterable[str], estimated: bool = True) -> None:
        """Take note of the values of a frame, and of its estimated error of a step, where that is `estimated`."""
        if estimated:
            self._local.append(number(row, "estimate_time"))
        for name in names:
            size = abs(number(row, f"q_{name}"))
            if size > self._largest.get(name, 0.0):
                self._largest[name] = size

    def error(self, name: str) -> float:
        """By how much the value of a quantity may be off; 0 where nothing goes on in time."""
        local = max((one for one in self._local if math.isfinite(one)), default=0.0)
        if not local:
            return 0.0
        steps = steps_a_period(local)
        return UNKNOWN if steps < RESOLVED else steps * local * self._largest.get(name, 0.0)


def steps_a_period(local: float) -> float:
    """The steps a period of a motion of which one step is wrong by this share, with the average acceleration."""
    return 2.0 * math.pi / (12.0 * local) ** (1.0 / 3.0)
