"""Base excitation: the ground at one frequency, or by a record of its acceleration."""

from __future__ import annotations

from math import pi, sin
from pathlib import Path
from typing import Protocol

import numpy as np

from restshape.physics.elasticity.ground_record import GroundRecord, read_record


class GroundSettings(Protocol):
    """What ``[effects.ground]`` says: see `motion_effects.GroundKeys`."""

    direction: tuple[float, float]
    displacement: float | None
    acceleration: float | None
    frequency: float | None
    file: str | None
    scale: float
    start: float


class BaseExcitation(Protocol):
    """A motion of the ground along a direction (2,) of length 1."""

    direction: np.ndarray

    def acceleration(self, t: float) -> np.ndarray:
        """The ground's acceleration (2,) [m/s^2] at the time t [s]."""

    def phase_after(self, omega: float, now: float) -> float:
        """The phase with which a harmonic motion of angular frequency omega [rad/s] goes on at a time [s]."""


class HarmonicExcitation:
    """Harmonic motion of the ground: displacement -A / w^2 sin(w t), acceleration A sin(w t) along a direction.

    Args:
        settings: of ``[effects.ground]``.
        before, now: the motion until this time [s]; where the frequency changes, the phase goes on.
    """

    def __init__(self, settings: GroundSettings, before: BaseExcitation | None = None, now: float = 0.0) -> None:
        self.omega = 2 * pi * (settings.frequency or 0.0)
        size = settings.acceleration
        if size is None:
            size = -(settings.displacement or 0.0) * self.omega**2
        self.direction = unit_vector(settings.direction)
        self.amplitude = size * self.direction
        self.phase = 0.0 if before is None else before.phase_after(self.omega, now)

    def acceleration(self, t: float) -> np.ndarray:
        """The ground's acceleration (2,) [m/s^2] at the time t [s]."""
        return self.amplitude * sin(self.omega * t + self.phase)

    def phase_after(self, omega: float, now: float) -> float:
        """See `BaseExcitation`: the motion goes on where it is."""
        return self.phase + (self.omega - omega) * now


class RecordedExcitation:
    """The ground's acceleration along a direction as a record says, linear between its samples.

    Args:
        record: of the acceleration.
        settings: of ``[effects.ground]``: `scale` of the accelerations, `start` of the record in simulated time [s].
    """

    def __init__(self, record: GroundRecord, settings: GroundSettings) -> None:
        self.record, self.start = record, settings.start
        self.direction = unit_vector(settings.direction)
        self.amplitude = settings.scale * self.direction

    def acceleration(self, t: float) -> np.ndarray:
        """The ground's acceleration (2,) [m/s^2] at the time t [s]."""
        return self.amplitude * self.record(t - self.start)

    def phase_after(self, omega: float, now: float) -> float:
        """See `BaseExcitation`: a harmonic motion after a record begins from 0."""
        return -omega * now


def base_excitation(settings: GroundSettings, before: BaseExcitation | None, now: float) -> BaseExcitation:
    """The motion of the ground that ``[effects.ground]`` asks for.

    Args:
        settings: with the path of the file as it is opened.
        before, now: the motion until this time [s].

    Raises:
        UserError: the file of a record cannot be read.
    """
    if settings.file is not None:
        return RecordedExcitation(read_record(Path(settings.file)), settings)
    return HarmonicExcitation(settings, before, now)


def unit_vector(direction: tuple[float, float]) -> np.ndarray:
    """A direction (2,) of length 1."""
    vector = np.array(direction, dtype=float)
    return vector / np.linalg.norm(vector)
