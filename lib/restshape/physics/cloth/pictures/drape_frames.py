"""The contact sheet and the animation of cloth: each frame in space, from above, and as a flat pattern."""

# More than 15 modules: all that a frame of cloth shows meets here.

from __future__ import annotations

from argparse import Namespace
from collections.abc import Iterator, Sequence
from math import ceil
from pathlib import Path
from textwrap import shorten, wrap

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.text import Text

from restshape.outputs.picture_files import save_picture
from restshape.physics.cloth.pictures.drape import COLOURS, TENSION, DrapeScenery, drape_scenery, places
from restshape.physics.cloth.pictures.drape_image import BODY, DrapeImage
from restshape.physics.cloth.pictures.text_room import set_apart_alike
from restshape.replay.recording.recording import Recording
from restshape.report.animation import animated_frames, even, pause, write_animation
from restshape.report.camera import Camera
from restshape.report.frames import LETTER, LINE, TITLE_LETTER, TITLE_LINE, scene_name
from restshape.report.happenings import chosen_frames, failure, texts
from restshape.report.outlines import border, lines, polygons
from restshape.report.space_axes import draw_box, marks
from restshape.report.style import BODY as PLAIN
from restshape.report.style import INK, REFUSED, UNTRUSTED, new_figure
from restshape.report.tables import column, refused

WIDTH, ALONE = 9.5, 5.5
"""Width of a sheet, and of one with a single frame [inch]."""
ACROSS = 3
"""Most frames side by side."""
LEFT, RIGHT, BELOW, ABOVE = 0.25, 0.13, 0.17, 0.02
"""Room for numbers around the box, over its width in the picture."""
BAR, TITLE, CAPTION, UNDER, NUMBERS, BETWEEN = 1.05, 0.45, 0.42, 0.5, 0.68, 0.3
"""Room for the colour bar, above all, above and below each frame, and before and after the view from above [inch]."""
EACH_X, EACH_Y = 0.42, 0.2
"""Least room for each number along the sides of the view from above [inch]."""
PATTERN = 0.6
"""Scale of the flat pattern over that of the view from above."""
ANIMATED_DPI = 90
PINNED = {"ls": "", "marker": "o", "ms": 3.5, "mfc": "white", "mec": REFUSED, "mew": 1.0, "zorder": 6, "clip_on": False}
"""Marks on what supports hold."""


