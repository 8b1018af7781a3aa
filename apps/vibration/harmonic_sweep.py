"""Steady motions of a shape on ground that moves at one frequency, over many frequencies."""

from dataclasses import dataclass

import numpy as np
from restshape_apps.vibration.stage import Structure

from restshape.analysis.harmonic import harmonic_response


@dataclass(frozen=True, eq=False)
class Sweep:
    """Steady motions over frequencies.

    Args:
        frequencies: (m,) [Hz].
        acceleration: amplitude A of the ground [m/s^2].
        relative: complex amplitudes (m,) [m] by quantity, relative to the ground.
        transmissibility: (m,) by quantity: the amplitude in space over that of the ground.
    """

    frequencies: np.ndarray
    acceleration: float
    relative: dict[str, np.ndarray]
    transmissibility: dict[str, np.ndarray]


def sweep(shape: Structure, frequencies: np.ndarray, acceleration: float = 1.0) -> Sweep:
    """The steady motions of a shape.

    Args:
        shape: with the scene's damping.
        frequencies: (m,) positive [Hz].
        acceleration: amplitude of the ground [m/s^2].
    """
    stiffness, mass, damping = shape.analysis.matrices()
    load = -acceleration * shape.inertia()
    found = []
    for frequency in frequencies:
        omega = 2.0 * np.pi * frequency
        found.append(shape.looked(harmonic_response(stiffness, mass, damping, omega, load)))
    relative = {name: np.array([one[name] for one in found]) for name in shape.looks}
    ground = -acceleration / (2.0 * np.pi * frequencies) ** 2
    ratios = {
        name: np.abs(values + ground * shape.direction[shape.columns[name]]) / np.abs(ground)
        for name, values in relative.items()
    }
    return Sweep(np.asarray(frequencies), acceleration, relative, ratios)
