"""Legends below pictures."""

from collections.abc import Sequence
from typing import Any, NamedTuple

from matplotlib.artist import Artist
from matplotlib.figure import Figure, SubFigure


class LegendLine(NamedTuple):
    """A line of a legend: a colour and what it means.

    Args:
        colour: of the mark; text: beside it; style: of the mark, as of a line of Matplotlib's.
    """

    colour: str
    text: str
    style: Any = "-"


def legend_below(figure: Figure | SubFigure, handles: list[Artist], names: list[str]) -> int:
    """Puts a legend below, in as few lines as the figure's width allows; how many these are."""
    for lines in range(1, len(names) + 1):
        legend = figure.legend(handles, names, loc="lower center", ncols=-(-len(names) // lines))
        if legend.get_window_extent().width <= figure.bbox.width or lines == len(names):
            break
        legend.remove()
    return lines


def first_named(names: Sequence[str], most: int) -> str:
    """The first names, and how many more there are."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more
