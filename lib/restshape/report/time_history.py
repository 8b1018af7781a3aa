"""Each quantity over the simulated time, beside the edit time, with what was edited meanwhile."""

from pathlib import Path
from textwrap import shorten, wrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from restshape.arrays import Reals
from restshape.outputs.picture_files import save_picture
from restshape.outputs.si_numbers import scaled_unit, si
from restshape.replay.columns import SIMULATED, quantity_names
from restshape.replay.recording.recording import Recording
from restshape.report.frames import scene_name
from restshape.report.quantity_panels import cut_start, draw_limits, least_span, say_no_values
from restshape.report.recorded_quantities import limit_series, quantity_units
from restshape.report.stacked_panels import stack_panels
from restshape.report.style import INK, LEVELS, new_figure
from restshape.report.tables import column, refused

EACH, AROUND = 1.5, 1.6
"""Height of a panel, and of what is around them [inch]."""
EDITS, GAP, RIGHT = 0.45, 0.2, 0.2
"""Height of the axis of edit times, room between panels, and for half of its last number [inch]."""
MOST = 8
"""Quantities in a picture."""
LETTERS = 18
"""Of a name in one line beside its panel."""
TICKS = 7
"""Marks of the edit time at most."""
CLOSE = 0.04
"""Marks of the edit time are no closer, over the width of the axis."""
ROUNDING = 1e-9
"""Of times, over the last one."""
EDITED = "#fde8c8"


def draw_history(recording: Recording, path: Path) -> bool:
    """Writes the picture, in the format that the path's suffix names; False, and none, without simulated times.

    Quantities with limits come first; of more than `MOST` the others are left out, and counted in the title.
    """
    limits = limit_series(recording)
    names = sorted(quantity_names(recording.table), key=lambda name: name not in limits)
    times = column(recording, SIMULATED)
    if not names or not np.nanmax(times, initial=0.0) > 0.0:
        return False
    shown = names[:MOST]
    figure = new_figure(10.0, AROUND + EACH * len(shown))
    panels = figure.subplots(len(shown), 1, sharex=True, squeeze=False)[:, 0]
    units, stopped, edited = quantity_units(recording.header), refused(recording), edited_spans(recording)
    for axes, name in zip(panels, shown):
        values = np.where(stopped, np.nan, column(recording, f"q_{name}"))
        for begin, end in edited:
            axes.axvspan(begin, end, color=EDITED, linewidth=0, zorder=0)
        unit = _line(axes, times, values, units.get(name, ""), limits.get(name, {}))
        if not limits.get(name):
            cut_start(axes, values, units.get(name, ""))
        axes.set_ylabel("\n".join([*wrap(name, LETTERS)[:2], *([f"[{unit}]"] if unit else [])]))
    panels[-1].set_xlabel("simulated time [s]")
    panels[-1].set_xlim(np.nanmin(times), np.nanmax(times))
    _edit_times(panels[0], times, recording.times)
    left_out = f", {len(names) - MOST} more quantities are not shown" if len(names) > MOST else ""
    title = shorten(scene_name(recording), 60, placeholder=" …")
    words = f"{title}: {recording.summary}, a value every {value_step(times)}{left_out}"
    figure.suptitle(words, x=0.01, ha="left", color=INK)
    if edited:
        panels[0].fill_between([], [], [], color=EDITED, label="shape or values edited")
        figure.legend(*panels[0].get_legend_handles_labels(), loc="lower center")
    above = [EDITS, *[GAP] * (len(shown) - 1)]
    stack_panels(figure, panels, [1] * len(shown), above, int(bool(edited)), RIGHT)
    save_picture(figure, path)
    return True


def edited_spans(recording: Recording) -> list[tuple[float, float]]:
    """Spans of simulated time [s] in which the shape or a value was edited: from the frame before to the last one."""
    times, level = column(recording, SIMULATED), column(recording, "level")
    events = recording.table.get("event", np.full(recording.n, ""))
    changed = np.array([(k > 0 or event == "set") and i > 0 for i, (k, event) in enumerate(zip(level, events))])
    found = []
    for run in np.split(np.flatnonzero(changed), np.flatnonzero(np.diff(np.flatnonzero(changed)) > 1) + 1):
        if len(run):
            found.append((float(times[run[0] - 1]), float(times[run[-1]])))
    return found


def _line(axes: Axes, times: np.ndarray, values: np.ndarray, unit: str, limit: dict[str, Reals]) -> str:
    """Draws one quantity, with gaps where it has no value, and its limits; the unit in which it is shown."""
    known = values[np.isfinite(values)]
    factor, shown = scaled_unit(float(np.abs(known).max(initial=0.0)), unit)
    axes.plot(times, factor * values, color=LEVELS[1], lw=1.0, marker="." if len(times) < 40 else "", ms=3)
    axes.grid(True, color="#e6e6e6", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.margins(y=0.12)
    axes.ticklabel_format(axis="y", useOffset=False)
    if len(known):
        least_span(axes, factor * float(known.min()), factor * float(known.max()))
        draw_limits(axes, factor, float(known.min()), float(known.max()), limit, shown, times)
    else:
        say_no_values(axes)
    return shown


def value_step(times: np.ndarray) -> str:
    """Time between the values of frames (n,) [s], with its unit; the least and the largest where it changes."""
    steps = np.diff(times)
    least, most = (float(end(steps[steps > 0.0])) for end in (np.min, np.max))
    # Times are sums of steps, whose last digits are rounded.
    return si(most, "s") if most - least < ROUNDING * np.nanmax(times) else f"{si(least, 's')} to {si(most, 's')}"


def _edit_times(axes: Axes, times: np.ndarray, edits: np.ndarray) -> None:
    """An axis above with round edit times, each at the simulated time that the edit had then."""
    known = np.isfinite(times)
    times, edits, above = times[known], edits[known], axes.secondary_xaxis("top")
    round_ones = MaxNLocator(TICKS, steps=[1, 2, 5, 10]).tick_values(float(edits[0]), float(edits[-1]))
    round_ones = round_ones[(round_ones >= edits[0] - ROUNDING) & (round_ones <= edits[-1] + ROUNDING)]
    marked: list[tuple[float, str]] = []
    for edit, time in zip(round_ones, np.interp(round_ones, edits, times)):
        if not marked or time - marked[-1][0] >= CLOSE * (times[-1] - times[0]):
            marked.append((float(time), f"{edit:.6g}"))
    above.set_xticks([time for time, _ in marked], [text for _, text in marked])
    above.set_xlabel("edit time [s]")
