"""Texts of frames that say the same but for their numbers."""

import re

from restshape.replay.constraints import UNSURE

UNCERTAIN_VALUES = re.compile(f"(?<={UNSURE})[^;:]*")
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.]*\w)")
"""A number by itself: none of a name, such as that of `rail_2`."""


def without_numbers(text: str) -> str:
    """A text whose numbers are left out: of uncertain values with their units, which change with their size."""
    return NUMBER.sub("#", UNCERTAIN_VALUES.sub("", text))


def severity(text: str) -> float:
    """The size of the first number of a text, the largest of which is the worst of those that say the same; 0: none."""
    found = NUMBER.search(text)
    return abs(float(found.group())) if found else 0.0
