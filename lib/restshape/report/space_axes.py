"""The box around what is shown in space: its back walls with a grid, and three sides with numbers and units."""

from __future__ import annotations

from functools import cache

import numpy as np
from matplotlib.axes import Axes
from matplotlib.text import Annotation
from matplotlib.textpath import TextPath
from matplotlib.ticker import MaxNLocator

from restshape.report.camera import Camera
from restshape.report.space_scene import SpaceDrawing
from restshape.report.style import FAINT

GRID = "#e3e3e3"
MOST = 4
"""Numbers along the side that is longest in the picture."""
SHORT = 0.3
"""Length in the picture, over that of the longest side, below which a side has two numbers."""
SMALL, CLEAR = 7, 2.0
"""Size of numbers, and what is left free between them at least [points]."""
OFFSET, PARALLEL, BESIDE = 4.0, 19.0, 7.0
"""Distances of numbers and of the name of a lying side from that side, and of the name of a steep one from numbers
[points]."""


def draw_box(
    scene: SpaceDrawing,
    axes: Axes,
    camera: Camera,
    low: np.ndarray,
    high: np.ndarray,
    factor: float,
    unit: str,
    points: float = np.inf,
) -> list[Annotation]:
    """Draw the walls and sides of a box, whose numbers it returns; the camera looks from above, from -y and +x.

    Args:
        scene: that gets the lines.
        axes: that get the words; their coordinates are those of the camera.
        camera: looks at the box.
        low, high: (3,) corners of the box [m].
        factor, unit: of lengths in numbers.
        points: that a metre has in the picture, about: where numbers would touch there are but two along a side.
    """
    middle = camera.project(0.5 * (low + high)[None])[0]
    fixed = {0: (None, low[1], low[2]), 1: (high[0], None, low[2]), 2: (low[0], low[1], None)}
    sides = [np.array([[e[j] if f is None else f for j, f in enumerate(fixed[k])] for e in (low, high)]) for k in fixed]
    lengths = np.array([np.linalg.norm(np.diff(camera.project(side), axis=0)) for side in sides])
    numbers = np.maximum(2, np.round(MOST * lengths / lengths.max())).astype(int)
    places = [marks(low[k], high[k], factor, int(numbers[k])) for k in range(3)]
    # On a short side three numbers would run into each other.
    places = [at[[0, -1]] if short else at for at, short in zip(places, lengths < SHORT * lengths.max())]
    walls = []
    for wall, bound in ((0, low), (1, high), (2, low)):
        for along in (k for k in range(3) if k != wall):
            across = 3 - wall - along
            for mark in (low[along], *places[along], high[along]):
                ends = np.empty((2, 3))
                ends[:, wall], ends[:, along], ends[:, across] = bound[wall], mark, (low[across], high[across])
                walls.append(ends)
    scene.lines(np.array(walls), GRID, 0.6)
    scene.lines(np.array(sides), FAINT, 0.9)
    numbers = []
    for k, name in enumerate("xyz"):
        at, way = places[k], np.abs(np.diff(camera.project(sides[k]), axis=0)[0]) / (high[k] - low[k])
        if np.isfinite(points) and _touch(points * np.diff(at)[:, None] * way, _texts(at, factor)):
            at = at[[0, -1]]
        numbers += _side(axes, camera, fixed[k], (low[k], high[k]), at, factor, f"{name} [{unit}]", middle)
    return numbers


def _touch(steps: np.ndarray, texts: list[str]) -> bool:
    """Whether numbers that are so far across and up from each other (n - 1, 2) [points] would touch."""
    wide = np.array([_width(text) for text in texts])
    return bool(np.any((steps[:, 0] < 0.5 * (wide[1:] + wide[:-1]) + CLEAR) & (steps[:, 1] < SMALL + CLEAR)))


def _texts(marks: np.ndarray, factor: float) -> list[str]:
    return [f"{mark * factor:g}".replace("-", "\N{MINUS SIGN}") for mark in marks]


@cache
def _width(number: str) -> float:
    """How wide a number along a side is [points]."""
    return float(TextPath((0, 0), number, size=SMALL).get_extents().width)


def few_ticks(most: int) -> MaxNLocator:
    """Chooses round numbers for a side, at most so many and one more."""
    return MaxNLocator(most, steps=[1, 2, 5, 10], min_n_ticks=2 if most > 2 else 1)


def marks(low: float, high: float, factor: float, most: int) -> np.ndarray:
    """Places [m] of numbers along a side: round ones, at most so many and one more, but two at least.

    Args:
        low, high: ends of the side [m].
        factor: of lengths in numbers.
        most: numbers.
    """
    for parts in range(most, most + 5):
        places = few_ticks(parts).tick_values(low * factor, high * factor) / factor
        places = places[(places >= low) & (places <= high)]
        if len(places) > 1:
            break
    return places


def _side(axes, camera, fixed, ends, numbered, factor, label, middle) -> list[Annotation]:
    """Write the numbers of a side, which it returns, and its name outside of the box."""

    def at(values) -> np.ndarray:
        places = np.array([[value if fixed[j] is None else fixed[j] for j in range(3)] for value in values])
        return camera.project(places)

    line = at(ends)
    along = line[1] - line[0]
    out = np.array([along[1], -along[0]]) / np.linalg.norm(along)
    out *= np.sign(out @ (line.mean(axis=0) - middle)) or 1.0
    where = {
        "ha": "right" if out[0] < -0.4 else "left" if out[0] > 0.4 else "center",
        "va": "top" if out[1] < -0.4 else "bottom" if out[1] > 0.4 else "center",
        "textcoords": "offset points",
        "annotation_clip": False,
        "color": "#444444",
    }
    numbers = _texts(numbered, factor)
    look = {"fontsize": SMALL, **where}
    shown = [axes.annotate(number, place, xytext=OFFSET * out, **look) for number, place in zip(numbers, at(numbered))]
    away, turned = PARALLEL, {}
    if abs(out[0]) > 0.4:
        # Numbers and name of a steep side are side by side.
        wide = max(map(_width, numbers))
        away = OFFSET + wide * abs(out[0]) + SMALL * abs(out[1]) + BESIDE
        angle = np.rad2deg(np.arctan2(along[1], along[0]))
        turned = {"rotation": angle, "ha": "center", "va": "center"}
    axes.annotate(label, line.mean(axis=0), xytext=away * out, fontsize=8, **where | turned)
    return shown
