"""Closed forms of beams and plates that bend and shear."""

import numpy as np

from restshape.analysis.modal.modal import ModalAnalysis

SHEAR = 5 / 6
"""Shear factor of a rectangular section."""


def mindlin(analysis: ModalAnalysis, side: float, m: int, n: int) -> float:
    """The frequency [Hz] of m x n half waves of a simply supported square Mindlin plate of the only material."""
    own = next(iter(analysis.state.scene.material.values()))
    h = own.thickness
    shear, bending = SHEAR * own.E / (2 * (1 + own.nu)) * h, own.E * h**3 / (12 * (1 - own.nu**2))
    return thick_wave(np.pi / side * np.hypot(m, n), shear, bending, own.rho * h, own.rho * h**3 / 12)


def thick_wave(wave: float, shear: float, bending: float, mass: float, inertia: float) -> float:
    """The lower frequency [Hz] of a wave [1/m] in what bends and shears, by width.

    Args:
        wave: wave number.
        shear: stiffness [N/m]; bending: stiffness [N m].
        mass: [kg/m^2]; inertia: of rotation [kg].
    """
    # The determinant of the two equations of motion is a quadratic in omega^2.
    a = mass * inertia
    b = -(mass * (bending * wave**2 + shear) + inertia * shear * wave**2)
    c = shear * wave**2 * bending * wave**2
    square = (-b - np.sqrt(b * b - 4 * a * c)) / (2 * a)
    return float(np.sqrt(square) / (2 * np.pi))
