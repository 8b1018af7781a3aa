"""Names of tones in equal temperament."""

from collections.abc import Mapping
from math import isfinite, log2

NAMES = ("C", "C#", "D", "D#", "E", "F", "F#", "G", "G#", "A", "A#", "B")
A4 = 440.0
"""Usual frequency of the tone A4 [Hz]."""
A4_NUMBER = 69
"""Of the key A4 among all keys, from C of the octave -1 on (MIDI)."""


def note(frequency: float, a4: float = A4) -> tuple[str, float]:
    """The name of the nearest tone, such as "C#5", and how many cents the frequency lies above it.

    Args:
        frequency: [Hz]; no name where it is not a positive number.
        a4: frequency of A4 [Hz].
    """
    if not (isfinite(frequency) and frequency > 0.0):
        return "", float("nan")
    keys = A4_NUMBER + 12.0 * log2(frequency / a4)
    key = round(keys)
    return f"{NAMES[key % 12]}{key // 12 - 1}", 100.0 * (keys - key)


def tuning(effects: Mapping[str, Mapping[str, object]]) -> float:
    """The frequency of the tone A4 [Hz] by the effects of a scene, as `Scene.effects` gives them."""
    given = effects.get("modal", {}).get("a4", A4)
    return float(given) if isinstance(given, int | float) else A4
