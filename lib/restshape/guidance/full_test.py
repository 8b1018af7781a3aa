"""The full test of a design: which flaws it has where it has been changed."""

from typing import Protocol

import numpy as np

EVERY_FLAW = -1
"""All bits: no flaw is left out."""


class FullTest(Protocol):
    """Tests a design that is changed by t along a direction of its design parameters; flaws are bits of a number."""

    def scan(self, direction: np.ndarray, t: np.ndarray, wanted: int) -> tuple[np.ndarray, ...]:
        """First the flaws (s,) at parameters t (s,), of those wanted; others may be left out."""

    def bisect(
        self, direction: np.ndarray, good: float, bad: float, tolerance: float, wanted: int
    ) -> tuple[float, float, int]:
        """The last valid and the first invalid parameter that are found, nearer than the tolerance, and the tests."""