class DrapeDrawing:
    """The artists of one frame, used again from frame to frame.

    Args:
        panels: axes of the view in perspective, of that from above, and of the flat pattern.
        scenery: common to all frames.
    """

    def __init__(self, panels: Sequence[Axes], scenery: DrapeScenery) -> None:
        self.scenery = scenery
        space, above, pattern = panels
        factor, unit = scenery.unit
        camera = scenery.from_aside
        left, right, bottom, top = camera.window(scenery.low, scenery.high)
        width = right - left
        space.set(xlim=(left - LEFT * width, right + RIGHT * width), aspect="equal")
        space.set_ylim(bottom - BELOW * width, top + ABOVE * width)
        space.set_axis_off()
        from_side = DrapeImage(space, camera, scenery)
        draw_box(from_side.still, space, camera, scenery.low, scenery.high, factor, unit)
        flat = (scenery.low[0], scenery.high[0], scenery.low[1], scenery.high[1])
        above.set(xlim=(factor * flat[0], factor * flat[1]), ylim=(factor * flat[2], factor * flat[3]))
        above.set(aspect="equal", anchor="SW")
        above.set_xlabel(f"x [{unit}]", fontsize=8)
        above.set_ylabel(f"y [{unit}]", fontsize=8)
        above.tick_params(length=2, labelsize=7)
        place, (wide, high) = above.get_position(), above.figure.get_size_inches()
        above.set_xticks(factor * marks(*flat[:2], factor, int(np.clip(wide * place.width / EACH_X, 2, 4))))
        above.set_yticks(factor * marks(*flat[2:], factor, int(np.clip(high * place.height / EACH_Y, 2, 4))))
        self.images = from_side, DrapeImage(above, Camera.above(), scenery, factor)
        self.constrained = [axes.plot([], [], **PINNED)[0] for axes in panels]
        self._add_pattern(pattern)

    def _add_pattern(self, axes: Axes) -> None:
        scenery = self.scenery
        (left, bottom), (right, top) = scenery.flat
        room = 0.02 * max(right - left, top - bottom)
        axes.set(xlim=(left - room, right + room), ylim=(bottom - room, top + room), aspect="equal", anchor="SW")
        axes.set(xticks=(), yticks=())
        for spine in axes.spines.values():
            spine.set_visible(False)
        self.size = axes.set_xlabel("", fontsize=7.5)
        self.body = PolyCollection([], antialiaseds=False, facecolors=PLAIN)
        self.body.set_cmap(colormaps[COLOURS].with_extremes(bad=PLAIN))
        colour, _ = scenery.colour
        self.body.set_clim(scenery.bottom * colour, scenery.top * colour)
        self.rest = LineCollection([], colors=INK, linewidths=0.5)
        self.pattern, self.names = axes, dict[str, Text]()
        for artist in (self.body, self.rest):
            axes.add_collection(artist, autolim=False)

    def show(self, recording: Recording, i: int) -> None:
        """Put frame i into the artists."""
        for image in self.images:
            image.show(recording, i)
        X, cells = recording.mesh(i)
        self.body.set_verts(polygons(X, cells))
        self.body.set_array(np.ma.masked_invalid(self.scenery.colour[0] * recording.field(i, TENSION)))
        self.rest.set_segments(lines(X, border(cells)))
        self._name_panels(i)
        self._mark_pins(recording, i)
        factor, unit = self.scenery.unit
        width, height = factor * np.ptp(X, axis=0)
        self.size.set_text(f"flat pattern\n{width:.4g} × {height:.4g} {unit}")

    def _name_panels(self, i: int) -> None:
        """Put the names of panels onto them in the flat pattern."""
        for name, place in self.scenery.names.get(i, {}).items():
            if name not in self.names:
                self.names[name] = self.pattern.text(0, 0, name, ha="center", va="center", color=INK)
            self.names[name].set(position=(float(place[0]), float(place[1])), fontsize=6.5)
        set_apart_alike(list(self.names.values()))

    def _mark_pins(self, recording: Recording, i: int) -> None:
        """Put marks on the nodes that supports hold in frame i, in each of the views."""
        constrained = self.scenery.pins.get(i, [])
        x, X = places(recording, i)[constrained], recording.points(i)[constrained]
        views = [image.factor * image.camera.project(x) for image in self.images]
        for marked, at in zip(self.constrained, [*views, X]):
            marked.set_data(*at.T)


def convergence_words(recording: Recording, i: int) -> tuple[str, str]:
    """What is known of a frame's equilibrium, and the colour to say it in: black alone where it can be trusted."""
    rests, stays = column(recording, "converged")[i], column(recording, "tangent_positive_definite")[i]
    residual = column(recording, "residual")[i]
    size = f"residual {residual:.0e}" if np.isfinite(residual) else ""
    if refused(recording)[i]:
        return failure(recording, i), REFUSED
    why = texts(recording, "untrusted")[i]
    doubts = f"; NOT TRUSTED: {why}" if why else ""
    if column(recording, "predicted", 0.0)[i] == 1:
        off = column(recording, "estimate")[i]
        away = f", about {100.0 * off:.2g} % off" if np.isfinite(off) else ""
        return f"predicted, not solved{away}{doubts}", UNTRUSTED if doubts else INK
    if rests == 0:
        return f"NOT CONVERGED, {size}".rstrip(", ") + doubts, REFUSED
    if rests == 1 and stays == 0:
        return f"converged, but not stable, {size}{doubts}", REFUSED
    words = f"converged{' and stable' if stays == 1 else ''}, {size}".rstrip(", ") if rests == 1 else size
    return words + doubts, UNTRUSTED if doubts else INK


