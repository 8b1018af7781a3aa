"""Supports and loads drawn where they act: coloured edges, points and arrows."""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from restshape.application import application_of
from restshape.report.entity_outlines import Place, place_of
from restshape.report.load_vectors import accelerations, in_plane, load_vectors
from restshape.scene.descriptions import keys_in_words
from restshape.scene.model import Scene
from restshape.scene.scene_type import joined_sections
from restshape.shape.outline import Outline

SUPPORT = "#0072b2"
LOADS = ("#c44e00", "#117733", "#cc6699", "#882255", "#999933", "#6b4c9a")
"""Colours of the loads of a scene, in turn."""
ARROW = 0.09
"""Length of the longest arrow of a load, over the size of the picture."""
SHAFT, HEAD = 0.004, 4.0
"""Width of an arrow over that of the axes, and of its head over that of the arrow."""
LOOK: dict[str, Any] = {"angles": "xy", "scale_units": "xy", "scale": 1.0, "zorder": 6, "clip_on": False}
"""Of all arrows."""
ACCELERATION, CORNER = "#444444", 0.67
"""Colour of the arrow of gravity, and how far its middle is from the corner of the axes, over its length."""

Moved = Callable[[np.ndarray], np.ndarray]
"""Where places (n, 2) at rest [m] are drawn, in the unit of the axes."""


def draw_supports(axes: Axes, scene: Scene, outline: Outline, moved: Moved, width: float = 3.0) -> None:
    """Draws where supports act, as lines beneath the outline, and triangles at points."""
    for support in scene.supports.values():
        for name in support.on:
            place = place_of(outline, name)
            _lines(axes, place, moved, SUPPORT, width)
            if len(place.points):
                axes.plot(*moved(place.points).T, "^", color=SUPPORT, ms=2.0 * width, zorder=6)


def draw_loads(axes: Axes, scene: Scene, outline: Outline, moved: Moved, width: float = 2.0) -> list[np.ndarray]:
    """Draws where loads act and which way: arrows of vectors and pressures, lines of the others.

    Returns the arrows, from tail to tip (2, 2), in the unit of the axes.
    """
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    longest, drawn = ARROW * max(right - left, top - bottom), []
    for (key, load), colour in zip(scene.loads.items(), load_colours(scene)):
        for name in load.on:
            place = place_of(outline, name)
            inside = load.kind == "body" or name == "all"
            if not inside:
                _lines(axes, place, moved, colour, width)
            vectors = load_vectors(scene, key, load, place, inside)
            if vectors is not None:
                drawn += _arrows(axes, place, moved, vectors, longest, inside, colour)
            elif len(place.points):
                axes.plot(*moved(place.points).T, "D", color=colour, ms=2.5 * width, zorder=6)
    return drawn + _draw_accelerations(axes, scene, longest)


class Condition(NamedTuple):
    """What a table of a scene says of entities, besides supports and loads: of a fluid what it does at edges.

    Args:
        name: of the table; on: the entities; words: what it says of them; colour: that pictures have it in.
    """

    name: str
    on: Sequence[str]
    words: str
    colour: str


def conditions_of(scene: Scene) -> list[Condition]:
    """The conditions of a scene besides supports and loads, in colours that follow those of its loads."""
    found = []
    for key, section in joined_sections(application_of(scene).physics).items():
        tables = getattr(scene, key) if section.named and "on" in section.model.model_fields else {}
        words = {name: keys_in_words(table, ("on",), scene.parameters) for name, table in tables.items()}
        found += [(f"{key} {name}", table.on, words[name]) for name, table in tables.items()]
    first = len(scene.loads)
    return [Condition(*one, LOADS[(first + i) % len(LOADS)]) for i, one in enumerate(found)]


def draw_conditions(axes: Axes, scene: Scene, outline: Outline, moved: Moved, width: float = 2.5) -> None:
    """Draws where conditions besides supports and loads hold, as lines beneath the outline."""
    for condition in conditions_of(scene):
        for name in condition.on:
            _lines(axes, place_of(outline, name), moved, condition.colour, width)


def _draw_accelerations(axes: Axes, scene: Scene, longest: float) -> list[np.ndarray]:
    """An arrow of this length in the upper left corner for each acceleration in the plane; from tail to tip (2, 2)."""
    left, top = axes.get_xlim()[0], axes.get_ylim()[1]
    at, drawn = np.array([left, top]) + CORNER * longest * np.array([1.0, -1.0]), []
    for name, value in accelerations(scene).items():
        way = in_plane(scene, name, value)
        if size := float(np.hypot(*way)):
            arrow = way * (longest / size)
            axes.quiver(*at, *arrow, pivot="mid", width=SHAFT, headwidth=HEAD, color=ACCELERATION, **LOOK)
            drawn.append(np.stack([at - 0.5 * arrow, at + 0.5 * arrow]))
    return drawn


def load_colours(scene: Scene) -> list[str]:
    """A colour for each load of a scene, in its order: others as far as there are enough."""
    return [LOADS[i % len(LOADS)] for i in range(len(scene.loads))]


def _lines(axes: Axes, place: Place, moved: Moved, colour: str, width: float) -> None:
    if place.lines:
        lines = [moved(line) for line in place.lines]
        axes.add_collection(LineCollection(lines, colors=colour, linewidths=width, zorder=4.5), autolim=False)


def _arrows(
    axes: Axes, place: Place, moved: Moved, vectors: np.ndarray, longest: float, inside: bool, colour: str
) -> list[np.ndarray]:
    """Arrows that end where they push on the body, and begin where they pull, from tail to tip (2, 2)."""
    sizes = np.linalg.norm(vectors, axis=1)
    if not sizes.max(initial=0.0):
        return []
    at = moved(place.inside[None] if inside else place.at)
    arrows = vectors * (longest / sizes.max())
    pushes = np.zeros(len(at), dtype=bool) if inside else (vectors * place.outwards).sum(axis=1) < -1e-9 * sizes.max()
    tails = at - np.where(pushes[:, None], arrows, 0.0)
    shown = _apart(tails, arrows, HEAD * SHAFT * abs(float(np.subtract(*axes.get_xlim()))))
    for chosen, pivot in ((pushes, "tip"), (~pushes, "tail")):
        if (chosen := chosen & shown).any():
            axes.quiver(
                *at[chosen].T, *arrows[chosen].T, pivot=pivot, width=SHAFT, headwidth=HEAD, color=colour, **LOOK
            )
    return [np.stack(ends) for ends in zip(tails[shown], (tails + arrows)[shown])]


def _apart(tails: np.ndarray, arrows: np.ndarray, wide: float) -> np.ndarray:
    """Which of some arrows (n, 2) along a chain are drawn: as many as keep their tips this far from the others."""
    count = len(tails)
    along = tails[:, None] + np.linspace(0.0, 1.0, 9)[:, None] * arrows[:, None]
    far = np.linalg.norm((tails + arrows)[:, None, None] - along, axis=-1).min(axis=2)
    np.fill_diagonal(far, np.inf)
    for step in range(1, count):
        shown = np.arange(count) % step == (count - 1) % step // 2
        if far[np.ix_(shown, shown)].min() >= wide:
            return shown
    return np.arange(count) == count // 2
