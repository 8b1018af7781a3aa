"""Names of tones in equal temperament."""

import re
from math import isfinite, log2

from restshape.errors import UserError

NAMES = ("C", "C#", "D", "D#", "E", "F", "F#", "G", "G#", "A", "A#", "B")
A4 = 440.0
"""Usual frequency of the tone A4 [Hz]."""
A4_NUMBER = 69
"""Of the key A4 among all keys, from C of the octave -1 on (MIDI)."""

_WRITTEN = re.compile(r"([A-G])([#\N{MUSIC SHARP SIGN}b\N{MUSIC FLAT SIGN}]?)(-1|[0-9])")
_STEP = {"": 0, "#": 1, "\N{MUSIC SHARP SIGN}": 1, "b": -1, "\N{MUSIC FLAT SIGN}": -1}


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


def tone_words(name: str, cents: float) -> str:
    """A tone in a caption; below the octave 0, where A-1 would read as if -1 were cents, in words."""
    return "below C0" if "-" in name else f"{name} {cents:+.0f} cents"


def frequency_of(name: str, a4: float = A4, where: str = "") -> float:
    """The frequency [Hz] of a tone in equal temperament.

    Args:
        name: such as "C5", "F#4" or "Bb3"; octaves -1 to 9, C4 is the middle C.
        a4: frequency of A4 [Hz].
        where: the name is written, for the message.

    Raises:
        UserError: no tone has this name.
    """
    written = _WRITTEN.fullmatch(name)
    if written is None:
        remedy = "write a letter from A to G, # or b if need be, and an octave from -1 to 9: C5, F#4, Bb3"
        raise UserError(f"no tone is named {name!r}", where, remedy)
    letter, sign, octave = written.groups()
    key = NAMES.index(letter) + _STEP[sign] + 12 * (int(octave) + 1)
    return a4 * 2.0 ** ((key - A4_NUMBER) / 12.0)


def cents_between(frequency: float, other: float) -> float:
    """How many cents a frequency lies above another one; both of the same unit, and positive."""
    return 1200.0 * log2(frequency / other)


def tuned(frequency: float, name: str, cents: float) -> float:
    """The frequency of A4 [Hz] by which `note` gives a frequency [Hz] this name and these cents."""
    letter = name.rstrip("-0123456789")
    key = NAMES.index(letter) + 12 * (int(name.removeprefix(letter)) + 1)
    return frequency / 2.0 ** ((key - A4_NUMBER + 0.01 * cents) / 12.0)
