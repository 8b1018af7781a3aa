"""What a bar is tuned to: the frequency of its first tone, and of overtones by their ratio to it."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import isfinite

from restshape.analysis.modal.pitch import frequency_of
from restshape.errors import UserError

MOST_OVERTONES = 6
"""Ratios that can be asked for, that of the first tone included."""


@dataclass(frozen=True)
class Wanted:
    """The wanted tones.

    Args:
        tone: name of the first one.
        ratios: of all frequencies to the first, which is 1 itself.
        frequencies: [Hz].
    """

    tone: str
    ratios: tuple[float, ...]
    frequencies: tuple[float, ...]


def wanted_tones(tone: str, overtones: str | None, a4: float) -> Wanted:
    """The wanted tones.

    Args:
        tone: name of the first one, such as "C5".
        overtones: ratios such as "1:4:10"; None: the first tone alone.
        a4: frequency of A4 [Hz].

    Raises:
        UserError: there is no such tone, or the ratios make no sense.
    """
    first = frequency_of(tone, a4, "--to")
    ratios = _ratios(overtones) if overtones else (1.0,)
    return Wanted(tone, ratios, tuple(first * ratio for ratio in ratios))


def _ratios(text: str) -> tuple[float, ...]:
    where, do = f"--overtones {text}", "write 1 and the wanted ratios in ascending order, such as 1:4:10"
    try:
        ratios = tuple(float(word) for word in text.split(":"))
    except ValueError:
        raise UserError("these are no ratios", where, do) from None
    if not all(map(isfinite, ratios)) or ratios[0] != 1.0:
        raise UserError("the ratios do not begin with 1, that of the first tone to itself", where, do)
    if any(ratio < 1.0 for ratio in ratios):
        raise UserError("a ratio is below 1: no mode lies below the first one", where, do)
    if any(b <= a for a, b in pairwise(ratios)):
        raise UserError("the ratios do not ascend", where, do)
    if len(ratios) > MOST_OVERTONES:
        raise UserError(f"there are more than {MOST_OVERTONES} ratios", where, do)
    return ratios
