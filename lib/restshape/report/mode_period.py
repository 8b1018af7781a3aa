"""One period of a mode in space, as an animation that begins again and again."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from PIL import Image

from restshape.outputs.atomic_files import replacing
from restshape.outputs.kinds import PICTURE_MARK
from restshape.report.animation import even, write_animation
from restshape.report.bent_plate import FlatBody
from restshape.report.fitted_title import fitted
from restshape.report.space_modes import ModeView, SpaceMode, add_mode_bar, body_drawing, scale_words
from restshape.report.space_scene import SpaceImage
from restshape.report.style import INK, UNTRUSTED, new_figure

PICTURES, SECONDS = 24, 0.06
"""Of a period, and how long each is shown [s]."""
WIDTH, HEAD, BAR, DPI = 6.0, 1.05, 0.65, 90
"""Width of a picture, height of the words above the body and of the colour bar below [inch]; pixels an inch."""


def draw_period(path: Path, body: FlatBody, mode: SpaceMode, frequency: float, title: str) -> None:
    """Draw one period of a mode as an animation, which begins again and again.

    Args:
        path: of a GIF.
        body: at rest; mode: of it.
        frequency: [Hz], for the words; title: of the whole.
    """
    pictures = list(_period(body, mode, frequency, title))
    sample = Image.fromarray(np.concatenate(pictures[:: max(1, len(pictures) // 4)]))
    colours = np.array(sample.quantize(256, dither=Image.Dither.NONE).getpalette(), dtype=np.uint8).reshape(-1, 3)
    palette = np.zeros((256, 3), dtype=np.uint8)
    palette[: len(colours)] = colours
    with replacing(path) as part:
        write_animation(iter(pictures), palette, part, SECONDS, PICTURE_MARK)


def _period(body: FlatBody, mode: SpaceMode, frequency: float, title: str) -> Iterator[np.ndarray]:
    view = ModeView.of(body, [mode], (1.0, -1.0))
    tall = WIDTH * view.slenderness
    high = HEAD + tall + BAR
    figure = new_figure(WIDTH, high)
    figure.set(dpi=DPI, layout_engine="none")
    axes = figure.add_axes((0.0, BAR / high, 1.0, tall / high))
    view.frame(axes)
    image = SpaceImage(axes, view.camera)
    slower = PICTURES * SECONDS * frequency
    words = f"{mode.name}; shown {float(f'{slower:.2g}'):,.10g} times slower"
    figure.text(0.015, 1.0 - 0.08 / high, fitted(title, WIDTH), fontsize=11, va="top")
    figure.text(0.015, 1.0 - 0.32 / high, words, fontsize=9, va="top")
    colour = INK if mode.perpendicular else UNTRUSTED
    figure.text(0.015, 1.0 - 0.52 / high, mode.kind, fontsize=8, color=colour, va="top")
    figure.text(0.015, 1.0 - 0.72 / high, scale_words(body), fontsize=8, va="top")
    add_mode_bar(figure.add_axes((0.2, 0.42 / high, 0.6, 0.11 / high)), mode.perpendicular)
    canvas = FigureCanvasAgg(figure)
    for k in range(PICTURES):
        image.scene = body_drawing(body, mode, float(np.cos(2.0 * np.pi * k / PICTURES)))
        canvas.draw()
        yield even(canvas)
