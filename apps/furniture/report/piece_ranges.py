"""What guidance reported over the frames of a recording: utilisation, stability margin, parameter under the hand."""

from __future__ import annotations

from itertools import groupby
from pathlib import Path
from textwrap import fill, shorten
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from restshape_apps.furniture.guidance.amounts import UNITS
from restshape_apps.furniture.report.guided import doubt_causes, doubtful, found, grabbed, only_limits
from restshape_apps.furniture.report.status_colour import BEYOND, DOUBT, status_colour

from restshape.outputs.picture_files import save_picture
from restshape.replay.recording.recording import Recording
from restshape.report.frame_axis import frame_axis
from restshape.report.frames import scene_name
from restshape.report.style import FAINT, INK, REFUSED, new_figure
from restshape.report.tables import column, rows_of

WIDE = 44
"""Letters of a line of the legend."""
BAND, DOUBTED, LIMIT = "#9ecae1", "#f2cf8d", "#666666"
ROOM = 0.25
"""How far beyond its own way a parameter's range is shown, in parts of that way."""


def draw_guidance(recording: Recording, path: Path) -> None:
    """Writes the picture as a PNG: a panel each for utilisation, stability margin, parameters in mm and in degrees."""
    rows = rows_of(recording)
    holds = _holds(rows)
    units = [unit for unit in UNITS if any(_unit(grabbed_rows) == unit for grabbed_rows in holds)]
    heights = [1.0, 1.0, *[1.5] * len(units)]
    figure = new_figure(10.0, 1.0 + 1.55 * sum(heights))
    panels = figure.subplots(len(heights), 1, sharex=True, height_ratios=heights)
    _draw_numbers(panels[0], recording, "utilisation", "utilisation [1]", 1.0)
    _draw_numbers(panels[1], recording, "stability_margin", "stability margin [1]", 0.0)
    for axes, unit in zip(panels[2:], units):
        _draw_parameters(axes, [grabbed_rows for grabbed_rows in holds if _unit(grabbed_rows) == unit], unit)
    for axes in panels:
        axes.grid(True, axis="y", color="#e6e6e6", linewidth=0.6)
        axes.set_axisbelow(True)
    _mark_searches(panels, rows)
    frame_axis(panels[-1], recording.n)
    name = shorten(scene_name(recording), 70, placeholder=" …")
    figure.suptitle(f"{name}: what holds, and how far edits may go", x=0.01, ha="left", color=INK)
    limits = any(only_limits(row) for row in rows)
    _legend(figure, bool(units), any(row["suggestions"] for row in rows), limits, _doubts(rows))
    figure.align_ylabels()
    save_picture(figure, path)


def _holds(rows: list[dict[str, Any]]) -> list[list[dict[str, Any]]]:
    """Frames in a row with one parameter under the hand, or one plank, whichever way it goes."""
    spans = groupby(rows, key=lambda row: (_subject(row), row["event"] == "slide"))
    return [list(span) for (name, _), span in spans if name]


def _subject(row: dict[str, Any]) -> str:
    """What is under the hand, without the direction that a plank is moved along; empty where nothing is."""
    hand = grabbed(row)
    return hand.subject if hand else ""


def _unit(grabbed_rows: list[dict[str, Any]]) -> str:
    """The unit of what is under the hand in these frames."""
    return grabbed(grabbed_rows[0]).unit


def _bands(row: dict[str, Any]) -> np.ndarray:
    """The valid ranges (k, 2) of a frame."""
    return np.array([(one.low, one.high) for one in grabbed(row).ranges or ()]).reshape(-1, 2)


def _doubtful_bands(row: dict[str, Any]) -> np.ndarray:
    """The parts (k, 2) of the valid ranges of a frame that are doubtful."""
    return np.array(grabbed(row).doubtful).reshape(-1, 2)


def _label(grabbed_rows: list[dict[str, Any]]) -> str:
    """What is under the hand in all these frames."""
    names = {row["parameter"] for row in grabbed_rows}
    return shorten(names.pop() if len(names) == 1 else _subject(grabbed_rows[0]), 48, placeholder=" …")


def _draw_dots(axes: Axes, frames: np.ndarray, values: np.ndarray, rows: list[dict[str, Any]], size: float) -> None:
    """A dot a frame, which reports by its colour whether the piece holds; diamonds where quantities alone do not."""
    limits = np.array([only_limits(row) for row in rows])
    colours = np.array([status_colour(row) for row in rows])
    for mark, chosen, part in (("o", ~limits, 1.0), ("D", limits, 1.3)):
        axes.scatter(
            frames[chosen], values[chosen], c=colours[chosen], marker=mark, s=part * size, zorder=3, linewidths=0
        )


