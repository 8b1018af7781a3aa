"""How far two series of values are from each other, frame by frame."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from restshape.arrays import Reals


@dataclass(frozen=True)
class SeriesDifference:
    """The difference of a quantity, or of a field, over the frames that both results have.

    Args:
        name: of it.
        compared: frames that have a value in both.
        alone: frames, or in fields values, that have a number in one of the results only.
        largest: absolute difference, `rms` the root of its mean square; not numbers where nothing was compared.
        scale: the largest absolute value of both.
        frame: of the largest difference; -1 without one.
    """

    name: str
    compared: int
    alone: int
    largest: float
    rms: float
    scale: float
    frame: int

    @property
    def relative(self) -> float:
        """The largest difference over the largest absolute value; infinite where values stand alone."""
        if self.alone:
            return math.inf
        return self.largest / self.scale if self.scale else 0.0

    def plain(self) -> dict[str, object]:
        """What the JSON file holds of it."""
        numbers = {"largest": self.largest, "rms": self.rms, "relative": self.relative}
        found: dict[str, object] = {key: v if math.isfinite(v) else None for key, v in numbers.items()}
        return found | {"frame": self.frame, "compared": self.compared, "alone": self.alone}


class Gathered:
    """Gathers the difference of arrays, frame after frame.

    Args:
        name: of what is compared.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        self._frames = self._alone = self._count = 0
        self._frame, self._largest, self._squares, self._scale = -1, math.nan, 0.0, 0.0

    def add(self, frame: int, first: Reals, second: Reals) -> None:
        """Take in the values of a frame, of the same shape."""
        known = np.isfinite(first), np.isfinite(second)
        both = known[0] & known[1]
        self._alone += int((known[0] != known[1]).sum())
        if not both.any():
            return
        a, b = first[both].astype(float), second[both].astype(float)
        far = np.abs(a - b)
        most = float(far.max())
        self._frames += 1
        self._count += len(far)
        self._squares += float((far**2).sum())
        self._scale = max(self._scale, float(np.abs(a).max()), float(np.abs(b).max()))
        if not most <= self._largest:
            self._largest, self._frame = most, frame

    def difference(self) -> SeriesDifference:
        """The difference of all frames."""
        rms = math.sqrt(self._squares / self._count) if self._count else math.nan
        frame = self._frame if self._largest else -1
        return SeriesDifference(self.name, self._frames, self._alone, self._largest, rms, self._scale, frame)


def series_difference(name: str, first: Reals, second: Reals) -> SeriesDifference:
    """The difference of two series (n,) and (m,) in the frames that both have."""
    gathered = Gathered(name)
    for frame, (a, b) in enumerate(zip(first, second)):
        gathered.add(frame, np.array([a]), np.array([b]))
    return gathered.difference()
