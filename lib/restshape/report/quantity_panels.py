"""Each quantity over the edit, with its limits, what happened, and gaps where there is no value."""

# More than 15 modules: a panel shows a quantity with all that is known of it.

from collections.abc import Mapping, Sequence
from pathlib import Path
from textwrap import shorten
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from restshape.arrays import Reals
from restshape.outputs.picture_files import save_picture
from restshape.outputs.si_numbers import prefix, scaled_unit
from restshape.replay.columns import SIMULATED, distance_column, error_column, jump_column, quantity_names
from restshape.replay.recording.recording import Recording, ranges
from restshape.replay.rounding import without_rounding
from restshape.replay.singular_notes import marked
from restshape.report.frame_axis import frame_axis
from restshape.report.frames import scene_name
from restshape.report.legends import legend_below
from restshape.report.recorded_quantities import limit_series, quantity_units
from restshape.report.stacked_panels import stack_panels
from restshape.report.style import GOAL, INK, LEVEL_LABELS, LEVEL_MARKS, LEVELS, REFUSED, new_figure
from restshape.report.tables import at_singular_places, column, quantity_scales, refused, singular
from restshape.scene.quantity import limit_digits

EACH, FRAMED = 1.35, 1.3
"""Height of a panel, and of what is around them [inch]."""
NAMED = 0.24
"""Height of the name above a panel [inch]."""
LEAST_SPAN = 1e-4
"""Least span of an axis, over the size of its values."""
BAND, DISTANCE = "#c6dbef", "#fbd9a5"
PREDICTED = "predicted"
LIMIT, BEYOND = "limit", "beyond its limit"
"""Names in the legend."""
ALONE = 3.5
"""Size of the mark of a value without a line to it [points]."""
POWERS = 1e5
"""From this size on pure numbers have their power of ten beside each: above the axis it would cover the name."""
MOST = 12
"""Quantities in a picture."""
FRAMES_LETTERS = 32
"""Of the frames above a panel in which its quantity is taken at a singular place."""
SHORT, ROUND = 5, 4
"""Digits of a limit at most that is shown as it was written, and of all others."""
Colour = str | tuple[float, ...]
HOLLOW: dict[str, Any] = {"ls": "", "marker": "o", "mfc": "white", "mec": INK, "mew": 0.8, "ms": 3.2, "zorder": 2.5}
"""How the mark of a predicted value looks."""
STARTING, STARTS_BEYOND = 5, 1.0
"""First frames that are cut off where they are beyond the others by more than so many of their spans."""
SHOWN_BEYOND = 1.5
"""A limit is in the picture where it is within so many spans of the values; else it is named at its edge."""


def draw_quantities(recording: Recording, path: Path) -> bool:
    """Writes the picture, in the format that the path's suffix names; False, and no picture, without quantities.

    Quantities with limits come first; of more than `MOST` the others are left out, and counted in the title.
    """
    limits = limit_series(recording)
    names = sorted(quantity_names(recording.table), key=lambda name: name not in limits)
    if not names:
        return False
    shown = names[:MOST]
    figure = new_figure(10.0, FRAMED + EACH * len(shown))
    panels = figure.subplots(len(shown), 1, sharex=True, squeeze=False)[:, 0]
    units, stopped, sizes = quantity_units(recording.header), refused(recording), quantity_scales(recording)
    known, seen = singular(recording), set[str]()
    predicted = column(recording, "predicted", 0.0) == 1.0
    for axes, name in zip(panels, shown):
        values, jumps, errors = (
            without_rounding(column(recording, one), sizes[name])
            for one in (f"q_{name}", jump_column(name), error_column(name))
        )
        values = np.where(stopped, np.nan, values)
        seen |= _panel(axes, recording, values, limits.get(name, {}), units.get(name, ""))
        _jumps(axes, values, jumps, units.get(name, ""))
        _band(axes, values, errors, units.get(name, ""))
        away = column(recording, distance_column(name))
        _band(axes, values, np.where(predicted, away, np.nan), units.get(name, ""), DISTANCE)
        _hollow(axes, values, predicted, units.get(name, ""))
        if SIMULATED in recording.table and not limits.get(name):
            cut_start(axes, values, units.get(name, ""))
        axes.set_title(_title(recording, name, known), loc="left", pad=2)
        _shade(axes, np.flatnonzero(stopped))
    frame_axis(panels[-1], recording.n)
    left_out = f", {len(names) - MOST} more quantities are not shown" if len(names) > MOST else ""
    title = shorten(scene_name(recording), 70, placeholder=" …")
    figure.suptitle(f"{title}: {recording.summary}{left_out}", x=0.01, ha="left", color=INK)
    legend = _legend(panels[0], recording, seen, stopped)
    stack_panels(figure, panels, [1] * len(shown), [NAMED] * len(shown), legend)
    save_picture(figure, path)
    return True


