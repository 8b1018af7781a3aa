"""Time a frame of each level against the number of unknowns."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator

from restshape.outputs.picture_files import save_picture
from restshape.report.style import FAINT, INK, LEVEL_LABELS, LEVEL_MARKS, LEVELS, new_figure

INCLUDED = "whole frames with their residual, without estimates and recording"


def draw_scaling(records: Sequence[Mapping[str, Any]], fits: Mapping[str, Any], policy: str, path: Path) -> None:
    """Writes the picture as a PNG: medians, log-log, with the fitted powers, and the memory below.

    Args:
        records: a size each, as `bench size --json` writes them.
        fits: level -> exponent, coefficient_ms and points, or None.
        policy: of reuse.
        path: of the picture.
    """
    figure = new_figure(8.0, 7.0)
    times, memory = figure.subplots(2, 1, sharex=True, height_ratios=(3, 1))
    for level in ("3", "2", "1"):
        _level(times, records, level, fits.get(level))
    times.set_ylabel("time a frame, p50 [ms]")
    used = [(r["unknowns"], r["memory_mb"]) for r in records if r["unknowns"]]
    if used:
        memory.loglog(*zip(*used), color=INK, marker="o", markersize=4)
    memory.set(ylabel="peak memory [MB]", xlabel="unknowns")
    for axes in (times, memory):
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.grid(True, color="#e6e6e6", linewidth=0.6)
        axes.yaxis.set_major_formatter(lambda value, _: f"{value:,.10g}")
        axes.yaxis.set_minor_formatter(lambda value, _: "")
    memory.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    _note_missing(times, records)
    if times.get_legend_handles_labels()[0]:
        times.legend(loc="upper left")
    figure.suptitle(
        f"A frame of each level at growing size, one core, policy {policy}\n{INCLUDED}", x=0.01, ha="left", color=INK
    )
    figure.align_ylabels()
    save_picture(figure, path)


def _level(axes: Axes, records: Sequence[Mapping[str, Any]], level: str, fit: Mapping[str, Any] | None) -> None:
    """Points of one level, hollow where the first frame stands in, and the line of its fit."""
    shown = [record for record in records if record["levels"][level]]
    if not shown:
        return
    n = np.array([record["unknowns"] for record in shown], dtype=float)
    ms = np.array([record["levels"][level]["ms"]["p50"] for record in shown])
    first = np.array([level == "3" and record["first_frame_serves_as_level_3"] for record in shown])
    k = int(level)
    power = f": time ~ unknowns^{fit['exponent']:.2f}" if fit else ""
    look = {"color": LEVELS[k], "marker": LEVEL_MARKS[k], "linestyle": "none", "markersize": 6}
    axes.plot(n[~first], ms[~first], label=LEVEL_LABELS[k] + power, **look)
    if first.any():
        axes.plot(n[first], ms[first], markerfacecolor="white", label="level 3, the first frame of the replay", **look)
    if fit:
        ends = np.array([n[-fit["points"]], n[-1]])
        axes.plot(ends, fit["coefficient_ms"] * ends ** fit["exponent"], color=LEVELS[k], linewidth=1.2)


def _note_missing(axes: Axes, records: Sequence[Mapping[str, Any]]) -> None:
    """Names the sizes that gave less than was asked for."""
    lines = [f"about {record['wanted']:,.0f} unknowns: {record['problem']}" for record in records if record["problem"]]
    if lines:
        axes.text(0.98, 0.03, "\n".join(lines), transform=axes.transAxes, ha="right", color=FAINT, fontsize=8)