def draw_drape(recording: Recording, options: Namespace, still: Path, moving: Path | None) -> None:
    """Draws cloth in space: some frames, and an animation if it has a path.

    Args:
        recording: of cloth.
        options: of `restshape report`; its frames, by their numbers in `at` where these are given.
        still, moving: paths of the pictures.
    """
    usual, animated = chosen_frames(recording, options.frames), animated_frames(recording)
    shown = np.array(options.at) if options.at else usual
    common = drape_scenery(recording, np.unique([*usual, *shown, *(animated if moving else ())]))
    draw_drape_frames(recording, shown, common, still)
    if moving:
        draw_drape_animation(recording, animated, common, moving)


def draw_drape_frames(recording: Recording, chosen: np.ndarray, scenery: DrapeScenery, path: Path) -> None:
    """Writes the contact sheet as a PNG.

    Args:
        recording: of cloth.
        chosen: frames to show.
        scenery: box and colours.
        path: of the picture.
    """
    across = min(ACROSS, len(chosen))
    down = ceil(len(chosen) / across)
    wide = WIDTH if across > 1 else ALONE
    captions = [_caption(recording, int(i), (wide - BAR) / across) for i in chosen]
    figure, grid = _sheet(scenery, across, down, max(text.count("\n") for text, _ in captions))
    for i, panels, (text, colour) in zip(map(int, chosen), grid, captions):
        drawing = DrapeDrawing(panels, scenery)
        drawing.show(recording, i)
        panels[0].set_title(text, loc="left", pad=3, color=colour)
    for panels in grid[len(chosen) :]:
        for axes in panels:
            axes.set_visible(False)
    _legend(figure, recording, scenery, drawing)
    save_picture(figure, path)


def _caption(recording: Recording, i: int, wide: float) -> tuple[str, str]:
    """What stands above a frame, in lines for a panel this wide [inch], and its colour."""
    words, colour = convergence_words(recording, i)
    for unit in ("%", "mm"):
        # No line begins with the unit of the number before it.
        words = words.replace(f" {unit}", f"\N{NO-BREAK SPACE}{unit}")
    lines = [f"frame {recording.number(i)}, t = {recording.times[i]:.2f} s", *wrap(words, int(wide / LETTER) - 1)]
    return "\n".join(f" {line}" for line in lines), colour


def _sheet(scenery: DrapeScenery, across: int, down: int, more: int = 1) -> tuple[Figure, list[list[Axes]]]:
    """A figure, and for each frame the axes in perspective, from above, and of the flat pattern.

    Captions have `more` lines than one.
    """
    left, right, bottom, top = scenery.from_aside.window(scenery.low, scenery.high)
    wide = WIDTH if across > 1 else ALONE
    each = (wide - BAR) / across
    tall = each * ((top - bottom) / (right - left) + BELOW + ABOVE) / (1.0 + LEFT + RIGHT)
    above, flat = (scenery.high - scenery.low)[:2], PATTERN * (scenery.flat[1] - scenery.flat[0])
    scale = min((each - NUMBERS - 1.5 * BETWEEN) / (above[0] + flat[0]), 0.8 * each / max(above[1], flat[1]))
    low = scale * max(above[1], flat[1])
    caption = CAPTION + LINE * max(more - 1, 0)
    band = caption + tall + low + UNDER
    title = TITLE + TITLE_LINE * (len(_drawn(scenery, wide)) - 1)
    high = title + down * band
    figure = new_figure(wide, high)
    figure.set_layout_engine("none")

    def place(x: float, y: float, width: float, height: float) -> Axes:
        return figure.add_axes((x / wide, 1.0 - (y + height) / high, width / wide, height / high))

    frames = []
    for k in range(across * down):
        x, y = k % across * each, title + k // across * band + caption
        ground = y + tall + low
        frames.append(
            [
                place(x, y, each, tall),
                place(x + NUMBERS, ground - scale * above[1], *(scale * above)),
                place(x + NUMBERS + scale * above[0] + BETWEEN, ground - scale * flat[1], *(scale * flat)),
            ]
        )
    return figure, frames


