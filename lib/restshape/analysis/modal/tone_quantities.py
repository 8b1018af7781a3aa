"""Quantities of modes that are heard: how far one is from a named tone, and its frequency over that of the first."""

from math import log

import numpy as np

from restshape.analysis.modal.pitch import cents_between, frequency_of
from restshape.scene.model import Quantity

CENTS = 1200.0 / log(2.0)
"""Cents by which a small relative change moves a frequency, over that change."""
TONES = ("cents", "ratio")
"""Their kinds."""
FIRST = 1
"""The id of the mode that was the lowest at the start."""


def frequency_of_mode(number: int, frequencies: np.ndarray, ids: np.ndarray) -> float:
    """The frequency [Hz] of the mode with an id, of frequencies (modes,) and ids (modes,); not a number without it."""
    return float(next(iter(frequencies[ids == number]), np.nan))


def tone_value(quantity: Quantity, a4: float, frequencies: np.ndarray, ids: np.ndarray) -> float:
    """The value of a quantity `cents` or `ratio`; not a number where a mode is gone.

    Args:
        quantity: of the scene.
        a4: frequency of A4 [Hz].
        frequencies: (modes,) [Hz]; ids: (modes,) of their modes.
    """
    overtone = quantity.number("ratio")
    first = frequency_of_mode(FIRST if overtone else named_mode(quantity), frequencies, ids)
    if overtone is not None:
        other = frequency_of_mode(overtone, frequencies, ids)
        return other / first if first > 0.0 else np.nan
    return cents_between(first, frequency_of(str(quantity.cents), a4)) if first > 0.0 else np.nan


def tone_error(quantity: Quantity, errors: np.ndarray, frequencies: np.ndarray, ids: np.ndarray) -> float:
    """The error of a quantity `cents` or `ratio` from relative errors (modes,) of frequencies.

    Errors of the two frequencies of a ratio add up: what a mesh does to one it need not do to the other.
    Other arguments as in `tone_value`.
    """
    overtone = quantity.number("ratio")
    if overtone is not None:
        first, other = (frequency_of_mode(number, frequencies, ids) for number in (FIRST, overtone))
        both = [frequency_of_mode(number, errors, ids) for number in (FIRST, overtone)]
        return abs(other / first) * sum(both) if first > 0.0 else np.nan
    return CENTS * frequency_of_mode(named_mode(quantity), errors, ids)


def named_mode(quantity: Quantity) -> int:
    """The id of the mode that a quantity `cents` is of."""
    return quantity.number("mode") or FIRST
