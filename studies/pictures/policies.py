"""Time a frame by policy and scene: a dot at the median, a line to the 95th percentile."""

from collections.abc import Mapping
from pathlib import Path
from textwrap import shorten
from typing import Any

from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator

from restshape.outputs.picture_files import save_picture
from restshape.report.style import FAINT, INK, new_figure

COLOURS = {"rebuild": "#999933", "refactor": "#88ccee", "thesis": "#cc6677", "auto": "#332288"}
OTHERS = ("#44aa99", "#ddcc77", "#117733", "#aa4499", "#882255", "#661100", "#6699cc")
MOST_IN_A_ROW = 5
"""Names in a row of the legend."""


def draw_policies(found: Mapping[str, Mapping[str, Mapping[str, Any]]], path: Path) -> None:
    """Writes the picture as a PNG: a group of rows a scene, in each the median with a line to the 95th percentile.

    The axis is logarithmic, on which the length of a bar would mean nothing.

    Args:
        found: scene -> policy -> record with ms (p50, p95) [ms] and fps, as `bench reuse --json` writes it.
        path: of the picture.
    """
    policies = list(dict.fromkeys(name for scene in found.values() for name in scene))
    colours = {name: COLOURS.get(name, OTHERS[k % len(OTHERS)]) for k, name in enumerate(policies)}
    figure = new_figure(8.0, 1.5 + 0.34 * sum(len(scene) + 1 for scene in found.values()))
    axes = figure.subplots()
    place, ticks, handles = 0.0, [], {}
    for name, scene in found.items():
        first = place
        for policy, entry in scene.items():
            handles[policy] = _row(axes, place, entry, colours[policy])
            place += 1
        ticks.append(((first + place - 1) / 2, name))
        place += 0.8
    _scale(axes, [v for scene in found.values() for entry in scene.values() for v in entry["ms"].values() if v > 0])
    axes.set(yticks=[at for at, _ in ticks], yticklabels=[shorten(name, 30, placeholder=" …") for _, name in ticks])
    axes.set_ylim(place - 1.1, -0.7)
    axes.tick_params(axis="y", length=0)
    axes.set_xlabel(
        "time until the answer of a solved frame [ms]: median (dot) to 95th percentile (line)\n"
        "without residual, estimates and recording"
    )
    figure.suptitle("The same edits under several policies of reuse", x=0.01, ha="left", color=INK)
    figure.legend(
        list(handles.values()), list(handles), loc="outside lower center", ncols=min(len(handles), MOST_IN_A_ROW)
    )
    save_picture(figure, path)


def _row(axes: Axes, place: float, entry: Mapping[str, Any], colour: str) -> Any:
    """A dot with its line and words; words alone where nothing moved."""
    p50, p95 = entry["ms"]["p50"], entry["ms"]["p95"]
    look = {"marker": "o", "markersize": 7, "color": colour}
    if p50 <= 0:
        axes.text(0.01, place, "no moved frames", transform=axes.get_yaxis_transform(), va="center", color=FAINT)
        return axes.plot([], [], linestyle="none", **look)[0]
    axes.plot([p50, p95], [place, place], color=colour, linewidth=1.6, marker="|", markersize=6)
    (dot,) = axes.plot([p50], [place], linestyle="none", **look)
    rate = f"{entry['fps']:,.0f}" if entry["fps"] >= 100 else f"{entry['fps']:.3g}"
    axes.text(max(p50, p95) * 1.12, place, f"{p50:.3g} ms, {rate} frames/s", va="center", fontsize=8)
    return dot


def _scale(axes: Axes, times: list[float]) -> None:
    """A logarithmic axis with room for the words right of the longest line."""
    if not times:
        return
    axes.set_xscale("log")
    least, most = min(times) / 1.6, max(times)
    axes.set_xlim(least, most * (most / least) ** 0.42)
    axes.xaxis.set_major_locator(LogLocator(subs=(1,) if most > 1e3 * least else (1, 2, 5)))
    axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.xaxis.set_minor_formatter(lambda value, _: "")
    axes.grid(True, axis="x", color="#e6e6e6", linewidth=0.6)
    axes.set_axisbelow(True)
