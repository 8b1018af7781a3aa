"""A picture of a fit: both outlines from above, and their distance all the way round."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from restshape_apps.couture.fitting.fit import Step
from restshape_apps.couture.fitting.outline_distance import MEASURED

from restshape.outputs.picture_files import save_picture
from restshape.report.style import BODY, FAINT, INK, new_figure

MM = 1e3
MEASURED_COLOUR = "#d55e00"
WIDE, TALL = 11.0, 5.2
"""Of the picture [inch]."""


def draw(measured: np.ndarray, first: Step, best: Step, words: tuple[str, str], path: Path) -> None:
    """Draws both outlines in the frame of the drape.

    Args:
        measured: (m, 2) points of the measured outline from its middle [m].
        first: of the scene as it is; best: fitted.
        words: of the values of each.
        path: of the picture.

    Raises:
        OSError: it cannot be written.
    """
    figure = new_figure(WIDE, TALL)
    left, right = figure.subplots(1, 2, width_ratios=(1.0, 1.15))
    _outlines(left, measured, first, best, words)
    _distances(right, first, best)
    save_picture(figure, path)


def _outlines(axes: Axes, measured: np.ndarray, first: Step, best: Step, words: tuple[str, str]) -> None:
    drape, start = _closed(best.drape.edge.points()), _closed(first.drape.edge.points())
    placed = _closed(best.place.lay(measured))
    # The first drape is turned as the measured outline fits each.
    turn = best.place.turn - first.place.turn
    c, s = np.cos(turn), np.sin(turn)
    start = (start - [first.place.x, first.place.y]) @ np.array([[c, s], [-s, c]]) + [best.place.x, best.place.y]
    axes.fill(*(MM * drape.T), color=BODY, zorder=1)
    axes.plot(*(MM * start.T), color=FAINT, lw=1.0, ls="--", zorder=2, label=f"before: {words[0]}")
    axes.plot(*(MM * drape.T), color=INK, lw=1.2, zorder=3, label=f"fitted: {words[1]}")
    axes.plot(*(MM * placed.T), color=MEASURED_COLOUR, lw=0.9, zorder=4, label="measured outline")
    axes.set(aspect="equal", xlabel="x [mm]", ylabel="y [mm]")
    axes.set_title("shadow from above")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.12), fontsize=8)


def _distances(axes: Axes, first: Step, best: Step) -> None:
    for step, colour, style, name in ((first, FAINT, "--", "before"), (best, INK, "-", "fitted")):
        values = step.distances.values[MEASURED:]
        angles = 360.0 / len(values) * np.arange(len(values))
        # In directions of the fitted drape.
        turned = np.degrees(best.place.turn - step.place.turn)
        order = np.argsort((angles + turned) % 360.0)
        label = f"{name}: {MM * step.misfit:.3g} mm root mean square, {MM * step.distances.farthest:.3g} mm at most"
        axes.plot(((angles + turned) % 360.0)[order], MM * values[order], color=colour, ls=style, lw=1.0, label=label)
    axes.axhline(0.0, color=FAINT, lw=0.6)
    axes.set(xlim=(0, 360), xticks=range(0, 361, 60), xlabel="direction from the middle of the cloth [deg]")
    axes.set_ylabel("measured outline outside of the shadow [mm]")
    axes.set_title(f"distance of both outlines, in {len(best.distances.values) - MEASURED} directions")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.12), fontsize=8)


def _closed(points: np.ndarray) -> np.ndarray:
    return np.vstack([points, points[:1]])
