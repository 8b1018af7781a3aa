"""Pictures of furniture side by side: as high as what is shown needs, and all in one view."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from restshape_apps.furniture.report.furniture import add_utilisation_bar, in_one_view

from restshape.report.style import INK

ACROSS, EACH, BAR = 3, 3.35, 0.75
"""Most pictures side by side, and width of each and of the colour bar [inch]."""
HEAD, LINE, SPACE = 0.1, 0.143, 0.17
"""Room above all and for a line of a title, and around each picture [inch]."""
H_PAD, W_PAD = 0.1, 0.06
"""Room that is left free above and below, left and right of a picture [inch]."""


def width_of(across: int) -> float:
    """Width of so many pictures and the colour bar [inch]."""
    return max(EACH * across + BAR, 6.0)


def finish_sheet(figure: Figure, panels: Sequence[Axes], count: int, across: int, heading: str) -> None:
    """Give pictures side by side one view, a colour bar and a heading, and the figure the height that they need.

    Args:
        figure: of these pictures alone.
        panels: by rows; all that are drawn have their titles.
        count: that are drawn; the others are hidden.
        across: in a row.
        heading: over all.
    """
    in_one_view(panels[:count])
    for axes in panels[count:]:
        axes.set_visible(False)
    add_utilisation_bar(figure, panels)
    figure.suptitle(heading, x=0.01, ha="left", color=INK, fontsize=9)
    figure.get_layout_engine().set(h_pad=H_PAD, w_pad=W_PAD)
    (left, right), (bottom, top) = panels[0].get_xlim(), panels[0].get_ylim()
    wide = (figure.get_figwidth() - BAR) / across - 2.0 * W_PAD
    rows = [panels[k : min(k + across, count)] for k in range(0, count, across)]
    lines = [max(_lines(axes.get_title(loc="left")) for axes in row) for row in rows]
    height = HEAD + LINE * (_lines(heading) + sum(lines)) + len(rows) * (SPACE + wide * (top - bottom) / (right - left))
    figure.set_figheight(height)


def _lines(text: str) -> int:
    return text.count("\n") + 1 if text else 0
