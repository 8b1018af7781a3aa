"""Base excitation at one frequency."""

from __future__ import annotations

from math import pi, sin
from typing import Any

import numpy as np


class HarmonicExcitation:
    """Harmonic motion of the ground: displacement -A / w^2 sin(w t), acceleration A sin(w t) along a direction.

    Args:
        settings: of ``[effects.ground]``.
        before, now: the motion until this time [s]; where the frequency changes, the phase goes on.
    """

    def __init__(self, settings: Any, before: HarmonicExcitation | None = None, now: float = 0.0) -> None:
        direction = np.array(settings.direction, dtype=float)
        self.omega = 2 * pi * settings.frequency
        size = settings.acceleration if settings.acceleration is not None else -settings.displacement * self.omega**2
        self.direction = direction / np.linalg.norm(direction)
        self.amplitude = size * self.direction
        self.phase = 0.0 if before is None else before.phase + (before.omega - self.omega) * now

    def acceleration(self, t: float) -> np.ndarray:
        """The ground's acceleration (2,) [m/s^2] at the time t [s]."""
        return self.amplitude * sin(self.omega * t + self.phase)
