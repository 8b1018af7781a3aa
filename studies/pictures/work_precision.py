"""Error against time of a study's points, with the Pareto front."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from restshape.outputs.picture_files import save_picture
from restshape.report.name_labels import Labels
from restshape.report.style import INK, new_figure

ORDERS = {1: "#0072b2", 2: "#d55e00"}
MARKS = {"rebuild": "s", "refactor": "^", "thesis": "D", "auto": "o"}
OTHER = "#117733", "P"
FAR = 10.0
"""How far below the least error the reference's uncertainty may lie to be shown."""

FIRST = np.array([-1.0, 0.0])
"""Where a name is tried first: no point is left of and below one of the front."""
MARK = 4.0
"""Half the width of a mark that names keep off [points]."""


def draw_work_precision(
    records: Sequence[Mapping[str, Any]], measure: str, uncertainty: float, name: str, path: Path
) -> None:
    """Writes the picture as a PNG: time of a frame over error, both logarithmic; a colour an order, a mark a policy.

    Args:
        records: points with error, frame_ms, order, policy, varied, pareto.
        measure: what the error is of, for people.
        uncertainty: of the reference, relative.
        name: of the scene.
        path: of the picture.
    """
    shown = [r for r in records if r["error"] and r["frame_ms"]]
    figure = new_figure(8.6, 5.6)
    axes = figure.subplots()
    axes.set(xscale="log", yscale="log")
    for record in shown:
        colour, mark = ORDERS.get(record["order"], OTHER[0]), MARKS.get(record["policy"], OTHER[1])
        # Points of the grid are full; what is varied alone is hollow.
        face = "none" if record["varied"] else colour
        axes.plot(
            100.0 * record["error"], record["frame_ms"], ls="", marker=mark, ms=6, mec=colour, mfc=face, alpha=0.85
        )
    front = sorted((r for r in shown if r["pareto"]), key=lambda r: r["frame_ms"])
    axes.plot([100.0 * r["error"] for r in front], [r["frame_ms"] for r in front], color=INK, lw=1.2, zorder=1)
    if shown:
        axes.margins(0.06)
        low, high = axes.get_xlim()
        band = 100.0 * uncertainty > low / FAR
        if band:
            low = min(low, 50.0 * uncertainty)
            axes.axvspan(low, min(100.0 * uncertainty, high), color="#eeeeee", zorder=0, lw=0)
            axes.set_xlim(low, high)
    axes.grid(True, which="major", color="#e6e6e6", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.set_xlabel(f"error of the {measure}, worst frame [%]")
    axes.set_ylabel("time of a frame, median [ms]")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(lambda value, _: f"{value:g}")
        _label_narrow(axis)
    figure.legend(handles=_legend(shown, uncertainty if shown and band else 0.0), loc="outside right upper")
    figure.suptitle(f"{name}: what accuracy costs, one core", x=0.01, ha="left", color=INK)
    _name_varied(axes, front, shown)
    save_picture(figure, path)


def _name_varied(axes: Axes, front: Sequence[Mapping[str, Any]], shown: Sequence[Mapping[str, Any]]) -> None:
    """Write beside points of the front what was varied alone, where there are no marks and no lines."""
    varied, figure = [record for record in front if record["varied"]], axes.figure
    if not varied:
        return
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    over = figure.add_axes(axes.get_position(), xlim=(0.0, 1.0), ylim=(0.0, 1.0))
    over.set_axis_off()

    def places(records: Sequence[Mapping[str, Any]]) -> np.ndarray:
        at = np.array([(100.0 * record["error"], record["frame_ms"]) for record in records])
        at = at.reshape(-1, 2)
        return axes.transAxes.inverted().transform(axes.transData.transform(at))

    labels = Labels(over)
    labels.keep_off([places(front)])
    # A name begins 2 points from the middle of its own mark.
    for of_names, wide in ((False, MARK), (True, 2.0)):
        marks = places([record for record in shown if (record in varied) is of_names])
        labels.keep_off((np.repeat(place[None], 2, axis=0) for place in marks), wide)
    for record, place in zip(varied, places(varied)):
        value = f"{record['given']:.3g}" if isinstance(record["given"], float) else record["given"]
        labels.add(place, f"{record['varied'].rpartition('.')[2]} = {value}", "#666666", 7.0, first=FIRST)


def _label_narrow(axis: Any) -> None:
    """Label the ticks between decades too where an axis spans less than two of them."""
    low, high = axis.get_view_interval()
    narrow = high / low < 100.0
    axis.set_minor_formatter(lambda value, _: f"{value:g}" if narrow and f"{value:e}"[0] in "25" else "")


def _legend(shown: Sequence[Mapping[str, Any]], uncertainty: float) -> list[Line2D]:
    """Handles of what the picture holds."""
    orders = sorted({record["order"] for record in shown})
    policies = [policy for policy in MARKS if any(record["policy"] == policy for record in shown)]
    handles = [Line2D([], [], color=ORDERS.get(order, OTHER[0]), lw=3, label=f"order {order}") for order in orders]
    handles += [Line2D([], [], ls="", marker=MARKS[policy], color="#666666", ms=6, label=policy) for policy in policies]
    if any(record["varied"] for record in shown):
        handles.append(Line2D([], [], ls="", marker="o", mec="#666666", mfc="none", ms=6, label="one key varied"))
    handles.append(Line2D([], [], color=INK, lw=1.2, label="front"))
    if uncertainty:
        label = f"below the reference's\nuncertainty, {100 * uncertainty:.2g} %"
        handles.append(Line2D([], [], color="#dddddd", lw=6, label=label))
    return handles
