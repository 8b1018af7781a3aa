"""Texts of a picture that do not lie over each other: the later ones are smaller, or beside their places."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text

SIZES = (1.0, 0.85, 0.7, 0.6)
"""Sizes that are tried, over that of the text."""
UP = np.array([0.0, 1.0])
"""A direction on a picture."""
STEPS = (0.0, 0.3, -0.3, 0.6, -0.6, 1.0, -1.0, 1.6, -1.6)
"""Ways along its direction that are tried, over half of the text's extent there."""


def set_apart(texts: Sequence[Text], ways: Sequence[np.ndarray], fixed: Sequence[Text] = ()) -> None:
    """Moves texts of one axes, or makes them smaller, until none lies over another one; those without room stay.

    Args:
        texts: in data coordinates, the first ones before the others.
        ways: (2,) direction on the picture in which each may go, x to the right and y up; zero: only smaller.
        fixed: texts that stay, and are kept clear of.
    """
    if not texts:
        return
    canvas = texts[0].figure.canvas
    drawn = canvas if isinstance(canvas, FigureCanvasAgg) else FigureCanvasAgg(texts[0].figure)
    renderer = drawn.get_renderer()
    taken = [one.get_window_extent(renderer) for one in fixed]
    for text, way in zip(texts, ways):
        data = text.axes.transData
        place, size = np.array(text.get_position(), dtype=float), float(text.get_fontsize())
        for scale, step in _tries(bool(np.any(way))):
            text.set_fontsize(scale * size)
            text.set_position(tuple(place))
            box = text.get_window_extent(renderer)
            half = 0.5 * float(abs(way[0]) * box.width + abs(way[1]) * box.height)
            text.set_position(tuple(data.inverted().transform(data.transform(place) + step * half * way)))
            box = text.get_window_extent(renderer)
            if not any(box.overlaps(other) for other in taken):
                break
        else:
            text.set_fontsize(size)
            text.set_position(tuple(place))
            box = text.get_window_extent(renderer)
        taken.append(box)


def set_apart_alike(texts: Sequence[Text]) -> None:
    """The same for texts of one size, which may go up and down: all of them get the size of the smallest."""
    set_apart(texts, [UP] * len(texts))
    for text in texts:
        text.set_fontsize(min(one.get_fontsize() for one in texts))


def _tries(moves: bool) -> Sequence[tuple[float, float]]:
    """Sizes and ways, the nearest to what is wanted first."""
    found = [(size, step) for size in SIZES for step in (STEPS if moves else STEPS[:1])]
    return sorted(found, key=lambda one: 3.0 * abs(one[1]) + 2.0 * (1.0 - one[0]))
