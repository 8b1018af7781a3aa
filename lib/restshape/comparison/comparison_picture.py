"""The picture of two results: their quantities over the frames, and their fields side by side."""

# More than 15 modules: quantities are drawn as in reports, and fields as in frames.

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from textwrap import shorten

import numpy as np
from matplotlib.figure import SubFigure

from restshape.comparison.result import Result
from restshape.comparison.result_comparison import Compared
from restshape.errors import UserError
from restshape.outputs.picture_files import save_picture
from restshape.outputs.si_numbers import scaled_unit, si
from restshape.replay.recording.recording import Recording
from restshape.replay.singular_notes import marked
from restshape.report.drawing import Drawing
from restshape.report.field import own_pictures, shown_field
from restshape.report.frame_axis import frame_axis
from restshape.report.frames import LETTER, add_colour_bar, findings, wrapped
from restshape.report.quantity_panels import EACH, FRAMED, least_span
from restshape.report.scenery import Scenery, scale_text, scenery
from restshape.report.style import INK, LEVELS, new_figure

MOST = 8
"""Quantities in the picture, those that differ most."""
WIDTH, PANEL, HIGHEST = 10.0, 4.0, 5.0
"""Width of the figure and of a panel of fields, and the largest height of such a panel [inch]."""
CAPTION = 4.2
"""Width of what stands above a panel of fields [inch]."""
SECOND = LEVELS[3]
"""Colour of the second result."""


def draw_comparison(first: Result, second: Result, found: Compared, path: Path) -> bool:
    """Writes the picture, in the format that the path's suffix names; False, and no picture, with nothing to draw.

    Raises:
        UserError: a file is there that restshape has not drawn.
        OSError: it cannot be written.
    """
    ordered = sorted(found.quantities, key=lambda one: -one.relative)
    names = [one.name for one in ordered[:MOST]]
    frame = shown_frame(found)
    sceneries = _sceneries(first.recording, second.recording, frame)
    if not names and not sceneries:
        return False
    high = [FRAMED + EACH * len(names)] * bool(names) + [_height(one) for one in sceneries[:1]]
    figure = new_figure(WIDTH, sum(high))
    parts = list(figure.subfigures(len(high), 1, height_ratios=high, squeeze=False)[:, 0])
    if names:
        _draw_quantities(parts[0], names, first, second, frame)
    if first.recording and second.recording and sceneries:
        _draw_fields(parts[-1], (first.recording, second.recording), sceneries, frame)
    pairs = ", frames of one number at other simulated times" if found.apart else ""
    titles = [f"{_name(first.path)} and {_name(second.path)}: {found.outcome}{pairs}", fields_title(sceneries)]
    for part, title in zip(parts, titles if len(parts) > 1 else ["\n".join(filter(None, titles))]):
        part.suptitle(title, x=0.01, ha="left", color=INK)
    save_picture(figure, path)
    return True


def shown_frame(found: Compared) -> int:
    """The frame in which the fields differ most, else the quantities; the last one where neither does."""
    candidates = [*(found.fields.fields if found.fields else ()), *found.quantities]
    differing = [one for one in candidates if one.frame >= 0]
    by_field = [one for one in differing if found.fields and one in found.fields.fields]
    most = max(by_field or differing, key=lambda one: one.largest / one.scale if one.scale else 0.0, default=None)
    return most.frame if most else min(found.frames) - 1


