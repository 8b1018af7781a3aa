"""Frames on more and more ranks: speed-up beside what memory allows, and where the time goes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.ticker import NullLocator

from restshape.outputs.picture_files import save_picture
from restshape.report.style import FAINT, INK, LEVEL_LABELS, LEVEL_MARKS, LEVELS, STAGES, new_figure

SHOWN = {"1": 1, "2": 2, "3": 3}
PARTS = (*(name for name in STAGES if name not in ("edit", "other")), "python", "estimate", "record")
COLOURS = STAGES | {"python": "#555555", "estimate": "#dddddd", "record": "#bbbbbb"}
LABELS = {"python": "Python, edit", "estimate": "residual", "record": "hand-over"}
LEAST_SHARE = 0.015
"""Of a frame, of stages that the legend names."""
MODES = {"strong": "strong: one mesh", "weak": "weak: a finer mesh on more ranks"}


def draw_ranks(name: str, found: Mapping[str, Any], path: Path) -> None:
    """Writes the picture as a PNG: a row of two panels for each mesh and kind of scaling.

    Args:
        name: of the scene.
        found: what `restshape_studies.bench.scaling.study` measures.
        path: of the picture.
    """
    runs = found["runs"]
    figure = new_figure(10.0, 1.4 + 3.0 * len(runs))
    panels = figure.subplots(len(runs), 2, squeeze=False)
    for (left, right), run in zip(panels, runs):
        _speed_ups(left, run)
        _stages(right, run["entries"])
    handles, labels = panels[0, 0].get_legend_handles_labels()
    for other in panels[1:, 0]:
        for handle, label in zip(*other.get_legend_handles_labels()):
            if label not in labels:
                handles, labels = [*handles, handle], [*labels, label]
    panels[0, 0].legend(handles, labels, loc="best", fontsize=8)
    cores = found["cores"]
    shared = "; ranks share cores" if found["oversubscribed"] else ""
    figure.suptitle(
        f"{name} on ranks of MPI; {cores} cores are what there is here{shared}\n"
        "limit: bandwidth of the triad on so many ranks over that on the first, at the working set of the solves",
        x=0.01,
        ha="left",
        color=INK,
    )
    save_picture(figure, path)


def _speed_ups(axes: Axes, run: Mapping[str, Any]) -> None:
    """Speed-up, of weak scaling efficiency, by level; the limit, and the model of level 1."""
    entries, weak = run["entries"], run["mode"] == "weak"
    ranks = [one["ranks"] for one in entries]
    for level, number in SHOWN.items():
        levels = [(one["ranks"], one["levels"][level]) for one in entries]
        points = [(n, found["speed_up"]) for n, found in levels if found and found["speed_up"]]
        if points:
            look = {"color": LEVELS[number], "marker": LEVEL_MARKS[number], "label": LEVEL_LABELS[number]}
            axes.plot(*zip(*points), markersize=5, linewidth=1.2, **look)
    axes.plot(ranks, [one["limit"] for one in entries], color=INK, linestyle="--", linewidth=1.0, label="limit")
    if run["model"]:
        base = entries[0]["levels"]["1"]["ms"]
        modelled = [(one["ranks"], base / one["ms"]) for one in (*run["model"]["checked"], *run["model"]["beyond"])]
        look = {"color": LEVELS[1], "linestyle": ":", "marker": "o", "markerfacecolor": "white", "markersize": 4}
        axes.plot(*zip(*modelled), linewidth=1.0, label="model of level 1", **look)
        ranks = sorted({*ranks, *(n for n, _ in modelled)})
    axes.set(xscale="log", xlabel="ranks", ylabel="efficiency" if weak else "speed-up")
    if not weak:
        axes.set_yscale("log")
        axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
        axes.yaxis.set_minor_formatter(lambda value, _: f"{value:g}" if f"{value:e}"[0] in "25" else "")
    else:
        axes.set_ylim(bottom=0.0)
    axes.set_xticks(ranks, [str(n) for n in ranks])
    axes.xaxis.set_minor_locator(NullLocator())
    axes.grid(True, color="#e6e6e6", linewidth=0.6)
    first, last = entries[0]["elements"], entries[-1]["elements"]
    size = f"{first:,} triangles" if first == last else f"{first:,} to {last:,} triangles"
    axes.set_title(f"{MODES[run['mode']]}, {size}", loc="left")


def _stages(axes: Axes, entries: Sequence[Mapping[str, Any]]) -> None:
    """A bar a number of ranks: stages of a frame of level 1, each of the slowest rank."""
    shown = [one for one in entries if one["levels"]["1"]]
    sums = [sum(one["levels"]["1"]["stages"].values()) for one in shown]
    longest = max(sums, default=1.0)
    left = [0.0] * len(shown)
    for part in PARTS:
        ms = [one["levels"]["1"]["stages"][part] for one in shown]
        seen = any(own > LEAST_SHARE * whole for own, whole in zip(ms, sums))
        words = LABELS.get(part, part) if seen else None
        axes.barh(range(len(shown)), ms, left=left, height=0.6, color=COLOURS[part], linewidth=0, label=words)
        left = [at + own for at, own in zip(left, ms)]
    for place, (one, at) in enumerate(zip(shown, left)):
        level = one["levels"]["1"]
        axes.text(at, place, f" {level['ms']:.3g} ms, {level['iterations']:.1f} iterations", va="center", fontsize=8)
    axes.set(yticks=range(len(shown)), yticklabels=[str(one["ranks"]) for one in shown], ylabel="ranks")
    axes.set(xlim=(0.0, 1.5 * longest), ylim=(len(shown) - 0.4, -1.6), xlabel="stages of a frame of level 1 [ms]")
    axes.tick_params(axis="y", length=0)
    if shown:
        axes.legend(loc="upper left", ncols=5, fontsize=7.5, handlelength=1.0, columnspacing=0.9)
    else:
        axes.text(0.5, 0.5, "no frame of level 1", transform=axes.transAxes, ha="center", color=FAINT)
