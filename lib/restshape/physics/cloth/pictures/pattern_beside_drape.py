"""The pattern beside its drape: seams that can be found on both, and strains along warp and weft."""

# More than 15 modules: all that a frame of cloth shows meets here.

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Normalize, to_rgb
from matplotlib.figure import Figure
from matplotlib.text import Text

from restshape.outputs.picture_files import save_picture
from restshape.physics.cloth.pictures.drape import DrapeScenery, drape_scenery
from restshape.physics.cloth.pictures.drape_frames import convergence_words
from restshape.physics.cloth.pictures.drape_image import DrapeImage
from restshape.physics.cloth.pictures.drawn_seams import DrawnSeam, drawn_seams
from restshape.physics.cloth.pictures.membrane_stretch import recorded_stretches, trusted_strain
from restshape.physics.cloth.pictures.text_room import set_apart, set_apart_alike
from restshape.replay.recording.recording import Recording
from restshape.report.fitted_title import fitted
from restshape.report.frames import scene_name
from restshape.report.outlines import border, lines, polygons
from restshape.report.scene_overlay import rebuilt_frames
from restshape.report.style import BODY, DPI, INK, SIGNED, new_figure

WIDTH = 2000
"""Width of the picture, unless another one is given [pixels]."""
ROW = 0.42
"""Height of a row over the width of the picture, at most."""
TITLE, WORDS, BAR = 0.55, 0.4, 0.95
"""Room above all, above each row, and for colour bars [inch]."""
RARE = 0.5
"""Percentage of the triangles whose strain may lie beyond the ends of the colour bar."""
SEAM, EDGE = 2.2, 0.6
"""Widths of seams and of other edges [points]."""
LETTERS = 7.0


@dataclass(frozen=True)
class _Shown:
    """What a row shows: strains (ne,) within plus and minus an end, or None: seams alone."""

    name: str
    strains: np.ndarray | None = None
    end: float = 1.0
    bound: float = 0.05

    @property
    def colours(self) -> np.ndarray | str:
        """Of the triangles, (ne, 3)."""
        if self.strains is None:
            return BODY
        share = 0.5 + 0.5 * np.nan_to_num(self.strains) / self.end
        return colormaps[SIGNED](np.clip(share, 0.0, 1.0))[:, :3]

    @property
    def bound_shown(self) -> bool:
        """Whether the bound lies within the ends."""
        return self.bound <= self.end

    @property
    def words(self) -> str:
        """Its name, and the range of its values."""
        if self.strains is None:
            return self.name
        low, high, beyond = self.strains.min(), self.strains.max(), int((np.abs(self.strains) > self.bound).sum())
        text = f"strain along the {self.name}: {100 * low:.2g} % to {100 * high:.2g} %"
        return f"{text}; beyond {100 * self.bound:g} %: {beyond} of {len(self.strains)} triangles, outlined"


class _SeamedImage(DrapeImage):
    """A drape in given colours, with its seams; arguments as of `DrapeImage`, and what it shows."""

    def __init__(self, axes: Axes, scenery: DrapeScenery, shown: _Shown, seams: Sequence[DrawnSeam]) -> None:
        super().__init__(axes, scenery.from_aside, scenery)
        self.shown, self.seams = shown, seams

    def colours(self, recording: Recording, i: int) -> np.ndarray:
        """Of the triangles, (ne, 3)."""
        found = self.shown.colours
        return np.tile(to_rgb(found), (len(recording.cells(i)), 1)) if isinstance(found, str) else found

    def mark(self, x: np.ndarray) -> None:
        """Draws the seams where they lie in space."""
        for seam in self.seams:
            self.scene.lines(x[seam.sides], seam.colour, SEAM)


def draw_beside(recording: Recording, i: int, what: str, width: int, path: Path) -> None:
    """Draws one frame: the drape in perspective, and beside it the pattern.

    Args:
        recording: of cloth; i: number of the frame.
        what: "strain", along warp and weft, or "pattern", with seams alone.
        width: of the picture [pixels]; path: of it.

    Raises:
        UserError: the recorded scene cannot be read again, such as one whose shape is in a file.
        OSError: it cannot be written.
    """
    frame = rebuilt_frames(recording, [i])[i]
    assert frame.outline is not None, "cloth has an outline"
    scenery = drape_scenery(recording, np.array([i]))
    seams = drawn_seams(frame.scene, frame.outline, *recording.mesh(i))
    rows = [_Shown("seams" if seams else "pattern")]
    if what == "strain":
        found, bound = recorded_stretches(recording, i, frame.scene, frame.outline), trusted_strain(frame.scene)
        rows = strain_rows(found, bound)
    figure, grid = _figure(scenery, len(rows), width / DPI, what == "strain")
    for (space, pattern), shown in zip(grid, rows):
        _draw_space(space, recording, i, scenery, shown, seams)
        seam_names = _draw_pattern(pattern, recording, i, shown, seams)
        top = space.get_position().y1 + 0.02 / figure.get_size_inches()[1]
        figure.text(0.01, top, shown.words, fontsize=8.5, va="bottom", color=INK)
        panels = [
            pattern.text(*place, name, fontsize=LETTERS + 1.0, ha="center", va="center", color=INK)
            for name, place in scenery.names.get(i, {}).items()
        ]
        set_apart_alike(panels)
        along = [np.deg2rad(text.get_rotation()) for text in seam_names]
        set_apart(seam_names, [np.array([np.cos(angle), np.sin(angle)]) for angle in along], panels)
    words, colour = convergence_words(recording, i)
    below = 1.0 - 0.4 / figure.get_size_inches()[1]
    figure.text(
        0.5, below, f"frame {i}, t = {recording.times[i]:.2f} s: {words}", fontsize=8.5, ha="center", color=colour
    )
    if what == "strain":
        _bar(figure, rows[0])
    wide, high = map(float, figure.get_size_inches())
    figure.suptitle(fitted(scene_name(recording), wide, size=10), color=INK, fontsize=10, y=1.0 - 0.12 / high)
    save_picture(figure, path)


