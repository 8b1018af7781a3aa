"""The sound of a plate that is struck, a sum of damped modes, as a WAV file."""

import wave
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from restshape.analysis.modal import ModalAnalysis
from restshape.errors import UserError
from restshape.outputs.atomic_files import replacing
from restshape.outputs.kinds import mark_sound

PEAK = 0.9
"""Of the largest number that a WAV file holds."""

ROUND = 0.1
"""Share of a triangle's height by which a curved outline may lie outside it."""
ATTACK = 1e-3
"""Time [s] over which the mallet's blow brings the sound up: no sound begins with a jump."""


def struck(
    frequencies: np.ndarray, deflections: np.ndarray, damping: float, seconds: float, rate: int = 44100
) -> np.ndarray:
    """The sound (n,), its largest size 1, of a blow: each mode sounds as it moves where it is struck.

    A blow gives mode k the speed phi_k at the point that it hits; the air hears the acceleration, f_k phi_k times a
    sine that dies away with exp(-damping 2 pi f_k t). Modes that the rate cannot hold are left out.

    Args:
        frequencies: (k,) [Hz]; deflections: (k,) of the modes where they are struck.
        damping: share of critical damping; about 1e-3 for metal bars that hang.
        seconds: how long; rate: samples a second.
    """
    t = np.arange(round(seconds * rate)) / rate
    sound = np.zeros_like(t)
    for f, phi in zip(frequencies, deflections):
        if f < 0.5 * rate:
            sound += phi**2 * f * np.exp(-damping * 2.0 * np.pi * f * t) * np.sin(2.0 * np.pi * f * t)
    sound *= 1.0 - np.exp(-t / ATTACK)
    largest = np.abs(sound).max(initial=0.0)
    return sound / largest if largest > 0.0 else sound


def write_wav(path: Path, sound: np.ndarray, rate: int = 44100) -> None:
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


def _on_plate(corners: np.ndarray, place: np.ndarray) -> bool:
    """Whether a place (2,) lies in one of the triangles (ne, 3, 2), or just outside, where the outline is curved."""
    a, u, v = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area, to = np.cross(u, v), place - a
    s, t = np.cross(to, v) / area, np.cross(u, to) / area
    return bool((np.minimum(np.minimum(s, t), 1.0 - s - t) >= -ROUND).any())


def struck_node(analysis: ModalAnalysis, at: Sequence[float] | None) -> int:
    """The node of the plane mesh that is struck: the nearest to a place [m], or where mode 1 moves most inside.

    Raises:
        UserError: the place is off the plate, or in a hole of it.
    """
    X = analysis.space.X
    if at is not None:
        place = np.array(at, dtype=float)
        if not _on_plate(X[analysis.space.cells[:, :3]], place):
            (left, low), (right, high) = X.min(axis=0), X.max(axis=0)
            what = f"({at[0]:g}, {at[1]:g}) m lies off the plate, or in a hole of it"
            spans = f"it goes from {left:.4g} to {right:.4g} m along x, from {low:.4g} to {high:.4g} m along y"
            raise UserError(what, f"--at {at[0]:g} {at[1]:g}", f"name a place on the plate, in metres: {spans}")
        return int(np.argmin(np.linalg.norm(X - place, axis=1)))
    first = next(iter(analysis.fields()[0].values()))
    size = np.linalg.norm(first, axis=1)
    size[np.unique(analysis.space.facets)] = 0.0
    return int(np.argmax(size))
