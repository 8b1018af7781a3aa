"""What is written beside the place of an extreme, in pictures and in live sessions."""

from math import isfinite

from restshape.outputs.si_numbers import si

EXTREMES = ("max", "min", "absmax", "peak")
"""Reductions to a value that the field has somewhere."""
DIGITS = 4
"""Of a value, or more where those of a frame lie close together."""


def extreme_words(name: str, value: float, error: float, unit: str, digits: int = DIGITS) -> str:
    """An extreme with its value, and its estimated error behind it where there is one.

    It is no ±, which elsewhere has twice the estimated error behind it: see `replay.constraints`.

    Args:
        name: of the quantity; value: its, in `unit`; error: estimated, not a number where there is none.
        unit: SI; digits: of the value.
    """
    beside = f" (error {si(abs(error), unit, 2)})" if isfinite(error) else ""
    return f"{name} {si(value, unit, digits)}{beside}"
