"""The blow of a mallet: a force that rises and falls within the time of contact."""

import numpy as np


def pole(frequency: float, damping: float) -> complex:
    """The exponent s [1/s] of a mode that dies away as exp(s t).

    Args:
        frequency: [Hz], of the oscillation as it is heard; damping: share of critical damping.
    """
    return 2.0 * np.pi * frequency * complex(-damping, 1.0)


def excitation(s: complex, contact: float, t: np.ndarray) -> np.ndarray:
    """What a blow of unit impulse has given a mode by times t: the integral (n,) of F(u) exp(-s u) over u from 0 to t.

    The force is F(u) = (1 - cos(2 pi u / contact)) / contact. After the contact the integral stays: of modes far below
    1 / contact it is 1, beyond 2 / contact it falls with the third power of the frequency. So a soft mallet, which
    touches longer, leaves high modes still. With a contact of 0 it is 1 at once.

    Args:
        s: of the mode, as of `pole`; contact: time [s] for which mallet and plate touch; t: (n,) [s], not negative.
    """
    if contact <= 0.0:
        return np.ones(len(t), dtype=complex)
    until, turn = np.minimum(t, contact), 2.0j * np.pi / contact
    parts = (1.0, 0.0), (-0.5, turn), (-0.5, -turn)
    return sum(weight * _integral(rate - s, until) for weight, rate in parts) / contact


def _integral(z: complex, t: np.ndarray) -> np.ndarray:
    """The integral of exp(z u) over u from 0 to t (n,)."""
    if abs(z) * float(t.max(initial=0.0)) < 1e-6:
        return t * (1.0 + 0.5 * z * t)
    return np.expm1(z * t) / z
