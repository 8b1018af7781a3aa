"""Names of tones in equal temperament."""

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


def tuned(frequency: float, name: str, cents: float) -> float:
    """The frequency of A4 [Hz] by which `note` gives a frequency [Hz] this name and these cents."""
    letter = name.rstrip("-0123456789")
    key = NAMES.index(letter) + 12 * (int(name.removeprefix(letter)) + 1)
    return frequency / 2.0 ** ((key - A4_NUMBER + 0.01 * cents) / 12.0)
