"""Pictures of response spectra, of harmonic sweeps, and of the participation of modes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from restshape_apps.vibration.harmonic_sweep import Sweep

from restshape.analysis.modal.base_modes import BaseModes
from restshape.analysis.motion.response_spectrum import ResponseSpectrum
from restshape.outputs.picture_files import save_picture
from restshape.outputs.si_numbers import scaled_unit
from restshape.physics.elasticity.ground_record import GroundRecord
from restshape.report.fitted_title import fitted
from restshape.report.style import INK, LEVELS, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST = 8
"""Lines that a legend names."""
COLOURS = (LEVELS[1], LEVELS[2], LEVELS[3], LEVELS[-1], INK)


def draw_spectra(path: Path, record: GroundRecord, found: Sequence[ResponseSpectrum], name: str) -> None:
    """Draws the record above, and below its pseudo-acceleration and displacement over the period, a line a damping."""
    figure = new_figure(8.0, 6.0)
    grid = figure.add_gridspec(2, 2, height_ratios=(2, 3))
    above, left, right = (figure.add_subplot(place) for place in (grid[0, :], grid[1, 0], grid[1, 1]))
    above.plot(record.times, record.accelerations, color=INK, lw=0.7)
    above.set(xlabel="time [s]", ylabel="ground [m/s²]", xlim=(record.times[0], record.times[-1]))
    for k, one in enumerate(found):
        look = {"color": COLOURS[k % len(COLOURS)], "lw": 1.4, "label": f"damping {100 * one.damping[0]:.3g} %"}
        left.plot(one.periods, one.pseudo_acceleration, **look)
        right.plot(one.periods, 1e3 * one.displacement, **look)
    left.set_ylabel("pseudo-acceleration [m/s²]")
    right.set_ylabel("displacement [mm]")
    for axes in (left, right):
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
        axes.set(xlabel="period [s]", xlim=(found[0].periods.min(), found[0].periods.max()))
        axes.set_ylim(bottom=0.0)
        axes.grid(alpha=0.25)
    left.legend(loc="upper right")
    figure.suptitle(fitted(name, figure.get_figwidth(), ": response spectrum"), x=0.01, ha="left")
    save_picture(figure, path)


def draw_sweep(path: Path, found: Sweep, name: str) -> None:
    """Draws amplitude and phase of each quantity over the frequency."""
    figure = new_figure(8.0, 5.2)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    factor, unit = scaled_unit(max(float(np.abs(values).max()) for values in found.relative.values()), "m")
    for k, (quantity, values) in enumerate(found.relative.items()):
        look = {"color": COLOURS[k % len(COLOURS)], "lw": 1.4, "ls": ("-", "--", ":")[k % 3]}
        above.plot(found.frequencies, factor * np.abs(values), label=quantity, **look)
        phase = np.angle(values, deg=True)
        # A line between -180 and 180 degrees would be none of the motion.
        phase[np.append(np.abs(np.diff(phase)) > 180.0, False)] = np.nan
        below.plot(found.frequencies, phase, **look)
    above.set_ylabel(f"amplitude [{unit}]")
    above.set_ylim(bottom=0.0)
    handles, names = above.get_legend_handles_labels()
    more = f"{len(names) - MOST} more quantities are not named"
    above.legend(handles[:MOST], names[:MOST], loc="upper right", title=more if len(names) > MOST else None)
    below.set(ylabel="phase [°]", xlabel="frequency [Hz]", ylim=(-190, 190), yticks=(-180, -90, 0, 90, 180))
    below.set_xlim(found.frequencies[0], found.frequencies[-1])
    for axes in (above, below):
        axes.grid(alpha=0.25)
    what = f": steady motion relative to the ground, which accelerates by {found.acceleration:g} m/s²"
    figure.suptitle(fitted(name, figure.get_figwidth(), what), x=0.01, ha="left")
    save_picture(figure, path)


def draw_participation(
    path: Path, modes: BaseModes, damping: np.ndarray, peaks: Mapping[str, Mapping[str, float]], name: str
) -> None:
    """Draws the share of the mass and the damping of each mode over its frequency, and the peaks of quantities.

    Args:
        path: of the picture.
        modes: k of them; damping: (k,) shares of critical damping.
        peaks: largest displacements [m] of each quantity by how they are found: `srss`, `cqc`, `in_time`; may be empty.
        name: of the scene, for the title.
    """
    figure = new_figure(8.0, 5.2)
    grid = figure.add_gridspec(2, 2 if peaks else 1, height_ratios=(3, 2))
    above, below = figure.add_subplot(grid[0, 0]), figure.add_subplot(grid[1, 0])
    shares, f = 100.0 * modes.effective_mass, modes.frequencies
    above.vlines(f, 0.0, shares, color=COLOURS[0], lw=3.0, label="mode")
    above.plot(f, np.cumsum(shares), color=INK, lw=1.2, marker="o", ms=3.5, label="modes so far")
    above.set(ylabel="effective mass [%]", ylim=(0.0, 105.0))
    above.legend(loc="center right")
    below.plot(f, 100.0 * damping, color=COLOURS[1], lw=0.0, marker="o", ms=5.0)
    below.set(ylabel="damping [%]", xlabel="frequency [Hz]")
    below.set_ylim(0.0, max(1.2 * 100.0 * float(damping.max()), 1e-3))
    for axes in (above, below):
        axes.set_xlim(0.0, 1.05 * f[-1])
        axes.grid(alpha=0.25)
    if peaks:
        _draw_peaks(figure.add_subplot(grid[:, 1]), peaks)
    what = f": modes on moving ground, of a mass of {modes.mass:.6g} kg"
    figure.suptitle(fitted(name, figure.get_figwidth(), what), x=0.01, ha="left")
    save_picture(figure, path)


def _draw_peaks(axes: Axes, peaks: Mapping[str, Mapping[str, float]]) -> None:
    """Draws the largest displacements of the first quantities, a bar for each way to find them."""
    shown = list(peaks)[:MOST]
    factor, unit = scaled_unit(max(value for one in peaks.values() for value in one.values()), "m")
    for k, (way, label) in enumerate((("srss", "SRSS"), ("cqc", "CQC"), ("in_time", "in time"))):
        places = np.arange(len(shown)) + 0.27 * (k - 1)
        axes.barh(places, [factor * peaks[name][way] for name in shown], 0.24, color=COLOURS[k], label=label)
    axes.set_yticks(range(len(shown)), shown)
    axes.set_ylim(len(shown) - 0.4, -0.6)
    axes.set_xlabel(f"largest displacement under the record [{unit}]")
    more = f"{len(peaks) - MOST} more quantities are not shown"
    above = {"loc": "lower center", "bbox_to_anchor": (0.5, 1.0), "ncols": 3}
    axes.legend(**above, title=more if len(peaks) > MOST else None)
    axes.grid(alpha=0.25, axis="x")