def _draw_numbers(axes: Axes, recording: Recording, name: str, label: str, limit: float) -> None:
    """A number a frame, with the limit on the one side of which the piece does not hold."""
    values, frames = column(recording, name), np.arange(recording.n)
    rows = rows_of(recording)
    axes.plot(frames, values, color=FAINT, linewidth=0.8, zorder=1)
    _draw_dots(axes, frames, values, rows, 12.0)
    axes.axhline(limit, color=LIMIT, linewidth=1.0, linestyle="--", zorder=2)
    shown = np.append(values[np.isfinite(values)], limit)
    room = 0.1 * max(float(np.ptp(shown)), 1e-12)
    axes.set(ylabel=label, ylim=(shown.min() - room, shown.max() + room))


def _draw_parameters(axes: Axes, holds: list[list[dict[str, Any]]], unit: str) -> None:
    """What was under the hand in one unit, with its ranges; those go on to where they end or the picture does."""
    factor, shown = UNITS[unit]
    at = factor * np.array([row["at"] for grabbed_rows in holds for row in grabbed_rows], dtype=float)
    least, most = min(0.0, float(np.nanmin(at))), max(0.0, float(np.nanmax(at)))
    room = ROOM * max(most - least, 1e-9)
    bottom, top = least - room, most + room
    for grabbed_rows in holds:
        frames = np.array([row["index"] for row in grabbed_rows])
        way = factor * np.array([row["at"] for row in grabbed_rows], dtype=float)
        for row in grabbed_rows:
            for bands, colour in ((_bands(row), BAND), (_doubtful_bands(row), DOUBTED)):
                for low, high in factor * bands:
                    axes.fill_between(row["index"] + np.array([-0.5, 0.5]), low, high, color=colour, lw=0, zorder=1)
        axes.plot(frames, way, color=FAINT, linewidth=0.8, zorder=2)
        _draw_dots(axes, frames, way, grabbed_rows, 14.0)
        axes.annotate(
            _label(grabbed_rows),
            (frames[0], top),
            xytext=(0, -2),
            textcoords="offset points",
            va="top",
            fontsize=7.5,
            bbox={"facecolor": "white", "alpha": 0.75, "edgecolor": "none", "pad": 0.8},
            zorder=4,
        )
    axes.axhline(0.0, color=FAINT, linewidth=0.6, zorder=2)
    axes.set(ylabel=f"from where it was\ntaken [{'°' if shown == 'deg' else shown}]", ylim=(bottom, top))


def _mark_searches(panels: list[Axes], rows: list[dict[str, Any]]) -> None:
    """A line where suggestions were found, with how many."""
    for row in rows:
        if row["suggestions"]:
            for axes in panels:
                axes.axvline(row["index"], color="#d55e00", linewidth=0.9, linestyle=":", zorder=2)
            panels[0].annotate(
                str(len(found(row))),
                (row["index"], 1.0),
                xycoords=("data", "axes fraction"),
                xytext=(3, 2),
                textcoords="offset points",
                fontsize=7.5,
                color="#d55e00",
            )


def _doubts(rows: list[dict[str, Any]]) -> tuple[str, bool]:
    """Why pieces hold in doubt, if any does, and whether a part of a valid range is doubtful."""
    return doubt_causes(filter(doubtful, rows)), any(bool(hand.doubtful) for row in rows if (hand := grabbed(row)))


def _legend(figure: Figure, ranges: bool, suggested: bool, limits: bool, doubts: tuple[str, bool]) -> None:
    dot = {"linestyle": "none", "marker": "o", "markersize": 4}
    marks = [
        Line2D([], [], color=INK, label="the piece holds", **dot),
        Line2D([], [], color=REFUSED, label="it does not", **dot),
    ]
    if limits:
        words = "it holds, but a quantity is beyond its limit"
        marks.append(Line2D([], [], color=BEYOND, label=words, **dot | {"marker": "D"}))
    if doubts[0]:
        words = fill(f"it holds, but {doubts[0]}", WIDE)
        marks.append(Line2D([], [], color=DOUBT, label=words, **dot))
    marks.append(
        Line2D(
            [],
            [],
            color=LIMIT,
            linestyle="--",
            linewidth=1.0,
            label="limit: utilisation below 1, stability margin above 0",
        )
    )
    marks += (
        [
            Patch(
                facecolor=BAND,
                label="valid range of what is under the hand" + (", of the piece alone" if limits else ""),
            )
        ]
        if ranges
        else []
    )
    marks += [Patch(facecolor=DOUBTED, label="doubtful part of it")] if doubts[1] else []
    marks += [Line2D([], [], color="#d55e00", linestyle=":", label="suggestions, how many")] if suggested else []
    figure.legend(
        handles=marks, loc="outside lower center", ncols=min(len(marks), 3 if limits or any(doubts) else 5), fontsize=8
    )