def _legend(figure: Figure, recording: Recording, scenery: DrapeScenery, drawing: DrapeDrawing) -> None:
    """The colour bar, and the name of the scene with what is drawn."""
    wide, high = map(float, figure.get_size_inches())
    length = min(0.6 * (high - TITLE), 4.0)
    bottom = 1.0 - (TITLE + CAPTION + length) / high
    place = figure.add_axes((1.0 - (BAR - 0.15) / wide, bottom, 0.14 / wide, length / high))
    bar = figure.colorbar(drawing.body, cax=place, extend=scenery.extend)
    bar.ax.ticklabel_format(axis="y", useOffset=False)
    bar.set_label(scenery.colour[1])
    bar.outline.set_visible(False)
    name = shorten(scene_name(recording), 60, placeholder=" …")
    figure.suptitle("\n".join([name, *_drawn(scenery, wide)]), color=INK, fontsize=10, y=1.0 - 0.08 / high)


def _drawn(scenery: DrapeScenery, wide: float) -> list[str]:
    """What there is to see, in lines for a figure this wide [inch]."""
    drawn = "true places, in perspective and from above"
    drawn += "; dashes: body behind cloth" * scenery.bodies
    drawn += "; circles: supports" * any(map(len, scenery.pins.values()))
    return wrap(drawn, int(wide / TITLE_LETTER))


def draw_drape_animation(recording: Recording, chosen: np.ndarray, scenery: DrapeScenery, path: Path) -> None:
    """Writes the animation; the suffix of the path says which kind.

    Args:
        recording: of cloth.
        chosen: frames to draw.
        scenery: box and colours.
        path: ``.gif`` or ``.mp4``.

    Raises:
        UserError: MP4 without ffmpeg, or ffmpeg failed.
    """
    write_animation(_pictures(recording, chosen, scenery), _palette(), path, pause(recording, chosen))


def _pictures(recording: Recording, chosen: np.ndarray, scenery: DrapeScenery) -> Iterator[np.ndarray]:
    """RGB pictures (height, width, 3) uint8, both sizes even."""
    captions = {i: _caption(recording, i, ALONE) for i in map(int, chosen)}
    figure, (panels,) = _sheet(scenery, 1, 1, max(text.count("\n") for text, _ in captions.values()))
    figure.set_dpi(ANIMATED_DPI)
    canvas = FigureCanvasAgg(figure)
    drawing = DrapeDrawing(panels, scenery)
    caption = panels[0].set_title(" ", loc="left")
    _legend(figure, recording, scenery, drawing)
    for i, (text, colour) in captions.items():
        drawing.show(recording, i)
        caption.set_text(text)
        caption.set_color(colour)
        canvas.draw()
        yield even(canvas)


def _palette() -> np.ndarray:
    """256 colours: the map's in several lights, the bodies' over it and over white, greys."""
    shades = colormaps[COLOURS](np.linspace(0, 1, 36))[:, :3]
    lit = np.vstack([light * shades for light in np.linspace(0.45, 1.0, 5)])
    body = np.linspace(0.4, 1.0, 12)[:, None] * BODY
    over = np.vstack([0.6 * body + 0.4 * white for white in (1.0, 0.4)])
    greys = np.repeat(np.linspace(0, 1, 256 - len(lit) - len(over) - 3)[:, None], 3, axis=1)
    colours = np.vstack([lit, over, greys, to_rgb(PLAIN), to_rgb(REFUSED), to_rgb(UNTRUSTED)])
    return (255 * colours).round().astype(np.uint8)
