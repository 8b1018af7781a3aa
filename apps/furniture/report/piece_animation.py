"""The animation of furniture: each frame in space, with its joints, its forces and its range."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from restshape_apps.furniture.report.furniture import FOOT, add_utilisation_bar, bounds, draw_piece, slenderness
from restshape_apps.furniture.report.piece_frames import FEW, MOST_LINES, caption, pieces, shown_piece
from restshape_apps.furniture.report.status_colour import BEYOND, DOUBT

from restshape.replay.recording.recording import Recording
from restshape.report.animation import even, pause, write_animation
from restshape.report.space_scene import AMBIENT
from restshape.report.style import BODY, COLOURS, REFUSED, new_figure

WIDTH, BAR, TITLE, DPI = 5.6, 0.9, 1.0, 90
"""Width of a picture, of it the colour bar, and room for the title [inch]; pixels an inch."""


def draw_piece_animation(recording: Recording, chosen: np.ndarray, path: Path) -> None:
    """Writes the animation; the suffix of the path says which kind.

    Args:
        recording: of furniture.
        chosen: frames to draw.
        path: ``.gif`` or ``.mp4``.

    Raises:
        UserError: MP4 without ffmpeg, or ffmpeg failed.
    """
    write_animation(_pictures(recording, chosen), _palette(), path, pause(recording, chosen))


def _pictures(recording: Recording, chosen: np.ndarray) -> Iterator[np.ndarray]:
    """RGB pictures (height, width, 3) uint8, both sizes even; they are laid out once."""
    frames = list(pieces(recording, chosen.tolist()))
    made = [shown_piece(recording, frame) for frame in frames]
    box = bounds(*(furniture.piece for furniture, _, _ in made))
    numbers = max(len(furniture.piece.planks) for furniture, _, _ in made) <= FEW
    figure = new_figure(WIDTH, TITLE + (WIDTH - BAR) * slenderness(*box))
    figure.set_dpi(DPI)
    canvas = FigureCanvasAgg(figure)
    axes = figure.subplots()
    add_utilisation_bar(figure, axes)
    figure.get_layout_engine().set(h_pad=0.1, w_pad=0.06)
    # All pictures in the same view, which is known when all have been drawn.
    views = []
    for furniture, direction_view, case in made:
        axes.clear()
        draw_piece(axes, furniture, "", direction_view, case, numbers, box)
        views.append([*axes.get_xlim(), *axes.get_ylim()])
    left, _, bottom, _ = np.min(views, axis=0)
    _, right, _, top = np.max(views, axis=0)
    for frame, (furniture, direction_view, case) in zip(frames, made):
        axes.clear()
        push = furniture.piece.pushes[case - 1].name if case else ""
        words, colour = caption(recording, frame.index, push)
        # As many lines in each frame: nothing jumps.
        words += "\n" * (MOST_LINES - words.count("\n") - 1)
        draw_piece(axes, furniture, words, direction_view, case, numbers, box)
        axes.set_title(words, fontsize=8, loc="left", color=colour)
        axes.set(xlim=(left, right), ylim=(bottom, top))
        if frame is frames[0]:
            # Titles are above what equal scales have made of the axes, which the second layout knows.
            figure.draw_without_rendering()
            figure.draw_without_rendering()
            figure.set_layout_engine("none")
        canvas.draw()
        yield even(canvas)


def _palette() -> np.ndarray:
    """256 colours: the map's, those of planks in several lights, of arrows and words over white, greys."""
    shades = colormaps[COLOURS](np.linspace(0, 1, 90))[:, :3]
    planks = np.linspace(AMBIENT, 1.0, 60)[:, None] * np.array(to_rgb(BODY))
    parts = np.linspace(0.15, 1.0, 16)[:, None]
    mixed = np.vstack([parts * np.array(to_rgb(colour)) + 1.0 - parts for colour in (FOOT, REFUSED, BEYOND, DOUBT)])
    greys = np.repeat(np.linspace(0, 1, 256 - len(shades) - len(planks) - len(mixed))[:, None], 3, axis=1)
    return (255 * np.vstack([shades, planks, mixed, greys])).round().astype(np.uint8)