def strain_rows(found: Mapping[str, np.ndarray], bound: float) -> list[_Shown]:
    """A row for each direction, with colours up to the largest strain of all but `RARE` of the triangles.

    Args:
        found: strains (ne,) by the name of their direction; bound: up to which they are trusted.
    """
    most = max(float(np.percentile(np.abs(values), 100.0 - RARE)) for values in found.values())
    return [_Shown(name, values, most or bound, bound) for name, values in found.items()]


def _figure(scenery: DrapeScenery, rows: int, wide: float, bar: bool) -> tuple[Figure, list[list[Axes]]]:
    """A figure, and in each row axes of the drape and of the pattern."""
    left, right, bottom, top = scenery.from_aside.window(scenery.low, scenery.high)
    flat = scenery.flat[1] - scenery.flat[0]
    room = wide - BAR * bar
    ratios = (right - left) / (top - bottom), float(flat[0] / flat[1])
    tall = min(room / sum(ratios), ROW * wide)
    high = TITLE + rows * (tall + WORDS)
    figure = new_figure(wide, high)
    figure.set_layout_engine("none")
    share = room / sum(ratios)
    grid = []
    for k in range(rows):
        y = 1.0 - (TITLE + (k + 1) * (tall + WORDS) - 0.1) / high
        x = np.array([0.0, ratios[0] * share, room]) / wide
        grid.append([figure.add_axes((x[j], y, x[j + 1] - x[j], tall / high)) for j in range(2)])
    return figure, grid


def _draw_space(
    axes: Axes, recording: Recording, i: int, scenery: DrapeScenery, shown: _Shown, seams: Sequence[DrawnSeam]
) -> None:
    left, right, bottom, top = scenery.from_aside.window(scenery.low, scenery.high)
    axes.set(xlim=(left, right), ylim=(bottom, top), aspect="equal")
    axes.set_axis_off()
    _SeamedImage(axes, scenery, shown, seams).show(recording, i)


def _draw_pattern(axes: Axes, recording: Recording, i: int, shown: _Shown, seams: Sequence[DrawnSeam]) -> list[Text]:
    """The flat pattern in the colours of the drape, with triangles beyond the bound outlined; the names of seams."""
    X, cells = recording.mesh(i)
    low, high = X.min(axis=0), X.max(axis=0)
    room = 0.03 * float(max(high - low))
    axes.set(xlim=(low[0] - room, high[0] + room), ylim=(low[1] - room, high[1] + room), aspect="equal")
    axes.set_axis_off()
    axes.add_collection(PolyCollection(polygons(X, cells), facecolors=shown.colours, antialiaseds=False))
    if shown.strains is not None:
        beyond = polygons(X, cells[np.abs(shown.strains) > shown.bound])
        axes.add_collection(PolyCollection(beyond, facecolors="none", edgecolors=INK, linewidths=0.4))
    axes.add_collection(LineCollection(lines(X, border(cells)), colors=INK, linewidths=EDGE))
    names = []
    for seam in seams:
        axes.add_collection(LineCollection(seam.edges, colors=seam.colour, linewidths=SEAM))
        for name in seam.names:
            look = {"rotation": np.degrees(name.angle), "rotation_mode": "anchor", "ha": "center", "va": "center"}
            place = name.place + 0.45 * room * name.outward
            names.append(axes.text(*place, seam.name, fontsize=LETTERS, color=seam.colour, **look))
    return names


def _bar(figure: Figure, shown: _Shown) -> None:
    """The colour bar of strains, with the bound marked on both sides of zero."""
    wide = float(figure.get_size_inches()[0])
    place = figure.add_axes((1.0 - (BAR - 0.1) / wide, 0.25, 0.16 / wide, 0.5))
    scale = 100.0 * shown.end
    bar = figure.colorbar(ScalarMappable(Normalize(-scale, scale), SIGNED), cax=place, extend="both")
    for sign in (-1.0, 1.0) if shown.bound_shown else ():
        bar.ax.axhline(sign * 100.0 * shown.bound, color=INK, linewidth=1.2)
    marked = f"; lines: {100.0 * shown.bound:g} %" if shown.bound_shown else ""
    bar.set_label(f"eased below 0, in tension above [%]{marked}")
    bar.outline.set_visible(False)
