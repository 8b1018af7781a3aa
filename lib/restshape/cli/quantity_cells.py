"""Cells of tables of quantities: numbers with unit and SI prefix as in pictures."""

from collections.abc import Sequence
from math import isfinite

from restshape.outputs.si_numbers import digits_apart, si

MISSING = "–"


METRES = 10.0
"""Lengths below this size are in millimetres beside others that are [m]."""


def shared_size(size: float, others: Sequence[float]) -> float:
    """The size [m] whose prefix a length has in a table: one of metres is in millimetres beside one that is.

    Args:
        size: of the largest value of the column.
        others: the same of all lengths of the table.
    """
    return 0.1 if 1.0 <= size < METRES and any(1e-3 <= one < 1.0 for one in others) else size


def cells(values: Sequence[float | None], unit: str, digits: int = 5) -> list[str]:
    """The values of one quantity, with the prefix of the largest and told apart; a dash where there is none."""
    known = [value for value in values if value is not None and isfinite(value)]
    largest, digits = max(map(abs, known), default=0.0), digits_apart(known, digits)
    return [MISSING if value is None else si(value, unit, digits, largest) for value in values]
