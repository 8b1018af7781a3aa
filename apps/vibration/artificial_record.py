"""A record of ground acceleration made by a formula: filtered noise under an envelope, the same on each run.

restshape ground-record --out FILE.csv

    a(t) = P e(t) / max |e s| s(t),   s(t) = sum over k of sqrt(S(w_k)) cos(w_k t + 2 pi q k^2),   w_k = 2 pi k / T

S is the spectrum of Kanai and Tajimi (ground of frequency w_g and damping z_g) with the filter of Clough and Penzien,
which takes out what is slow; q = (sqrt(5) - 1) / 2 makes the phases look random. The envelope e rises with the square
of time, stays, and dies away.

Source: K. Kanai, Bull. Earthq. Res. Inst. 35 (1957) 309; H. Tajimi, Proc. 2nd WCEE (1960); R. W. Clough and J. Penzien,
Dynamics of Structures (1975), section 26-4; envelope: P. C. Jennings, G. W. Housner, N. C. Tsai (1968).
"""

import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from restshape.errors import UserError, one_line
from restshape.outputs.atomic_files import write_whole
from restshape.outputs.kinds import TABLE_MARK, TableFile

HIGHEST = 25.0
"""Frequency of the last term of the sum [Hz]."""


@dataclass(frozen=True)
class Ground:
    """What the formula takes.

    Args:
        peak: largest acceleration [m/s^2].
        frequency, damping: of the ground [Hz], as a share of critical damping.
        slow: frequency of the second filter [Hz], which has the same damping.
        rise, strong: when the strongest part begins and ends [s].
        decay: rate at which it dies away then [1/s].
        seconds: how long; the sum repeats after twice this time.
    """

    peak: float = 2.5
    frequency: float = 2.5
    damping: float = 0.6
    slow: float = 0.25
    rise: float = 3.0
    strong: float = 9.0
    decay: float = 0.35
    seconds: float = 20.0


def spectrum(ground: Ground, frequencies: np.ndarray) -> np.ndarray:
    """The spectral density (n,) at frequencies (n,) [Hz], 1 at the slow end of the ground's own filter."""
    r, s, z = frequencies / ground.frequency, frequencies / ground.slow, 2.0 * ground.damping
    own = (1.0 + (z * r) ** 2) / ((1.0 - r**2) ** 2 + (z * r) ** 2)
    return own * s**4 / ((1.0 - s**2) ** 2 + (z * s) ** 2)


def envelope(ground: Ground, t: np.ndarray) -> np.ndarray:
    """How strong it is (n,) at times t (n,) [s], from 0 to 1."""
    rising = np.clip(t / ground.rise, 0.0, 1.0) ** 2
    return rising * np.exp(-ground.decay * np.clip(t - ground.strong, 0.0, None))


def accelerations(ground: Ground, t: np.ndarray) -> np.ndarray:
    """The acceleration (n,) [m/s^2] at times t (n,) [s]."""
    step = 0.5 / ground.seconds
    k = np.arange(1, round(HIGHEST / step) + 1)
    phases = 2.0 * np.pi * np.mod(0.5 * (np.sqrt(5.0) - 1.0) * k**2, 1.0)
    terms = np.cos(2.0 * np.pi * step * np.outer(t, k) + phases)
    found = envelope(ground, t) * (terms @ np.sqrt(spectrum(ground, step * k)))
    return ground.peak / np.abs(found).max() * found


def record_text(ground: Ground, dt: float = 0.01) -> str:
    """The lines of the record as `[effects.ground]` reads them, a sample each dt [s], rounded to 10 um/s^2."""
    t = dt * np.arange(round(ground.seconds / dt) + 1)
    lines = [f"{time:.3f},{value:.5f}" for time, value in zip(t, accelerations(ground, t) + 0.0)]
    return "\n".join([f"{TABLE_MARK}artificial_record", "time [s],acceleration [m/s^2]", *lines, ""])


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--out", type=TableFile, required=True, metavar="FILE", help="the record (.csv)")
    parser.add_argument("--peak", type=float, default=Ground.peak, help="largest acceleration [m/s^2] (%(default)s)")
    parser.add_argument("--frequency", type=float, default=Ground.frequency, help="of the ground [Hz] (%(default)s)")


def run(args: argparse.Namespace) -> int:
    """Write the record; 0."""
    if not (0.0 < args.peak < np.inf and 0.0 < args.frequency < np.inf):
        raise UserError("peak and frequency are positive", "--peak, --frequency", "leave them out")
    write_whole(Path(args.out), record_text(Ground(peak=args.peak, frequency=args.frequency)))
    print(f"wrote {one_line(args.out)}")
    return 0
