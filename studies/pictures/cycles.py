"""Courses of a cloth that goes round in a cycle, and of what cures it."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from restshape.outputs.picture_files import save_picture
from restshape.report.style import FAINT, GOAL, INK, new_figure

COLOURS = ("#d55e00", "#e69f00", "#cc79a7", "#56b4e9", "#0072b2", "#222222")


def draw_cycles(path: Path, courses: Mapping[str, Any], goal: float) -> None:
    """Writes the picture as a PNG: residuals and speeds against steps.

    Args:
        path: of the picture.
        courses: by name, each with residuals, speeds and converged: the "start", and those that go on from its end.
        goal: residual at equilibrium.
    """
    figure = new_figure(10.5, 7.0)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    start = courses["start"]
    begun = len(start.residuals)
    for axes, values in ((above, start.residuals), (below, start.speeds)):
        axes.plot(np.arange(begun), np.array(values, dtype=float), color=FAINT, linewidth=0.9)
        axes.axvline(begun, color=FAINT, linewidth=0.8)
        axes.set_yscale("log")
        axes.grid(True, which="major", color="#e6e6e6", linewidth=0.6)
        axes.set_axisbelow(True)
    others = {name: course for name, course in courses.items() if name != "start"}
    for (name, course), colour in zip(others.items(), COLOURS):
        place = begun + np.arange(len(course.residuals))
        label = f"{name}: {'converged' if course.converged else 'not converged'}"
        above.plot(place, course.residuals, color=colour, linewidth=1.1, label=label)
        end = {"marker": "o" if course.converged else "", "markersize": 6, "color": colour, "zorder": 3}
        above.plot(place[-1], course.residuals[-1], **end)
        if course.speeds:
            below.plot(place, np.array(course.speeds, dtype=float), color=colour, linewidth=1.1)
    above.axhline(goal, color=GOAL, linestyle="--", linewidth=0.9, label=f"tolerance: {goal:g}")
    above.set(ylabel="residual / weight")
    below.set(ylabel="fastest node [m/s]", xlabel="steps")
    below.margins(x=0.02)
    figure.legend(*above.get_legend_handles_labels(), loc="outside lower center", ncols=2)
    title = "Cloth on a ball that cycles as in the author's program, and from there without one cause, or both"
    figure.suptitle(title, x=0.01, ha="left", color=INK)
    figure.align_ylabels()
    save_picture(figure, path)
