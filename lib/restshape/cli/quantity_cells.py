"""Cells of tables of quantities: numbers with unit and SI prefix as in pictures."""

from collections.abc import Sequence
from math import isfinite

from restshape.outputs.si_numbers import si

MISSING = "–"


def cells(values: Sequence[float | None], unit: str, digits: int = 5, others: Sequence[float | None] = ()) -> list[str]:
    """The values of one quantity, all with the prefix of the largest, `others` included; a dash where there is none."""
    known = [abs(value) for value in (*values, *others) if value is not None and isfinite(value)]
    largest = max(known, default=0.0)
    return [MISSING if value is None else si(value, unit, digits, largest) for value in values]
