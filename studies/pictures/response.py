"""The picture of a resonance: amplitude and eigenfrequency against the place of what is dragged."""

from pathlib import Path
from typing import Protocol

import numpy as np

from restshape.outputs.picture_files import save_picture
from restshape.outputs.si_numbers import scaled_unit
from restshape.report.style import FAINT, INK, LEVELS, REFUSED, new_figure


class Response(Protocol):
    """What is drawn: places (m,), path (n,), amplitudes, peaks and crossing [m], frequencies (m,) [Hz]."""

    excitation_frequency: float
    path: np.ndarray
    amplitude: np.ndarray
    places: np.ndarray
    harmonic: np.ndarray
    frequency: np.ndarray
    crossing: float
    moving_peak: float
    harmonic_peak: float


def draw_response(path: Path, found: Response, what: str = "window") -> None:
    """Draw amplitude above and lowest eigenfrequency below, both against how far down the dragged thing is.

    Args:
        path: picture file.
        found: places [m], amplitudes [m], frequencies [Hz].
        what: is dragged.
    """
    figure = new_figure(7.0, 5.4)
    top, bottom = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    factor, unit = scaled_unit(float(found.amplitude.max()), "m")
    top.plot(
        found.path, factor * found.amplitude, color=LEVELS[1], lw=1.6, label="motion during the drag, peak of a frame"
    )
    top.plot(
        found.places,
        factor * found.harmonic,
        "o",
        ms=4,
        mfc="none",
        mec=LEVELS[3],
        label="harmonic response of the same shape at rest",
    )
    top.set_ylabel(f"amplitude at the roof [{unit}]")
    top.set_ylim(0, 1.3 * factor * float(max(found.amplitude.max(), found.harmonic.max())))
    bottom.plot(found.places, found.frequency, ".-", color=INK, ms=4, lw=1, label="lowest eigenfrequency (SLEPc)")
    bottom.axhline(
        found.excitation_frequency,
        color=REFUSED,
        lw=1,
        ls="--",
        label=f"the ground's, {found.excitation_frequency:g} Hz",
    )
    bottom.set_ylabel("frequency [Hz]")
    bottom.set_xlabel(f"way of the {what} down [m]")
    # Only as high as the curves reach: text lies above.
    for axes, height in ((top, 0.77), (bottom, 0.65)):
        axes.axvline(found.crossing, ymax=height, color=FAINT, lw=1, zorder=0)
        axes.grid(alpha=0.25)
    top.text(
        0.99,
        0.98,
        f"frequencies meet at {found.crossing:.2f} m\n"
        f"motion peaks at {found.moving_peak:.2f} m\n"
        f"response peaks at {found.harmonic_peak:.2f} m",
        ha="right",
        va="top",
        transform=top.transAxes,
    )
    top.legend(loc="upper left")
    bottom.legend(loc="upper right")
    figure.suptitle(f"A {what} dragged through a resonance")
    save_picture(figure, path)
