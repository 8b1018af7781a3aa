"""The picture of an instrument: the outlines of its bars above, their first modes in space below."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from restshape_apps.metallophone.instrument.bars import Bar
from restshape_apps.metallophone.space_picture import flat_body, space_modes

from restshape.outputs.picture_files import save_picture
from restshape.outputs.si_numbers import length_unit
from restshape.report.bent_plate import FlatBody
from restshape.report.fitted_title import fits
from restshape.report.outlines import border, chains, polygons
from restshape.report.space_modes import ModeView, SpaceMode, add_mode_bar, body_drawing
from restshape.report.space_scene import SpaceImage
from restshape.report.style import BODY, INK, new_figure

ACROSS, COLUMN, ROOM = 7, 2.1, 1.12
"""Bars in a row at most, width of a column [inch], and of a column in widths of the longest bar."""
TITLE, LINE, WORDS, GAP, BAR = 0.3, 0.17, 0.5, 0.15, 0.75
"""Height of the title, of a second line of it, of the words over each bar, between bar and mode, and of the colour bar
[inch]."""
LETTERS, LETTER = 16, 10.0
"""Of the name of a bar's file at most, and size of the title's [points]."""


def draw(bars: Sequence[Bar], path: Path) -> None:
    """Draw bars at one scale, each with its tone, and below it its first mode, at one scale too.

    Args:
        bars: in their order, from left to right; path: picture file.

    Source: figure 4.12 of the thesis.
    """
    across = min(ACROSS, len(bars))
    down = -(-len(bars) // across)
    sizes = np.array([np.ptp(bar.analysis.space.X, axis=0) for bar in bars])
    inch = COLUMN / (ROOM * sizes[:, 0].max())
    flat = 1.05 * inch * sizes[:, 1].max()
    drawn = [_mode(bar) for bar in bars]
    seen = COLUMN / max(view.window[1] - view.window[0] for _, _, view in drawn)
    bent = seen * max(view.window[3] - view.window[2] for _, _, view in drawn)
    row, wide = WORDS + flat + GAP + bent, max(across, 2) * COLUMN
    title = _title(float(sizes[:, 0].max()), wide)
    head = TITLE + LINE * title.count("\n")
    high = head + down * row + BAR
    figure = new_figure(wide, high)
    figure.set_layout_engine("none")
    for k, (bar, (body, mode, view)) in enumerate(zip(bars, drawn)):
        line, column = divmod(k, across)
        left, top = column * COLUMN, high - head - line * row - WORDS
        _draw_outline(figure.add_axes((left / wide, (top - flat) / high, COLUMN / wide, flat / high)), bar, inch)
        own, tall = (seen * (view.window[side + 1] - view.window[side]) for side in (0, 2))
        left, bottom = left + 0.5 * (COLUMN - own), top - flat - GAP - tall
        below = figure.add_axes((left / wide, bottom / high, own / wide, tall / high))
        view.frame(below)
        SpaceImage(below, view.camera).scene = body_drawing(body, mode)
    _add_words(figure, title, all(mode.perpendicular for _, mode, _ in drawn))
    save_picture(figure, path)


def _mode(bar: Bar) -> tuple[FlatBody, SpaceMode, ModeView]:
    """Body, first mode and view of a bar."""
    body, mode = flat_body(bar.analysis), space_modes(bar.analysis)[0]
    return body, mode, ModeView.of(body, [mode])


def _draw_outline(axes: Axes, bar: Bar, inch: float) -> None:
    """Draw the outline and the tone over it, `inch` a metre."""
    space = bar.analysis.space
    X = space.X - 0.5 * (space.X.min(axis=0) + space.X.max(axis=0))
    axes.add_collection(PolyCollection(polygons(X, space.cells), facecolor=BODY, edgecolor=BODY, linewidth=0.3))
    axes.add_collection(LineCollection(chains(X, border(space.cells)), colors=INK, linewidths=0.9))
    half, tall = 0.5 * COLUMN / inch, 0.5 * axes.get_position().height * axes.figure.get_figheight() / inch
    axes.set(xlim=(-half, half), ylim=(-tall, tall))
    axes.set_axis_off()
    words = {"transform": axes.transAxes, "ha": "center", "va": "bottom", "clip_on": False}
    name = bar.path.stem
    said = (
        ""
        if name.lower() == bar.tone[0].lower()
        else f"{name if len(name) <= LETTERS else name[: LETTERS - 1] + '…'}: "
    )
    axes.text(0.5, 1.0, f"{said}{bar.title}\n{bar.frequencies[0]:.1f} Hz", fontsize=9, **words)


def _title(longest: float, wide: float) -> str:
    """What is drawn of bars, the longest of a length [m], in two lines where a figure is not so wide [inch]."""
    factor, unit = length_unit(longest)
    lines = [f"outlines at one scale, the longest {factor * longest:.4g} {unit}"]
    lines.append("below: mode 1, exaggerated; grey: at rest")
    one = "; ".join(lines)
    return one if fits(one, wide, LETTER) else "\n".join(lines)


def _add_words(figure: Figure, title: str, perpendicular: bool) -> None:
    """The title, and the colours of the modes.

    Args:
        figure: that is drawn; title: of it.
        perpendicular: whether all modes drawn move out of the plane.
    """
    wide, high = figure.get_size_inches()
    figure.text(0.5, 1.0 - 0.1 / high, title, fontsize=LETTER, ha="center", va="top")
    if perpendicular:
        length = min(0.8, 4.0 / wide)
        bar = figure.add_axes((0.5 - 0.5 * length, 0.45 / high, length, 0.12 / high))
        add_mode_bar(bar, True)
