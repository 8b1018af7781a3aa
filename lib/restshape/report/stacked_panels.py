"""Panels one below the other in a figure, with room for the numbers of their axes and a legend below them.

A layout engine of matplotlib would measure everything twice, which takes longer than to draw it.
"""

from collections.abc import Sequence
from itertools import accumulate

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.transforms import ScaledTranslation

TITLE, BELOW, ROW, FRAME = 0.2, 0.46, 0.19, 0.08
"""Height of the title, of what is below the lowest panel, of a line of the legend; room around all of it [inch]."""
LETTER = 0.08
"""Width of a letter of the numbers beside an axis [inch]."""
NAME, TICK = 0.16, 0.16
"""Width of a line of the name of an axis, and of its ticks with the room around them [inch]."""


def stack_panels(
    figure: Figure,
    panels: Sequence[Axes],
    ratios: Sequence[float],
    above: Sequence[float],
    rows: int = 0,
    right: float = FRAME,
) -> None:
    """Puts panels into their places, all as wide as the numbers beside them allow.

    Args:
        figure: its title is at the top, its legend, if any, at the bottom.
        panels: from top to bottom; what they show is complete.
        ratios: of their heights.
        above: room above each [inch].
        rows: lines of the legend.
        right: room on the right of all [inch].
    """
    width, height = figure.get_size_inches()
    figure.set_layout_engine("none")
    legend = ROW * rows + FRAME if rows else 0.0
    free = height - TITLE - FRAME - BELOW - legend - sum(above)
    sizes = [free * ratio / sum(ratios) for ratio in ratios]
    tops = [
        height - TITLE - FRAME - sum(above[: k + 1]) - before
        for k, before in enumerate(accumulate([0.0, *sizes]))
        if k < len(sizes)
    ]

    def place(left: float) -> None:
        for axes, top, size in zip(panels, tops, sizes):
            axes.set_position((left / width, (top - size) / height, 1.0 - (left + right) / width, size / height))

    # How many numbers an axis has depends on its height, not on its width.
    place(FRAME)
    names = [axes.get_ylabel() for axes in panels]
    lines = max(name.count("\n") + 1 if name else 0 for name in names)
    letters = max(len(label.get_text()) for axes in panels for label in axes.get_yticklabels())
    left = FRAME + NAME * lines + LETTER * letters + TICK
    place(left)
    for axes in panels:
        axes.yaxis.label.set(verticalalignment="top")
        beside = ScaledTranslation((FRAME - left), 0.0, figure.dpi_scale_trans)
        axes.yaxis.set_label_coords(0.0, 0.5, transform=axes.transAxes + beside)
    if title := figure._suptitle:  # type: ignore[attr-defined]
        title.set(y=1.0 - 0.5 * FRAME / height, verticalalignment="top")
