"""The sound of a plate that is struck, a sum of damped modes, as a WAV file.

python -m restshape_apps.metallophone.sound SCENE --out FILE [--edits FILE] [--at X Y]
"""

import argparse
import sys
import wave
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from restshape_apps.metallophone.stage import add_scene, analysed

from restshape.analysis.modal import ModalAnalysis
from restshape.cli.options import refuse_overwriting
from restshape.errors import UserError
from restshape.outputs.kinds import SoundFile, mark_sound
from restshape.outputs.whole import replacing

PEAK = 0.9
"""Of the largest number that a WAV file holds."""

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


def struck_node(analysis: ModalAnalysis, at: Sequence[float] | None) -> int:
    """The node of the plane mesh that is struck: the nearest to a place [m], or where mode 1 moves most inside."""
    X = analysis.space.X
    if at is not None:
        return int(np.argmin(np.linalg.norm(X - np.array(at), axis=1)))
    first = next(iter(analysis.fields()[0].values()))
    size = np.linalg.norm(first, axis=1)
    size[np.unique(analysis.space.facets)] = 0.0
    return int(np.argmax(size))


def main(words: Sequence[str] | None = None) -> int:
    """Write the sound; 0 on success, 2 on bad input."""
    parser = argparse.ArgumentParser(prog="python -m restshape_apps.metallophone.sound", description=__doc__)
    add_scene(parser)
    parser.add_argument("--out", type=SoundFile, required=True, metavar="FILE", help="the sound (.wav)")
    parser.add_argument("--at", type=float, nargs=2, metavar=("X", "Y"), help="where it is struck [m]")
    parser.add_argument("--damping", type=float, default=1e-3, help="share of critical damping (default: %(default)s)")
    parser.add_argument("--seconds", type=float, default=2.0, help="how long (default: %(default)s)")
    args = parser.parse_args(words)
    try:
        refuse_overwriting(args)
        if not (args.damping >= 0.0 and args.seconds > 0.0):
            raise UserError("damping is not negative, and time is positive", "--damping, --seconds", "leave them out")
        analysis = analysed(args)
        node = struck_node(analysis, args.at)
        shapes = analysis.state.body.shapes(analysis.state.modes.vectors[analysis.state.modes.chosen])[:, node]
        write_wav(args.out, struck(analysis.frequencies, np.linalg.norm(shapes, axis=1), args.damping, args.seconds))
    except UserError as error:
        print(f"sound: {error}", file=sys.stderr)
        return 2
    x, y = analysis.space.X[node]
    print(f"wrote {args.out}: struck at ({x:.4g}, {y:.4g}) m, {', '.join(f'{f:.1f}' for f in analysis.frequencies)} Hz")
    return 0


if __name__ == "__main__":
    sys.exit(main())
