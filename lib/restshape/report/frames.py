"""The contact sheet: some frames of a recording side by side, deformed shape in the colours of its stress."""

from math import ceil
from pathlib import Path
from textwrap import shorten

import numpy as np
from matplotlib.figure import Figure

from restshape.outputs.drawn import save_picture
from restshape.replay.recording import Recording
from restshape.report.scenery import Drawing, Scenery
from restshape.report.style import FAINT, INK, REFUSED, new_figure
from restshape.report.tables import column, refused, with_values

WIDTH = 9.5
NARROWEST = 1.2
"""Width of a panel [inch] below which not even half a caption fits."""
LETTER = 0.066
"""Width of a letter of a caption [inch]."""
LINE = 0.15
"""Height of a line of a caption [inch]."""


def chosen_frames(recording: Recording, count: int) -> np.ndarray:
    """Indices of at most ``count`` frames, first and last too, spread over those that were analysed and not refused."""
    good = np.flatnonzero(~refused(recording) & (column(recording, "residual") >= 0.0))
    good = good if len(good) else np.flatnonzero(~refused(recording))
    good = good if len(good) else np.arange(recording.n)
    return good[np.unique(np.linspace(0, len(good) - 1, min(count, len(good))).round().astype(int))]


def draw_frames(recording: Recording, chosen: np.ndarray, scenery: Scenery, path: Path) -> None:
    """Writes the contact sheet as a PNG.

    Args:
        recording: of a shape in the plane.
        chosen: frames to show.
        scenery: scale, extent and colours.
        path: of the picture.
    """
    xmin, xmax, ymin, ymax = scenery.extent
    rows, columns, width, height = layout(len(chosen), (xmax - xmin) / (ymax - ymin))
    room = int((width - 1.5) / columns / LETTER)
    captions = [_caption(recording, int(i), room) for i in chosen]
    lines = max(caption.count("\n") for caption in captions)
    figure = new_figure(width, height + rows * LINE * lines)
    grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    drawing = None
    for k, axes in enumerate(grid.ravel()):
        if k >= len(chosen):
            axes.set_visible(False)
            continue
        drawing = Drawing(axes, scenery)
        drawing.show(recording, int(chosen[k]))
        axes.set_title(captions[k], loc="left", pad=3)
        _label(axes, scenery, bottom=k + columns >= len(chosen), left=k % columns == 0)
    title(figure, recording, scenery)
    if scenery.field and drawing:
        bar = figure.colorbar(
            drawing.body, ax=grid, extend="max" if scenery.clipped else "neither", aspect=40, pad=0.015, fraction=0.03
        )
        bar.set_label(scenery.colour[1])
        bar.outline.set_visible(False)
    save_picture(figure, path)


def layout(count: int, aspect: float) -> tuple[int, int, float, float]:
    """Rows, columns, width and height [inch] of a sheet for panels of this aspect ratio (width / height)."""
    most = min(count, int((WIDTH - 1.5) / NARROWEST))
    best = min(range(1, most + 1), key=lambda columns: _badness(count, columns, aspect))
    rows = ceil(count / best)
    width = WIDTH if best > 1 or aspect > 1 else 6.0
    panel = (width - 1.5) / best
    height = rows * (panel / aspect + 0.22) + 0.75
    return rows, best, width, float(np.clip(height, 2.8, 14.0))


def _badness(count: int, columns: int, aspect: float) -> float:
    """How far a sheet is from the proportions 3 : 2, and how many of its places stay empty."""
    rows = ceil(count / columns)
    return abs(np.log(columns * aspect / rows / 1.5)) + 0.35 * (rows * columns - count)


def title(figure: Figure, recording: Recording, scenery: Scenery, size: float = 11) -> None:
    """Puts the name of the scene and what is exaggerated above a figure, and the meaning of the thin line."""
    room = int(110 * figure.get_figwidth() / size)
    meaning = f"{scenery.deformation}   ·   thin line: rest outline" if scenery.largest else scenery.deformation
    meaning += "   ·   red: goal" * bool(scenery.goals)
    name = shorten(scene_name(recording), room, placeholder=" …")
    gap = "   ·   " if len(name) + len(meaning) + 7 <= room else "\n"
    gap *= bool(meaning)
    figure.suptitle(name + gap + meaning, color=INK, fontsize=size)


def scene_name(recording: Recording) -> str:
    """The title of the recorded scene, or the recording's file name."""
    given = recording.header.get("title") or recording.header.get("scene")
    if isinstance(given, dict):
        given = given.get("title")
    return str(given or recording.path.stem)


def _caption(recording: Recording, i: int, room: int) -> str:
    """What a frame is, in lines of at most `room` letters where that can be."""
    table = recording.table
    words = [f"frame {i}", *recording.moments(i)]
    if "level" in table:
        still = "values" if with_values(recording)[i] else "idle"
        words.append(f"level {table['level'][i]}" if table["level"][i] else still)
    if refused(recording)[i]:
        words[-1] += " (refused)"
    text = words[0]
    for word in words[1:]:
        whole = len(text) - text.rfind("\n") + len(word) + 1 <= room
        text += (", " if whole else "\n") + word
    return text


def _label(axes, scenery: Scenery, bottom: bool, left: bool) -> None:
    _, unit = scenery.unit
    axes.tick_params(length=2, labelbottom=bottom, labelleft=left, color=FAINT)
    axes.set_xlabel(f"x [{unit}]" if bottom else "")
    axes.set_ylabel(f"y [{unit}]" if left else "")
    for spine in axes.spines.values():
        spine.set_color("#cccccc")
    if "(refused)" in axes.get_title(loc="left"):
        axes.title.set_color(REFUSED)
