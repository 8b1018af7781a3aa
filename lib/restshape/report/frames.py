"""The contact sheet: some frames of a recording side by side, deformed shape in the colours of its stress."""

from collections.abc import Collection, Sequence
from math import ceil
from pathlib import Path
from textwrap import shorten, wrap
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

from restshape.outputs.picture_files import save_picture
from restshape.replay.recording.recording import Recording
from restshape.report.drawing import Drawing
from restshape.report.happenings import failure, frame_words
from restshape.report.marks import marks, singular_words
from restshape.report.overlay import USUAL, overlay, vector_segments
from restshape.report.recorded_quantities import limit_series
from restshape.report.scenery import Scenery
from restshape.report.style import FAINT, INK, REFUSED, new_figure

WIDTH = 9.5
"""Of a sheet at most [inch]; all lengths below are inches, too."""
LEFT, RIGHT, BELOW, BETWEEN = 0.72, 1.25, 0.5, 0.3
"""Room for numbers and names of axes, for the colour bar, and between panels."""
NARROWEST, TALLEST = 1.2, 9.0
"""Width of a panel below which not even half a caption fits; height of all panels."""
LETTER, LINE = 0.066, 0.15
"""Width and height of a letter of a caption."""
TITLE_LETTER, TITLE_LINE = 0.08, 0.19
"""The same of the title."""


class Sheet(NamedTuple):
    """Where panels are on a sheet: how many rows and columns, and the width and height of a panel [inch]."""

    rows: int
    columns: int
    width: float
    height: float


def draw_frames(
    recording: Recording, chosen: np.ndarray, scenery: Scenery, path: Path, things: Collection[str] = USUAL
) -> None:
    """Writes the contact sheet, in the format that the path's suffix names.

    Args:
        recording: of a shape in the plane.
        chosen: frames to show.
        scenery: scale, extent and colours.
        path: of the picture.
        things: what frames show besides the field, some of mesh, goal, vectors, and `overlay.REBUILT`.

    Raises:
        UserError: something of it cannot be shown.
    """
    over = overlay(recording, scenery, chosen, things)
    vectors = vector_segments(recording, scenery, chosen, things)
    xmin, xmax, ymin, ymax = scenery.extent
    sheet = layout(len(chosen), (xmax - xmin) / (ymax - ymin))
    captions = [caption(recording, int(i), scenery, int(sheet.width / LETTER)) for i in chosen]
    figure, grid, bar = _panels(sheet, captions, title_lines(recording, scenery, _wide(sheet)))
    for k, (i, axes) in enumerate(zip(map(int, chosen), grid)):
        Drawing(axes, scenery, mesh="mesh" in things, goal="goal" in things).show(recording, i)
        if vectors and scenery.seen.solved[i]:
            vectors.draw(axes, i)
        if over:
            over.draw(axes, i)
        why = failure(recording, i, bool(scenery.seen.solved[i]))
        axes.set_title(captions[k], loc="left", pad=3, color=REFUSED if why else INK)
        below, left = k + sheet.columns >= len(chosen), k % sheet.columns == 0
        _label(axes, scenery, bottom=below, left=left, fails=bool(why))
    add_colour_bar(figure, bar, recording, scenery)
    if vectors:
        vectors.explain(figure, figure.get_figwidth() - RIGHT + 0.2, BELOW - 0.15, sheet.width / (xmax - xmin))
    save_picture(figure, path)


def layout(count: int, aspect: float) -> Sheet:
    """The sheet for so many panels of this aspect ratio (width / height)."""
    room = WIDTH - LEFT - RIGHT
    most = max(1, min(count, int(room / (NARROWEST + BETWEEN))))
    columns = min(range(1, most + 1), key=lambda columns: _badness(count, columns, aspect))
    rows = ceil(count / columns)
    width = min((room + BETWEEN) / columns - BETWEEN, 6.0 if columns == 1 else room)
    height = min(width / aspect, TALLEST / rows)
    return Sheet(rows, columns, max(height * aspect, NARROWEST), height)


def _wide(sheet: Sheet) -> float:
    """Width of the whole sheet [inch]."""
    return max(LEFT + sheet.columns * (sheet.width + BETWEEN) - BETWEEN + RIGHT, 4.5)


