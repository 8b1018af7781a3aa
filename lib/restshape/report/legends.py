"""Legends below pictures."""

from collections.abc import Sequence

from matplotlib.artist import Artist
from matplotlib.figure import Figure, SubFigure


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
