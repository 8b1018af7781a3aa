"""Level, time and iterations against the frame."""

from math import ceil
from pathlib import Path
from textwrap import shorten
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes

from restshape.outputs.picture_files import save_picture
from restshape.replay.constraints import FAILS, UNCERTAIN
from restshape.replay.recording.recording import Recording
from restshape.report.frame_axis import frame_axis
from restshape.report.frames import scene_name
from restshape.report.stacked_panels import stack_panels
from restshape.report.style import INK, LEVEL_LABELS, LEVEL_MARKS, LEVELS, REFUSED, RESTLESS, SOLVED, VALUES, new_figure
from restshape.report.tables import column, jumped, predicted, refused, solved_at_rest, untrusted, with_values

STATUS_MARKS = {UNCERTAIN: ("limit within the error", "d", RESTLESS), FAILS: ("limit violated", "x", REFUSED)}
"""By constraint status: its name in the legend, its mark, its colour."""
STOPPED = -2
"""Stands for the level of a frame that was refused."""
REFUSALS: dict[str, Any] = {"linestyle": "none", "marker": "P", "color": REFUSED, "markersize": 4.5}
HATCHES = "//"
"""Of bands over frames that are not to be trusted, though they have converged."""
LARGE_JUMP = 0.005
"""Jumps of a quantity where the mesh changes are marked from this share of its value on."""
COLUMNS, GAP = 4, 0.12
"""Of the legend; between panels [inch]."""
NARROW, WIDE = 5.0, 100.0
"""Below the first ratio of the times their axis is linear, from the second on decades alone have labels."""


def draw_timeline(recording: Recording, path: Path, iterations: bool = True) -> None:
    """Writes the picture as a PNG, with a panel of iterations where the solver iterates."""
    figure = new_figure(10.0, 5.2)
    shown = (1, 2, 1.4) if iterations else (1, 2)
    panels = figure.subplots(len(shown), 1, sharex=True, height_ratios=shown)
    levels, times = panels[:2]
    frames = np.arange(recording.n)
    level = np.nan_to_num(column(recording, "level")).astype(int)
    stopped, ahead = refused(recording), predicted(recording)
    restless = column(recording, "converged", 1.0) == 0
    doubtful = untrusted(recording) & ~restless & ~stopped
    ms, counts = column(recording, "ms"), column(recording, "iterations")
    level_and_rest = np.where(solved_at_rest(recording), SOLVED, level)
    kind = np.where(stopped, STOPPED, np.where(with_values(recording), VALUES, level_and_rest))
    for k in (k for k in LEVELS if k in kind):
        look = {"linestyle": "none", "marker": LEVEL_MARKS[k], "color": LEVELS[k], "markersize": 3.5}
        levels.plot([], [], label=LEVEL_LABELS[k], **look)
        # Hollow where nothing was solved.
        for chosen, fill in ((kind == k) & ~ahead, LEVELS[k]), ((kind == k) & ahead, "white"):
            for axes, values in zip(panels, (level, ms, counts)):
                axes.plot(frames[chosen], values[chosen], markerfacecolor=fill, **look)
    for axes, values in zip(panels, (level, ms, counts)):
        axes.plot(frames[stopped], values[stopped], **REFUSALS)
        axes.grid(True, axis="y", color="#e6e6e6", linewidth=0.6)
        axes.set_axisbelow(True)
        _mark(axes, frames[stopped], REFUSED)
        _mark(axes, frames[restless], RESTLESS)
        _mark(axes, frames[doubtful], RESTLESS, HATCHES)
    statuses = _mark_status(levels, recording)
    levels.set(ylabel="level", yticks=(0, 1, 2, 3), ylim=(-0.5, 3.5))
    _scale_times(times, ms)
    if len(panels) == 3:
        most = max(1.0, np.nanmax(counts, initial=1.0))
        panels[2].set(ylabel="iterations", ylim=(-0.06 * most, 1.15 * most))
        panels[2].yaxis.get_major_locator().set_params(integer=True)
    frame_axis(panels[-1], recording.n)
    name = shorten(scene_name(recording), 70, placeholder=" …")
    figure.suptitle(f"{name}: {recording.summary}", x=0.01, ha="left", color=INK)
    handles, names = levels.get_legend_handles_labels()
    if ahead.any():
        handles += levels.plot([], [], "o", color=INK, markerfacecolor="white", markersize=3.5)
        names.append(f"predicted, not solved ({ahead.sum()})")
    if stopped.any():
        handles += levels.plot([], [], **REFUSALS)
        names.append(f"refused ({stopped.sum()})")
    if restless.any():
        handles.append(levels.axvspan(np.nan, np.nan, color=RESTLESS, alpha=0.3))
        names.append(f"not converged ({restless.sum()})")
    if doubtful.any():
        handles.append(levels.axvspan(np.nan, np.nan, color=RESTLESS, alpha=0.3, hatch=HATCHES))
        names.append(f"not trusted ({doubtful.sum()})")
    handles, names = handles + list(statuses.values()), names + list(statuses)
    figure.legend(handles, names, loc="lower center", ncols=min(len(names), COLUMNS))
    stack_panels(figure, panels, shown, [0.0, *[GAP] * (len(panels) - 1)], ceil(len(names) / COLUMNS))
    save_picture(figure, path)


def _mark_status(axes: Axes, recording: Recording) -> dict[str, Artist]:
    """Marks frames whose limits fail, or hold by less than the error, and large jumps; names for the legend."""
    words, found = np.array(recording.table.get("constraint_status", ()), dtype=str), {}
    for status, (name, mark, colour) in STATUS_MARKS.items():
        frames = np.flatnonzero(words == status)
        if len(frames):
            look = {"linestyle": "none", "marker": mark, "color": colour, "markersize": 4}
            found[f"{name} ({len(frames)})"] = axes.plot(frames, np.full(len(frames), -0.32), **look)[0]
    if len(frames := jumped(recording, LARGE_JUMP)):
        look = {"linestyle": "none", "marker": "v", "color": INK, "markerfacecolor": "none", "markersize": 5}
        label = f"jump above {100 * LARGE_JUMP:g} % by the mesh ({len(frames)})"
        found[label] = axes.plot(frames, np.full(len(frames), 3.32), **look)[0]
    return found


def _mark(axes: Axes, frames: np.ndarray, colour: str, hatch: str | None = None) -> None:
    """Shades frames, neighbours as one band."""
    if len(frames):
        for run in np.split(frames, np.flatnonzero(np.diff(frames) > 1) + 1):
            axes.axvspan(run[0] - 0.5, run[-1] + 0.5, color=colour, alpha=0.18, linewidth=0, zorder=0, hatch=hatch)


def _scale_times(axes: Axes, ms: np.ndarray) -> None:
    axes.set_ylabel("time a frame [ms]")
    positive = ms[np.isfinite(ms) & (ms > 0)]
    if not len(positive):
        return
    span = positive.max() / positive.min()
    if span < NARROW:
        axes.set_ylim(0.0, 1.15 * positive.max())
        return
    axes.set_yscale("log")
    axes.set_ylim(positive.min() / 1.5, positive.max() * 1.5)
    axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    # More than two labels a decade would run into each other.
    axes.yaxis.set_minor_formatter(lambda value, _: f"{value:g}" if span < WIDE and f"{value:e}"[0] in "25" else "")
