"""A page of paper in millimetres: lines, dimensions, tables."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from restshape.arrays import Reals

SIZE = np.array([210.0, 297.0])
"""Of A4 [mm]."""
EDGE = 12.0
"""Border that stays white [mm]."""
INCH = 25.4
INK, FAINT, HOLE, WARM = "#222222", "#8a8a8a", "#0000c8", "#b8560f"
SMALL, NORMAL = 7.0, 8.0
"""Sizes of letters [points]."""
HEAD = 2.2
"""Length of the heads of arrows of dimensions [mm]."""
ROW = 4.4
"""From a row of a table to the next [mm]."""
STYLE = {"pdf.fonttype": 42, "text.parse_math": False, "text.usetex": False, "path.simplify": False}


class SheetPage:
    """A page whose axes are in millimetres from its lower left corner."""

    def __init__(self) -> None:
        self.figure = Figure(figsize=tuple(SIZE / INCH))
        self.axes = self.figure.add_axes((0.0, 0.0, 1.0, 1.0))
        self.axes.set(xlim=(0.0, SIZE[0]), ylim=(0.0, SIZE[1]))
        self.axes.set_axis_off()

    def inner(self, low: Sequence[float], size: Sequence[float]) -> Axes:
        """Axes of their own in a box with this lower corner and size [mm]."""
        (x, y), (w, h) = np.array(low) / SIZE, np.array(size) / SIZE
        return self.figure.add_axes((x, y, w, h))

    def lines(self, lines: Sequence[Reals], width: float, colour: str = INK, dashes: Sequence[float] = ()) -> None:
        """Draw lines (m, 2) [mm] of a width [points]."""
        style = [(0, tuple(dashes))] if dashes else "solid"
        drawn = LineCollection(list(lines), colors=colour, linewidths=width, linestyles=style)
        self.axes.add_collection(drawn, autolim=False)

    def text(self, x: float, y: float, text: str, size: float = NORMAL, **look: object) -> None:
        """Write a text at a place [mm], from the left unless `ha` says else."""
        self.axes.text(x, y, text, fontsize=size, **{"ha": "left", "va": "center", "color": INK, **look})

    def along_x(self, left: float, right: float, y: float, feet: Sequence[float], text: str) -> None:
        """A dimension at the height y, with thin lines down from `feet`, the ordinates of its ends."""
        ends = np.array([[left, y], [right, y]])
        self._dimension(ends, [np.array([[x, foot], [x, y - 1.5]]) for x, foot in zip((left, right), feet)])
        self.text(0.5 * (left + right), y + 1.8, text, SMALL, ha="center")

    def along_y(self, low: float, high: float, x: float, feet: Sequence[float], text: str) -> None:
        """A dimension at the abscissa x, with thin lines from `feet`, the abscissas of its ends."""
        ends = np.array([[x, low], [x, high]])
        self._dimension(ends, [np.array([[foot, y], [x + 1.5, y]]) for y, foot in zip((low, high), feet)])
        self.text(x + 1.0, 0.5 * (low + high), text, SMALL, rotation=90, ha="left")

    def _dimension(self, ends: Reals, thin: list[Reals]) -> None:
        along = (ends[1] - ends[0]) / max(float(np.hypot(*(ends[1] - ends[0]))), 1e-9)
        across = 0.25 * np.array([-along[1], along[0]])
        heads = [
            np.array([end + HEAD * (way + across), end, end + HEAD * (way - across)])
            for end, way in ((ends[0], along), (ends[1], -along))
        ]
        self.lines([ends, *heads], 0.5)
        self.lines(thin, 0.3, FAINT)

    def table(
        self,
        x: float,
        y: float,
        widths: Sequence[float],
        heads: Sequence[str],
        rows: Sequence[Sequence[str]],
        title: str,
    ) -> float:
        """Write a table below a place [mm], its first column from the left, others to the right; where it ends.

        Args:
            x, y: of its upper left corner [mm]; widths: of the columns [mm].
            heads: of the columns, or none; rows: of cells; title: above them.
        """
        self.text(x, y, title, NORMAL, weight="bold")
        self.lines([np.array([[x, y - 2.4], [x + sum(widths), y - 2.4]])], 0.6)
        ends = x + np.cumsum(widths)
        all_rows = [*([heads] if heads else []), *rows]
        for number, row in enumerate(all_rows, 1):
            colour = FAINT if row is heads else INK
            for k, cell in enumerate(row):
                at = {"x": float(ends[k]), "ha": "right"} if k else {"x": x}
                self.text(y=y - 0.6 - ROW * number, text=cell, size=SMALL, color=colour, **at)
        return y - 0.6 - ROW * (len(all_rows) + 1)
