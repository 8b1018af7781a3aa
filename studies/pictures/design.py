"""Pictures of the design derivative: how exact it is, and how far it predicts."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from restshape.outputs.picture_files import save_picture
from restshape.report.style import FAINT, INK, new_figure

WAYS = {
    "forward": ("full solves, forward (5.13)", "#cc6677", "o"),
    "central": ("full solves, central", "#999933", "s"),
    "semi": ("semi-analytic (5.14)", "#332288", "^"),
}


def draw_derivative(name: str, found: Mapping[str, Any], path: Path) -> None:
    """Writes the picture as a PNG: distances from the derivative by dual numbers over the step of the differences.

    Args:
        name: of the scene.
        found: as `bench derivative --json` writes it.
        path: of the picture.
    """
    figure = new_figure(7.0, 4.6)
    axes = figure.subplots()
    for way, (label, colour, mark) in WAYS.items():
        pairs = [(h, e) for h, e in zip(found["steps"], found[way]) if e]
        if pairs:
            axes.loglog(*zip(*pairs), color=colour, marker=mark, markersize=4, linewidth=1.2, label=label)
    axes.set(
        xlabel="step of the differences / size of the shape", ylabel="distance from the derivative by dual numbers"
    )
    axes.grid(True, color="#e6e6e6", linewidth=0.6)
    if axes.lines:
        axes.legend(loc="lower left")
    title = f"{name}: three ways to the design derivative, {found['unknowns']:,} unknowns"
    figure.suptitle(title, x=0.01, ha="left", color=INK)
    save_picture(figure, path)


def draw_drape(name: str, found: Mapping[str, Any], path: Path) -> None:
    """Writes the picture as a PNG: Taylor remainders of a drape's derivatives, by the hand and by numbers.

    Steps of numbers are shown by the farthest way of a node.

    Args:
        name: of the scene; found: as `bench derivative --json` writes it; path: of the picture.
    """
    figure = new_figure(7.0, 4.6)
    axes = figure.subplots()
    for axis, remainders, colour, mark in zip("xy", found["remainders"], ("#2c6da4", "#c2571a"), "os"):
        pairs = [(h, h * e) for h, e in zip(found["steps"], remainders) if e]
        if pairs:
            axes.loglog(*zip(*pairs), color=colour, marker=mark, markersize=4, linewidth=1.2, label=f"along {axis}")
    for one in found["numbers"]["rows"] if found["numbers"] else ():
        steps = [part * one["step"] * one["motion"] / found["size"] for part in (1.0, 0.5)]
        pairs = [(h, h * e) for h, e in zip(steps, one["remainders"]) if e]
        if pairs and one["order"] is not None:
            axes.loglog(*zip(*pairs), marker=".", markersize=3, linewidth=0.8, label=one["key"])
    axes.set(
        xlabel="step of the hand, or way of a node, / size of the cloth", ylabel="remainder / norm of the derivative"
    )
    axes.grid(True, color="#e6e6e6", linewidth=0.6)
    if axes.lines:
        axes.legend(loc="upper left", fontsize=5)
    title = f"{name}: what is beyond derivatives of the drape, {found['nodes']:,} nodes"
    figure.suptitle(title, x=0.01, ha="left", color=INK)
    save_picture(figure, path)


def draw_prediction(name: str, found: Mapping[str, Any], path: Path) -> None:
    """Writes the picture as a PNG: the error of predicted frames over the way of the hand from where they start.

    Beside it the error of each way of prediction in the frames of drags, with marks where samples were taken.

    Args:
        name: of the scene.
        found: as `bench predict --json` writes it.
        path: of the picture.
    """
    figure = new_figure(11.0, 4.6)
    axes, beside = figure.subplots(1, 2)
    _draw_ways(beside, found["ways"])
    way, error = (np.array(found[key]) for key in ("way", "error"))
    shown = (way > 0) & (error > 0)
    axes.loglog(way[shown], error[shown], color="#332288", marker="o", markersize=4, linestyle="none")
    if shown.any():
        # Through the nearest points: farther off, terms of higher order have their share.
        near = shown & (way <= np.quantile(way[shown], 0.1))
        middle = np.exp(np.median(np.log(error[near]) - 2 * np.log(way[near])))
        ends = np.array([way[shown].min(), way[shown].max()])
        axes.loglog(ends, middle * ends**2, color=FAINT, linewidth=1.0, label="slope 2")
        axes.legend(loc="upper left")
    # Only what a hand holds and drags is predicted: its way is a length.
    axes.set(xlabel="way of the hand from the solved frame [m]", ylabel="error of the displacement, relative")
    axes.grid(True, color="#e6e6e6", linewidth=0.6)
    title = f"{name}: predicted frames ({found['fps']['predicted']:,.0f} a second) against solved ones"
    figure.suptitle(title, x=0.01, ha="left", color=INK)
    save_picture(figure, path)


def _draw_ways(axes: Axes, ways: Mapping[str, Any]) -> None:
    """Draw errors over the frames of drags, a line for each way, and below them where samples were taken."""
    for (way, one), colour in zip(ways.items(), (FAINT, "#cc6677", "#332288", "#999933", "#44aa99")):
        if "error" not in one:
            continue
        # A line ends where the hand rests or lets go.
        ends = np.flatnonzero(np.diff(one["frames_at"]) > 1) + 1
        parts = zip(*(np.split(np.array(one[key], float), ends) for key in ("frames_at", "error")))
        for k, (frames, errors) in enumerate(parts):
            axes.semilogy(frames, errors, color=colour, linewidth=1.2, label=None if k else way)
        if way == "gmls" and one["sampled"]:
            # Just above the axis, whatever the errors are.
            height, across = np.full(len(one["sampled"]), 0.02), axes.get_xaxis_transform()
            axes.plot(one["sampled"], height, "D", color=colour, markersize=4, transform=across, label="sample of gmls")
    axes.set(xlabel="frame", ylabel="error of the answer, relative")
    axes.margins(y=0.1)
    axes.grid(True, color="#e6e6e6", linewidth=0.6)
    axes.legend(loc="lower left", bbox_to_anchor=(-0.02, 1.0), ncols=5, fontsize=7, handlelength=1.2, columnspacing=1.0)
