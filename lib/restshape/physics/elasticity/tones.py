"""Notes beside frequencies, tuned as the frame that has them."""

from collections.abc import Mapping
from math import isfinite

from restshape.analysis.modal.pitch import A4, note, tuned

HEARD = (16.0, 20e3)
"""Frequencies [Hz] that are tones."""


def tone(frequency: float, row: Mapping[str, object]) -> str:
    """The note nearest to a frequency [Hz] and the cents above it, such as "A4 +3 cents"; empty of what is not heard.

    Args:
        frequency: [Hz].
        row: columns of its frame: `tone` and `cents` of its first frequency `f_1` say how it is tuned. Frames of what
            is not struck to be heard, such as a building, have no `tone`, and their frequencies no note.
    """
    if "tone" not in row or not HEARD[0] <= frequency <= HEARD[1]:
        return ""
    name, cents = note(frequency, _tuning(row))
    return f"{name} {round(cents):+d} cents".replace("-", "\N{MINUS SIGN}")


def _tuning(row: Mapping[str, object]) -> float:
    """The frequency of A4 [Hz] in a frame; the usual one where it does not say."""
    first, name, cents = row.get("f_1"), row.get("tone"), row.get("cents")
    text = name.decode() if isinstance(name, bytes) else str(name or "")
    if not (text and isinstance(first, int | float) and isinstance(cents, int | float) and isfinite(first + cents)):
        return A4
    return tuned(float(first), text, float(cents))
