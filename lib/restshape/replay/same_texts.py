"""Texts of frames that say the same but for their numbers."""

import re

from restshape.replay.constraints import UNSURE
from restshape.scene.units import UnitError, finite_quantity

UNCERTAIN_VALUES = re.compile(f"(?<={UNSURE})[^;:]*")
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.]*\w)")
"""A number by itself: none of a name, such as that of `rail_2`."""
UNIT = re.compile(r" [^\s,;:]+")


def without_numbers(text: str) -> str:
    """A text whose numbers are left out: of uncertain values with their units, which change with their size."""
    return NUMBER.sub("#", UNCERTAIN_VALUES.sub("", text))


def severity(text: str) -> float:
    """The size of the first number of a text in its SI unit; 0: none.

    The largest is the worst of texts that say the same.
    """
    found = NUMBER.search(text)
    if found is None:
        return 0.0
    unit = UNIT.match(text, found.end())
    try:
        return abs(finite_quantity(found.group() + unit.group() if unit else found.group(), None)[0])
    except UnitError:
        # The word behind it is no unit.
        return abs(float(found.group()))