def _title(recording: Recording, name: str, known: Mapping[str, float]) -> str:
    """The name of a quantity, and in which frames it is taken at a singular place where not in all."""
    there, valued = at_singular_places(recording, name), np.isfinite(column(recording, f"q_{name}"))
    frames = np.flatnonzero(there).tolist() if (valued & ~there).any() else []
    return marked(name, known, shorten(ranges(frames), FRAMES_LETTERS, placeholder=" …"))


def _panel(axes: Axes, recording: Recording, values: np.ndarray, limit: dict[str, Reals], unit: str) -> set[str]:
    """One quantity: a line with gaps, marks at reconnections and reconstructions, crosses beyond a limit.

    Returns which of `LIMIT` and `BEYOND` it shows.
    """
    frames, level = np.arange(recording.n), column(recording, "level")
    ms = 2.5 if recording.n > 1 else 8.0
    known = values[np.isfinite(values)]
    factor, shown = scaled_unit(float(np.abs(known).max(initial=0.0)), unit)
    axes.plot(frames, factor * values, color=INK, lw=1.0, marker=".", ms=ms, zorder=2)
    alone = _alone(values)
    axes.plot(frames[alone], factor * values[alone], ls="", color=INK, marker="o", ms=ALONE, zorder=2)
    for k in (2, 3):
        here = (level == k) & np.isfinite(values)
        axes.plot(frames[here], factor * values[here], ls="", marker=LEVEL_MARKS[k], color=LEVELS[k], ms=4.5, zorder=3)
    beyond = (values > limit.get("max", np.inf)) | (values < limit.get("min", -np.inf))
    axes.plot(frames[beyond], factor * values[beyond], ls="", marker="x", color=REFUSED, ms=4.5, zorder=4)
    axes.set_ylabel(f"[{shown}]" if shown else "")
    axes.grid(True, axis="y", color="#e6e6e6", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.margins(y=0.12)
    if not unit and factor * float(np.abs(known).max(initial=0.0)) >= POWERS:
        axes.yaxis.set_major_formatter("{x:g}")
    else:
        axes.ticklabel_format(axis="y", useOffset=False)
    seen = {BEYOND} if beyond.any() else set()
    if len(known):
        least_span(axes, factor * float(known.min()), factor * float(known.max()))
        if draw_limits(axes, factor, float(known.min()), float(known.max()), limit, shown, frames):
            seen.add(LIMIT)
    else:
        say_no_values(axes)
    return seen


def say_no_values(axes: Axes) -> None:
    """Says in a panel that its quantity has no value in any frame."""
    axes.text(0.5, 0.5, "no values", transform=axes.transAxes, ha="center", va="center", color=REFUSED)


def cut_start(axes: Axes, values: np.ndarray, unit: str) -> None:
    """Cuts the first frames off where they are far beyond all others, and says how far.

    A start from rest, as of a wind that blows at once, would leave a line of the swings after it. Others that are the
    same but for rounding have no swings.
    """
    first, later = (one[np.isfinite(one)] for one in (values[:STARTING], values[STARTING:]))
    if len(later) < STARTING or not len(first):
        return
    low, high = float(later.min()), float(later.max())
    room = STARTS_BEYOND * (high - low)
    rounding = high - low <= LEAST_SPAN * max(abs(low), abs(high))
    if rounding or (first.min() >= low - room and first.max() <= high + room):
        return
    factor, shown = scaled_unit(float(np.abs(values[np.isfinite(values)]).max()), unit)
    near = first[(first >= low - room) & (first <= high + room)]
    low, high = min([low, *near]), max([high, *near])
    beside = 0.12 * (high - low)
    axes.set_ylim(factor * (low - beside), factor * (high + beside))
    ends = f"{factor * first.min():.3g} to {factor * first.max():.3g} {shown}".rstrip()
    words = f"cut off: the first {STARTING} frames go from {ends}"
    axes.text(0.995, 0.97, words, transform=axes.transAxes, ha="right", va="top", fontsize=7, color=INK)


def _alone(values: np.ndarray) -> np.ndarray:
    """Whether each value (n,) has none beside it, so that no line goes to it; of several frames."""
    known = np.concatenate([[False], np.isfinite(values), [False]])
    return known[1:-1] & ~known[:-2] & ~known[2:] & (len(values) > 1)


def _hollow(axes: Axes, values: np.ndarray, predicted: np.ndarray, unit: str) -> None:
    """Marks the frames (n,) whose values are predicted."""
    here = np.flatnonzero(predicted & np.isfinite(values))
    if len(here):
        factor, _ = scaled_unit(float(np.abs(values[np.isfinite(values)]).max()), unit)
        axes.plot(here, factor * values[here], **HOLLOW)


def _band(axes: Axes, values: np.ndarray, errors: np.ndarray, unit: str, colour: str = BAND) -> None:
    """Shades what lies within the estimated error, or distance, of a quantity, where it has one."""
    known = np.isfinite(values) & np.isfinite(errors)
    if not known.any():
        return
    factor, _ = scaled_unit(float(np.abs(values[np.isfinite(values)]).max()), unit)
    low, high = (np.where(known, factor * (values + sign * errors), np.nan) for sign in (-1.0, 1.0))
    limits = axes.get_ylim()
    ends = np.repeat(np.arange(len(values), dtype=float), 2) + np.tile([-0.5, 0.5], len(values))
    axes.fill_between(ends, np.repeat(low, 2), np.repeat(high, 2), color=colour, linewidth=0, zorder=0.5)
    # An error many times the value is cut off.
    span = limits[1] - limits[0]
    reach = max(limits[0] - span, float(np.nanmin(low))), min(limits[1] + span, float(np.nanmax(high)))
    axes.set_ylim(min(limits[0], reach[0]), max(limits[1], reach[1]))


def _jumps(axes: Axes, values: np.ndarray, jumps: np.ndarray, unit: str) -> None:
    """Bars from where a quantity would be on the mesh before flips or a new mesh, to where it is."""
    here = np.flatnonzero(np.isfinite(jumps) & np.isfinite(values))
    if len(here):
        factor, _ = scaled_unit(float(np.abs(values[np.isfinite(values)]).max()), unit)
        axes.vlines(here, factor * (values - jumps)[here], factor * values[here], color=GOAL, lw=1.6, zorder=2)


def least_span(axes: Axes, low: float, high: float) -> None:
    """Widens the axis of values from low to high where these are the same but for rounding."""
    least = LEAST_SPAN * max(abs(low), abs(high))
    if 0.0 < high - low < least:
        middle = 0.5 * (low + high)
        axes.set_ylim(middle - 0.5 * least, middle + 0.5 * least)


def draw_limits(
    axes: Axes,
    factor: float,
    low: float,
    high: float,
    limit: Mapping[str, Reals | float],
    unit: str,
    x: Reals | None = None,
    colours: Sequence[Colour] = (),
) -> bool:
    """Lines at limits near the values; those that are far are written above the panel.

    Args:
        axes: of the panel.
        factor: from the SI unit to the one that is shown.
        low, high: the smallest and the largest value, in the SI unit.
        limit: by `min` and `max`, in the SI unit; where it moves (n,) of frames, or (k, n) of k lines, not numbers
            where a line has none.
        unit: that is shown; a limit beyond the axis has the prefix that suits it.
        x: (n,) where frames are on the axis; None where no limit moves.
        colours: of the k lines, which their limits have too; empty: limits have one colour.

    Returns whether there is a line.
    """
    span = max(high - low, 1e-3 * max(abs(low), abs(high)))
    words, drawn = [], False
    for key, one in limit.items():
        rows = np.atleast_2d(np.asarray(one, dtype=float))
        bounds = rows[np.isfinite(rows)]
        if not len(bounds):
            continue
        least, most = float(bounds.min()), float(bounds.max())
        shown = least <= high + SHOWN_BEYOND * span and most >= low - SHOWN_BEYOND * span
        if shown and (x is None or least == most):
            axes.axhline(factor * least, color=REFUSED, lw=1.0, ls="--", zorder=1)
        elif shown:
            own = colours if len(colours) == len(rows) else [REFUSED] * len(rows)
            for row, colour in zip(rows, own):
                axes.plot(x, factor * row, color=colour, lw=1.0, ls="--", zorder=1, drawstyle="steps-mid")
        ends = (least, most) if bounds[0] <= bounds[-1] else (most, least)
        number = _limit_number(ends, factor, unit) if shown else _far_limit(ends, factor, unit)
        drawn = drawn or shown
        words.append(f"{key} {number}{'' if shown else ', beyond the axis'}")
    axes.set_title("; ".join(words), loc="right", pad=2, color=REFUSED, fontsize=8)
    return drawn


def _limit_number(ends: tuple[float, float], factor: float, unit: str) -> str:
    """A limit, or the first and the last one of those that move, with the unit that this factor leads to."""
    # What has no short number, such as a third, comes from a formula.
    digits = [found if (found := limit_digits(end)) <= SHORT else ROUND for end in ends]
    numbers = [f"{factor * end:.{count}g}" for end, count in zip(ends, digits)]
    return f"{' to '.join(dict.fromkeys(numbers))} {unit}".rstrip()


def _far_limit(ends: tuple[float, float], factor: float, unit: str) -> str:
    """The same in a unit of its own, such as 40 mm beside an axis of micrometres."""
    letter = prefix(1.0 / factor)[1] if factor != 1.0 else ""
    own, name = scaled_unit(max(map(abs, ends)), unit.removeprefix(letter))
    return _limit_number(ends, own, name)


def _shade(axes: Axes, frames: np.ndarray) -> None:
    """Shades refused frames, neighbours as one band."""
    for run in np.split(frames, np.flatnonzero(np.diff(frames) > 1) + 1) if len(frames) else ():
        axes.axvspan(run[0] - 0.5, run[-1] + 0.5, color=REFUSED, alpha=0.18, linewidth=0, zorder=0)


def _legend(axes: Axes, recording: Recording, seen: set[str], stopped: np.ndarray) -> int:
    """The legend below all panels, of what occurs; its lines."""
    level = column(recording, "level")
    names = quantity_names(recording.table)
    if any(np.isfinite(column(recording, error_column(name))).any() for name in names):
        axes.fill_between([], [], [], color=BAND, label="estimated error")
    if any(np.isfinite(column(recording, distance_column(name))).any() for name in names):
        axes.fill_between([], [], [], color=DISTANCE, label="estimated distance from the solved value")
    if (column(recording, "predicted", 0.0) == 1.0).any():
        axes.plot([], [], label=PREDICTED, **HOLLOW)
    for k in (k for k in (2, 3) if (level == k).any()):
        axes.plot([], [], ls="", marker=LEVEL_MARKS[k], color=LEVELS[k], ms=4.5, label=LEVEL_LABELS[k])
    if LIMIT in seen:
        axes.plot([], [], color=REFUSED, lw=1.0, ls="--", label=LIMIT)
    if BEYOND in seen:
        axes.plot([], [], ls="", marker="x", color=REFUSED, ms=4.5, label=BEYOND)
    if any(np.isfinite(column(recording, jump_column(name))).any() for name in names):
        axes.plot([], [], color=GOAL, lw=1.6, label="jump by the mesh")
    if stopped.any():
        axes.axvspan(np.nan, np.nan, color=REFUSED, alpha=0.3, label=f"refused ({stopped.sum()}), no value")
    handles, names = axes.get_legend_handles_labels()
    if names:
        return legend_below(axes.figure, handles, names)
    return 0
