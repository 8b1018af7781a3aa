"""Sounds as WAV files."""

import wave
from pathlib import Path

import numpy as np

from restshape.errors import UserError
from restshape.outputs.atomic_files import replacing
from restshape.outputs.kinds import mark_sound

RATE = 44100
"""Samples a second."""
PEAK = 0.9
"""Of the largest number that a WAV file holds."""


def normalised(sound: np.ndarray) -> np.ndarray:
    """A sound (n,) whose largest size is 1; silence stays silence."""
    largest = np.abs(sound).max(initial=0.0)
    return sound / largest if largest > 0.0 else sound


def write_wav(path: Path, sound: np.ndarray, rate: int = RATE) -> None:
    """Write a sound (n,) between -1 and 1 as a WAV file of one channel and 16 bits.

    Raises:
        UserError: the file cannot be written.
    """
    numbers = np.round(PEAK * 32767.0 * np.clip(sound, -1.0, 1.0)).astype("<i2")
    try:
        with replacing(path) as part, part.open("r+b") as raw:
            with wave.open(raw, "wb") as file:
                file.setnchannels(1)
                file.setsampwidth(2)
                file.setframerate(rate)
                file.writeframes(numbers.tobytes())
            mark_sound(raw)
    except OSError as error:
        raise UserError(f"cannot write: {error.strerror}", str(path), "choose a place that may be written") from error
