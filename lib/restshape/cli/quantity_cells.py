"""Cells of tables of quantities: numbers with unit and SI prefix as in pictures, and the notes of tones."""

from collections.abc import Sequence
from math import isfinite

from restshape.analysis.pitch import A4, note
from restshape.outputs.si_numbers import si

MISSING = "–"
HEARD = (16.0, 20e3)
"""Frequencies [Hz] that are tones."""


def cells(values: Sequence[float | None], unit: str, digits: int = 5, others: Sequence[float | None] = ()) -> list[str]:
    """The values of one quantity, all with the prefix of the largest, `others` included; a dash where there is none."""
    known = [abs(value) for value in (*values, *others) if value is not None and isfinite(value)]
    largest = max(known, default=0.0)
    return [MISSING if value is None else si(value, unit, digits, largest) for value in values]


def unit_of(symbol: str) -> str:
    """A unit as tables and pictures write it."""
    return symbol.replace("^2", "²").replace("^3", "³")


def tone(frequency: float | None, unit: str, a4: float = A4) -> str:
    """The note nearest to a frequency and the cents above it, such as "A4 +3 cents"; empty of anything else."""
    if unit != "Hz" or frequency is None or not HEARD[0] <= frequency <= HEARD[1]:
        return ""
    name, cents = note(frequency, a4)
    return f"{name} {round(cents):+d} cents".replace("-", "\N{MINUS SIGN}")