def _draw_quantities(part: SubFigure, names: Sequence[str], first: Result, second: Result, frame: int) -> None:
    """A panel a quantity, with both results and a line at the frame whose fields are shown."""
    panels = part.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
    for axes, name in zip(panels, names):
        both = first.quantities[name], second.quantities[name]
        known = np.concatenate(both)
        known = known[np.isfinite(known)]
        unit = first.units.get(name) or second.units.get(name, "")
        factor, text = scaled_unit(float(np.abs(known).max(initial=0.0)), unit)
        for values, colour, line, result in zip(both, (INK, SECOND), ("-", "--"), (first, second)):
            frames = np.arange(len(values))
            axes.plot(
                frames, factor * values, marker=".", ms=3, color=colour, lw=1.2, ls=line, label=_name(result.path)
            )
        axes.axvline(frame, color="#cccccc", lw=0.8, zorder=0)
        axes.set_title(shorten(marked(name, first.singular | second.singular), 80), loc="left", pad=2)
        axes.set_ylabel(f"[{text}]" if text else "")
        axes.ticklabel_format(axis="y", useOffset=False)
        if len(known):
            least_span(axes, factor * float(known.min()), factor * float(known.max()))
    frame_axis(panels[-1], max(len(one.quantities[name]) for one in (first, second) for name in names))
    part.align_ylabels()
    part.legend(*panels[0].get_legend_handles_labels(), loc="outside upper right", ncols=2)


def _height(common: Scenery) -> float:
    """Height of the part of the figure that shows fields [inch]."""
    xmin, xmax, ymin, ymax = common.extent
    return FRAMED + min(PANEL * (ymax - ymin) / (xmax - xmin), HIGHEST)


def _draw_fields(part: SubFigure, recordings: Sequence[Recording], sceneries: Sequence[Scenery], frame: int) -> None:
    """The fields of a frame of both recordings, with one colour bar, and what is exaggerated and marked."""
    *panels, bar = part.subplots(1, 3, width_ratios=(1.0, 1.0, 0.03))
    for axes, recording, common in zip(panels, recordings, sceneries):
        drawing = Drawing(axes, common)
        drawing.show(recording, frame)
        for artist in drawing.artists:
            # Else the layout takes what they are before they are drawn for their size.
            artist.set_in_layout(False)
        axes.set_title(_caption(recording, frame, common), loc="left", pad=3)
        axes.set(xlabel=f"x [{common.unit[1]}]", ylabel=f"y [{common.unit[1]}]" if axes is panels[0] else "")
    add_colour_bar(part, bar, recordings[0], sceneries[0])


def fields_title(sceneries: Sequence[Scenery]) -> str:
    """What is exaggerated in panels of one scale, and what dashes are; empty where nothing deforms."""
    if not any(one.deforms and one.largest for one in sceneries):
        return ""
    scale = sceneries[0].scale
    how = "true deformation" if scale == 1.0 else f"deformation ×{scale_text(scale)}"
    goals = "  ·  red: goal" if any(one.goals for one in sceneries) else ""
    return f"{how} in both  ·  dashed: shape at rest{goals}"


def _caption(recording: Recording, frame: int, common: Scenery) -> str:
    """Whose frame a panel shows and when it is, its largest displacement, and what its rings mark."""
    words = [_name(recording.path), f"frame {frame}", *recording.moments(frame)]
    largest = float(common.seen.largest[frame])
    words += [f"largest displacement {si(largest, 'm')}"] * bool(common.deforms and np.isfinite(largest))
    return wrapped([*words, *findings(recording, frame, common)], int(CAPTION / LETTER))


def _sceneries(first: Recording | None, second: Recording | None, frame: int) -> list[Scenery]:
    """The looks of both recordings with the same extent, exaggeration and colours; none where they cannot be drawn."""
    both = [one for one in (first, second) if one]
    drawable = len(both) == 2 and all(one.dimension == 2 and one.n > frame >= 0 for one in both)
    if not drawable or any(own_pictures(one) for one in both):
        return []
    shown = shown_field(both[0])
    try:
        looks = [scenery(one, field=shown.name if shown else None) for one in both]
    except UserError:
        # The second one does not have the field.
        return []
    ends = [one.extent for one in looks]
    extent = (min(e[0] for e in ends), max(e[1] for e in ends), min(e[2] for e in ends), max(e[3] for e in ends))
    bottom, top = min(one.bottom for one in looks), max(one.top for one in looks)
    scale = 1.0 if any(one.exact for one in looks) else min(one.scale for one in looks)
    return [replace(one, extent=extent, bottom=bottom, top=top, scale=scale) for one in looks]


def _name(path: Path) -> str:
    return shorten(path.name, 36, placeholder="…")
