"""Numbers with their units and SI prefixes, alike on the console and in pictures."""

from collections.abc import Sequence
from math import ceil, isfinite, log10

_LETTERS = {-4: "p", -3: "n", -2: "µ", -1: "m", 0: "", 1: "k", 2: "M", 3: "G", 4: "T"}
_PREFIXES = {power: (10.0 ** (-3 * power), letter) for power, letter in _LETTERS.items()}
"""The factor and the letter of each power of 1000."""
UNPREFIXED = ("1", "m²", "m^2", "m³", "m^3", "kg", "K", "deg", "°", "cent")
"""Beginnings of units whose prefix would be read for another one, or is not used."""


def unit_of(symbol: str) -> str:
    """A unit as tables and pictures write it."""
    return symbol.replace("^2", "²").replace("^3", "³")


def prefix(size: float) -> tuple[float, str]:
    """The factor and SI prefix that bring a number of this size between 1 and 1000."""
    if not isfinite(size) or size == 0:
        return 1.0, ""
    # The exponent of the number as it is rounded for people.
    exponent = int(f"{size:.4e}".partition("e")[2])
    return _PREFIXES[min(max(exponent // 3, -4), 4)]


def scaled_unit(size: float, unit: str) -> tuple[float, str]:
    """The factor and unit in which such a number reads well, such as 1e-6 and "MPa"; units that take no prefix stay."""
    if not unit or unit.startswith(UNPREFIXED):
        return 1.0, unit
    factor, letter = prefix(size)
    return factor, letter + unit


def length_unit(size: float) -> tuple[float, str]:
    """The factor and unit for axes of a part of this size [m]."""
    return (1.0, "m") if size >= 1 else (1e3, "mm") if size >= 1e-3 else (1e6, "µm")


def si(value: float, unit: str = "", digits: int = 3, like: float | None = None) -> str:
    """A number with its unit, e.g. ``si(2.1e-4, "m") == "210 µm"``; the prefix is that of ``like``, if given."""
    if not isfinite(value):
        return "–"
    factor, shown = scaled_unit(value if like is None else like, unit)
    text = f"{value * factor + 0.0:.{digits}g}"
    if "e" in text and 1 <= abs(value * factor) < 1e5:
        text = f"{value * factor:.0f}"
    return f"{text} {shown}".rstrip()


MOST_DIGITS = 9
"""Of a number that tells values apart: those that differ by less are the same."""


def digits_apart(values: Sequence[float], usual: int) -> int:
    """Significant digits with which values that lie close together are told apart, `usual` of them where that does.

    Temperatures of 293.16 K and 293.24 K differ by 0.03 % of their size: five digits hardly show a difference.
    """
    known = [value for value in values if isfinite(value)]
    spread = max(known, default=0.0) - min(known, default=0.0)
    if spread <= 0.0:
        return usual
    needed = 2 + ceil(log10(max(map(abs, known)) / spread))
    return max(usual, needed) if needed <= MOST_DIGITS else usual


def three_digits(value: float) -> str:
    """A number to three digits, or to all before the point: ``three_digits(2843.7) == "2844"``."""
    return f"{value:.0f}" if 999.5 <= abs(value) < 1e7 else f"{value:.3g}"


def counted(number: int, what: str) -> str:
    """How many there are: ``counted(1, "frame") == "1 frame"``, ``counted(2, "frame") == "2 frames"``."""
    return f"{number} {what}{'' if number == 1 else 's'}"


def counted_are(number: int, what: str) -> str:
    """The same before what is said of them: ``counted_are(1, "frame") == "1 frame is"``."""
    return f"{counted(number, what)} {'is' if number == 1 else 'are'}"
