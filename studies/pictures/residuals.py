"""Residuals on the solution strategy, against time and against steps."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from restshape.outputs.picture_files import save_picture
from restshape.report.style import FAINT, GOAL, INK, new_figure

COLOURS = {
    "auto": "#222222",
    "kinetic": "#0072b2",
    "rayleigh": "#56b4e9",
    "newton": "#d55e00",
    "stabilised": "#e69f00",
    "cg": "#009e73",
}
OTHERS = ("#cc79a7", "#882255", "#999933", "#332288")
WORDS = {
    "auto": "auto: fall, quasi-Newton, Newton",
    "kinetic": "kinetic damping",
    "rayleigh": "Rayleigh damping",
    "newton": "Newton, true tangent",
    "stabilised": "Newton, stabilised tangent",
    "cg": "nonlinear CG",
}
SHOWN = 1e-7, 1e3
"""Residuals outside are drawn at the edge."""


def draw_residuals(name: str, runs: Mapping[str, Mapping[str, Any]], path: Path, goal: float = 1e-4) -> None:
    """Writes the picture as a PNG: residual over weight against seconds and against steps, a line a way.

    Dotted where other cloth stands in: softer, with hinges, or on a coarser mesh; a dot where a way rests, a cross
    where it ends otherwise.

    Args:
        name: of the scene.
        runs: by name what `restshape_studies.bench.drape` measures.
        path: of the picture.
        goal: residual at equilibrium.
    """
    figure = new_figure(11.0, 5.4)
    left, right = figure.subplots(1, 2, sharey=True)
    drawn = {key: run for key, run in runs.items() if run.get("trace", {}).get("residuals")}
    spare = iter(OTHERS * len(drawn))
    colours = {key: COLOURS.get(key) or next(spare) for key in drawn}
    for key, run in drawn.items():
        trace = run["trace"]
        residuals = np.array([SHOWN[1] if r is None else r for r in trace["residuals"]], dtype=float)
        rough = np.array([energy is None for energy in trace["energies"]])
        _line(left, np.array(trace["seconds"]), residuals, rough, run["converged"], colours[key])
        _line(right, np.arange(1, len(residuals) + 1), residuals, rough, run["converged"], colours[key])
    for axes in (left, right):
        axes.set(xscale="log", yscale="log")
        axes.axhline(goal, color=GOAL, linewidth=0.9, linestyle="--")
        axes.grid(True, which="major", color="#e6e6e6", linewidth=0.6)
        axes.set_axisbelow(True)
        axes.margins(x=0.04, y=0.05)
    left.set(xlabel="time [s]", ylabel="residual / weight")
    left.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
    right.set(xlabel="iterates")
    right.xaxis.set_major_formatter(lambda value, _: f"{value:,.0f}")
    figure.legend(handles=_legend(drawn, colours, goal), loc="outside lower center", ncols=3)
    figure.suptitle(f"{name}: solution strategies from the same start, one core", x=0.01, ha="left", color=INK)
    save_picture(figure, path)


def _line(
    axes: Axes, place: np.ndarray, residuals: np.ndarray, rough: np.ndarray, converged: bool, colour: str
) -> None:
    """One way: pieces of what counts, dotted ones of what leads there, and how it ends."""
    residuals = np.clip(residuals, *SHOWN)
    for part, look in ((rough, ":"), (~rough, "-")):
        axes.plot(place, np.where(part, residuals, np.nan), linestyle=look, linewidth=1.3, color=colour)
    axes.plot(
        place[-1], residuals[-1], marker="o" if converged else "x", markersize=7, mew=2, color=colour, clip_on=False
    )


def _legend(runs: Mapping[str, Any], colours: Mapping[str, str], goal: float) -> Sequence[Line2D]:
    """Handles of what the picture holds."""
    handles = [
        Line2D(
            [], [], color=colours[key], label=f"{WORDS.get(key, key)}{'' if run['converged'] else ' (not converged)'}"
        )
        for key, run in runs.items()
    ]
    handles.append(Line2D([], [], color=GOAL, linestyle="--", linewidth=0.9, label=f"tolerance: {goal:g}"))
    if any(energy is None for run in runs.values() for energy in run["trace"]["energies"]):
        handles.append(Line2D([], [], color=FAINT, linestyle=":", label="stand-in: softer, hinges, or a coarser mesh"))
    return handles
