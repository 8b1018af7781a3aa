"""A picture of mannequins from the front and from the left, with their measures at the levels where they hold."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from restshape.outputs.picture_files import save_picture
from restshape.physics.cloth.mannequin.body_shape import LEVELS
from restshape.physics.cloth.mannequin.mannequin_surface import Mannequin
from restshape.report.camera import Camera
from restshape.report.space_scene import SpaceImage
from restshape.report.style import INK, new_figure

COLOUR = np.array([0.78, 0.72, 0.64])
TALL, TITLE = 4.6, 0.35
"""Height of each view, and of the words above it [inch]."""
ROOM = 0.04
"""Margin around a body [m]."""
WORDS = 0.8
"""Width of what is written beside a body [m]."""


def draw(bodies: Sequence[Mannequin], path: Path) -> None:
    """Draws bodies side by side, at one scale."""
    boxes = [(body.nodes.min(axis=0), body.nodes.max(axis=0)) for body in bodies]
    tall = max(high[2] for _, high in boxes) + 2 * ROOM
    views = [
        one
        for body, (low, high) in zip(bodies, boxes)
        for one in (
            (body, -0.5 * np.pi, low[0] - ROOM, high[0] + WORDS),
            (body, 0.0, low[1] - ROOM, high[1] + ROOM),
        )
    ]
    widths = [(right - left) * TALL / tall for _, _, left, right in views]
    figure = new_figure(sum(widths), TALL + TITLE)
    figure.set_layout_engine("none")
    place = 0.0
    for (body, azimuth, left, right), width in zip(views, widths):
        axes = figure.add_axes((place / sum(widths), 0.0, width / sum(widths), TALL / (TALL + TITLE)))
        place += width
        axes.set(xlim=(left, right), ylim=(-ROOM, tall - ROOM), aspect="equal")
        axes.set_axis_off()
        image = SpaceImage(axes, Camera.towards(np.zeros(3), azimuth, 0.0))
        image.scene.surface(body.nodes, body.triangles, COLOUR, edges=(INK, 0.12))
        if azimuth:
            _write_measures(axes, body)
    save_picture(figure, path)


def _write_measures(axes: Axes, body: Mannequin) -> None:
    words = {"ha": "left", "va": "center", "fontsize": 7, "color": INK}
    right = float(body.nodes[:, 0].max())
    for name in LEVELS:
        level, value = body.level(name), getattr(body.sizes, name)
        axes.plot([-0.25 * value, right + 0.03], [level, level], color=INK, lw=0.5, ls=":", zorder=3)
        axes.text(right + 0.05, level, f"{name} {100 * value:.4g} cm at {100 * level:.4g} cm", **words)
    text = f"height {100 * body.sizes.height:.4g} cm, {len(body.triangles)} triangles"
    axes.text(0.0, body.sizes.height + ROOM, text, ha="center", va="bottom", fontsize=8, color=INK)