def _panels(sheet: Sheet, captions: Sequence[str], heading: Sequence[str]) -> tuple[Figure, list[Axes], Axes]:
    """A figure with its title, the axes of its panels below their captions, and those of the colour bar."""
    columns, wide = sheet.columns, _wide(sheet)
    lines = [max(text.count("\n") + 1 for text in captions[k : k + columns]) for k in range(0, len(captions), columns)]
    top = 0.15 + TITLE_LINE * len(heading)
    high = top + sum(0.12 + LINE * count + sheet.height for count in lines) + BELOW
    figure = new_figure(wide, high)
    figure.set_layout_engine("none")
    figure.suptitle("\n".join(heading), color=INK, y=1.0 - 0.08 / high, va="top")

    def place(x: float, y: float, width: float, height: float) -> Axes:
        return figure.add_axes((x / wide, 1.0 - (y + height) / high, width / wide, height / high))

    grid, y = [], top
    for row, count in enumerate(lines):
        y += 0.12 + LINE * count
        for column in range(min(columns, len(captions) - row * columns)):
            grid.append(place(LEFT + column * (sheet.width + BETWEEN), y, sheet.width, sheet.height))
        y += sheet.height
    length = min(5.0, high - top - BELOW - 0.3)
    bar = place(wide - RIGHT + 0.25, 0.5 * (top + 0.3 + high - BELOW - length), 0.14, length)
    return figure, grid, bar


def add_colour_bar(figure: Figure | SubFigure, place: Axes, recording: Recording, scenery: Scenery) -> None:
    """Puts the colour bar of the field into axes, with a line at each limit of a quantity that is taken from it."""
    if not scenery.field:
        place.set_visible(False)
        return
    factor, label = scenery.colour
    bar = figure.colorbar(scenery.bar, cax=place, extend=scenery.beyond)
    bar.ax.ticklabel_format(axis="y", useOffset=False)
    bar.set_label(label)
    bar.outline.set_visible(False)
    for name, limit in limit_series(recording).items():
        # Of those that move the first and the last.
        ends = dict.fromkeys(float(bounds[k]) for bounds in limit.values() for k in (0, -1))
        for value in ends if scenery.field.quantity_of(recording, name) else ():
            if scenery.bottom <= value <= scenery.top:
                place.axhline(factor * value, color=REFUSED, lw=1.6)
                look = {"color": REFUSED, "rotation": 90, "fontsize": 7, "ha": "right", "va": "center"}
                place.text(-0.2, factor * value, f"limit of {name}", **look)


def _badness(count: int, columns: int, aspect: float) -> float:
    """How far a sheet is from the proportions 3 : 2, and how many of its places stay empty."""
    rows = ceil(count / columns)
    return abs(np.log(columns * aspect / rows / 1.5)) + 0.35 * (rows * columns - count)


def title_lines(recording: Recording, scenery: Scenery, width: float, letter: float = TITLE_LETTER) -> list[str]:
    """The name of the scene, what is exaggerated, and the meaning of lines, in lines for a figure this wide [inch]."""
    room = int(width / letter)
    parts = [shorten(scene_name(recording), room, placeholder=" …"), scenery.deformation]
    parts += ["dashed: shape at rest"] * bool(scenery.largest) + ["red: goal"] * bool(scenery.goals)
    lines = parts[:1]
    for part in filter(None, parts[1:]):
        if len(lines[-1]) + len(part) + 5 <= room and len(lines) > 1:
            lines[-1] += f"  ·  {part}"
        else:
            lines.append(part)
    return lines


def caption(recording: Recording, i: int, scenery: Scenery, room: int) -> str:
    """What a frame is and shows, in lines of at most `room` letters where that can be."""
    return wrapped([*frame_words(recording, i), *findings(recording, i, scenery)], room)


def findings(recording: Recording, i: int, scenery: Scenery) -> list[str]:
    """What a frame's marks are, and what is wrong with it."""
    found = []
    if scenery.field and scenery.seen.solved[i]:
        found = [f"{mark.letter} {mark.text}" for mark in marks(recording, i, scenery.field, recording.cells(i))]
    if scenery.seen.solved[i]:
        found += singular_words(recording, i)
    why = failure(recording, i, bool(scenery.seen.solved[i]))
    return [*found, *([why] if why else [])]


def scene_name(recording: Recording) -> str:
    """The title of the recorded scene, or the recording's file name."""
    given = recording.header.get("title") or recording.header.get("scene")
    if isinstance(given, dict):
        given = given.get("title")
    return str(given or recording.path.stem)


def wrapped(words: Sequence[str], room: int) -> str:
    """Words with commas between them, in lines of at most `room` letters where that can be."""
    lines = [words[0]]
    for word in words[1:]:
        if len(lines[-1]) + len(word) + 2 <= room:
            lines[-1] += f", {word}"
        else:
            lines[-1] += ","
            lines += wrap(word, room) or [""]
    return "\n".join(lines)


def _label(axes: Axes, scenery: Scenery, bottom: bool, left: bool, fails: bool) -> None:
    _, unit = scenery.unit
    axes.tick_params(length=2, labelbottom=bottom, labelleft=left, color=FAINT)
    axes.set_xlabel(f"x [{unit}]" if bottom else "")
    axes.set_ylabel(f"y [{unit}]" if left else "")
    for spine in axes.spines.values():
        spine.set(color=REFUSED if fails else "#cccccc", linewidth=1.5 if fails else 0.8, visible=True)
