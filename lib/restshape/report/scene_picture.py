"""A scene before any solve: its shape with names, supports, loads and other conditions, goals, and its size."""

# More than 15 modules: whatever a scene may hold is drawn here.

from collections.abc import Sequence
from pathlib import Path
from textwrap import shorten, wrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from restshape.application import application_of
from restshape.outputs.picture_files import save_picture
from restshape.outputs.si_numbers import length_unit
from restshape.report.conditions import (
    ACCELERATION,
    SUPPORT,
    Moved,
    conditions_of,
    draw_conditions,
    draw_loads,
    draw_supports,
    load_colours,
)
from restshape.report.entity_outlines import place_of, smooth
from restshape.report.legends import LegendLine, first_named
from restshape.report.load_vectors import accelerations, in_plane
from restshape.report.name_labels import Labels
from restshape.report.seam_sides import draw_seams, seam_legend
from restshape.report.style import BODY, GOAL, INK, new_figure
from restshape.scene.condition_words import load_words, support_words
from restshape.scene.descriptions import with_symbol
from restshape.scene.model import Scene
from restshape.shape.outline import Outline

WIDE, TALL = 7.6, 7.0
"""Room for the shape [inch]."""
LEFT, BELOW, RIGHT, LINE, LETTER = 0.85, 0.6, 0.25, 0.165, 0.078
ROOM = 0.16
"""Around the shape for arrows and names, over its size."""
HEAD = 4.0
"""Half the width of the head of an arrow [points]."""
MOST_NAMES = 40
"""Names of a kind; of more those alone that the scene uses."""
MOST_ON, MOST_CONDITIONS = 8, 16
"""Names of what a support or a load is on, and supports and loads, that the legend writes; it counts the others."""
NAME, POINT = "#555555", "#7a3e9d"
FILLED = {
    "outline": {"facecolor": BODY, "alpha": 0.6, "zorder": 1},
    "region": {"facecolor": "#f2e3c6", "zorder": 2},
    "hole": {"facecolor": "white", "zorder": 2.5},
}
"""Looks of loops by their kind: a hole in a region is empty, too."""


def draw_scene(scene: Scene, outline: Outline, used: set[str], path: Path) -> None:
    """Writes the picture of a scene, in the format that the path's suffix names.

    Args:
        scene: with supports and loads.
        outline: its shape before any edit.
        used: names of entities that the scene uses, which are written in any case.
        path: of the picture.
    """
    named = goals_of(scene)
    goals = [*named.values()]
    low, high = outline.bounds()
    size = float(max(high - low))
    factor, unit = length_unit(size)
    legend = _legend(scene, outline, first_named([*named], MOST_ON))
    corners = np.vstack([low, high, *goals])
    low_all, high_all = corners.min(axis=0) - ROOM * size, corners.max(axis=0) + ROOM * size
    aspect = float((high_all - low_all)[0] / (high_all - low_all)[1])
    height = min(WIDE / aspect, TALL)
    wide = max(LEFT + height * aspect + RIGHT, 5.5)
    head = _title(scene, outline, factor, unit, int((wide - 0.3) / LETTER))
    words = [line for one in legend for line in wrap(one.text, int((wide - 0.95) / 0.07))]
    top, bottom = 0.25 + 0.19 * len(head), BELOW + 0.2 + LINE * len(words)
    high_figure = top + height + bottom
    figure = new_figure(wide, high_figure)
    figure.set_layout_engine("none")
    figure.suptitle("\n".join(head), x=0.15 / wide, y=1.0 - 0.08 / high_figure, ha="left", va="top", color=INK)
    axes = figure.add_axes((LEFT / wide, bottom / high_figure, height * aspect / wide, height / high_figure))
    axes.set(xlabel=f"x [{unit}]", ylabel=f"y [{unit}]")
    axes.set(xlim=factor * np.array([low_all[0], high_all[0]]), ylim=factor * np.array([low_all[1], high_all[1]]))

    def moved(places: np.ndarray) -> np.ndarray:
        return factor * places

    _body(axes, outline, factor)
    axes.add_collection(LineCollection([factor * goal for goal in goals], colors=GOAL, linewidths=1.3), autolim=False)
    draw_seams(axes, scene, outline, moved)
    draw_supports(axes, scene, outline, moved)
    draw_conditions(axes, scene, outline, moved)
    arrows = draw_loads(axes, scene, outline, moved)
    labels = labels_beside(axes, outline, moved)
    labels.keep_off([*arrows, *(factor * goal for goal in goals)], HEAD)
    name_entities(labels, outline, moved, used)
    _write_legend(figure, legend, wide, high_figure)
    save_picture(figure, path)


def _title(scene: Scene, outline: Outline, factor: float, unit: str, room: int) -> list[str]:
    """The scene's name, its size, and how fine its mesh is to be."""
    width, height = factor * np.subtract(*outline.bounds()[::-1])
    name = shorten(scene.title or scene.path.name, room, placeholder=" …")
    mesh = f"mesh size {factor * scene.mesh.size:.4g} {unit}, order {scene.mesh.order}" if scene.mesh.size else ""
    size = f"{width:.4g} × {height:.4g} {unit}, area {outline.area():.4g} m²"
    return [name, *wrap(", ".join(filter(None, (size, mesh, "before any solve"))), room)]


def _body(axes: Axes, outline: Outline, factor: float) -> None:
    """The material in grey without its holes, regions in another colour, and all edges."""
    for kind, look in FILLED.items():
        for loop in (loop for loop in outline.loops if loop.kind == kind):
            axes.fill(*(factor * loop_points(outline, loop.edges)).T, edgecolor="none", **look)
    edges = [factor * smooth(outline, edge) for edge in range(len(outline.edges))]
    axes.add_collection(LineCollection(edges, colors=INK, linewidths=0.8, zorder=5), autolim=False)
    loose = outline.points[list(outline.embedded)]
    axes.plot(*(factor * loose).T, ".", color=POINT, ms=5, zorder=6)


def loop_points(outline: Outline, edges: tuple[tuple[int, bool], ...]) -> np.ndarray:
    """Points (m, 2) around a loop [m], the first one not repeated."""
    return np.concatenate([smooth(outline, edge)[:: 1 if forward else -1][:-1] for edge, forward in edges])


def labels_beside(axes: Axes, outline: Outline, moved: Moved) -> Labels:
    """What puts names into axes with final limits, in a figure without a layout engine, beside the edges drawn there.

    Args:
        axes: with final limits; outline: that is drawn; moved: where places at rest are.
    """
    labels = Labels(axes)
    labels.keep_off(moved(outline.polyline(edge)) for edge in range(len(outline.edges)))
    return labels


def name_entities(labels: Labels, outline: Outline, moved: Moved, used: set[str], size: float = 7.5) -> None:
    """Writes the names of panels, regions, holes, edges and vertices beside them; without that of their panel.

    Args:
        labels: that put them into their axes.
        outline: whose entities they are.
        moved: where places at rest are drawn.
        used: names that are written in any case.
        size: of the font.
    """
    for loop in outline.loops if len(outline.piece_names) > 1 else ():
        if loop.kind == "outline":
            middle = loop_points(outline, loop.edges).mean(axis=0, keepdims=True)
            labels.add(moved(middle)[0], loop.name, INK, size + 1.5, on_it=True)
    for kind, colour in (("region", INK), ("hole", INK), ("edge", NAME), ("vertex", POINT)):
        names = outline.names(kind)
        # Parts of round loops are named after these.
        chosen = [name for name in names if name in used or not _part(name, outline)]
        chosen = [name for name in chosen if name in used] if len(chosen) > MOST_NAMES else chosen
        for name in chosen:
            place, words = place_of(outline, name), _own_name(name, outline)
            if kind == "edge":
                middle = len(place.at) // 2
                labels.add(moved(place.at[[middle]])[0], words, colour, size, first=place.outwards[middle])
            elif kind == "vertex":
                (here,) = moved(place.points[:1])
                labels.axes.plot(*here, ".", color=POINT, ms=3.5, zorder=6)
                labels.add(here, words, colour, size)
            else:
                labels.add(moved(place.inside[None])[0], words, colour, size, on_it=True)


def _own_name(name: str, outline: Outline) -> str:
    """A name without that of its panel, which is written on the panel."""
    panel, dot, own = name.partition(".")
    return own if dot and panel in outline.piece_names and len(outline.piece_names) > 1 else name


def _part(name: str, outline: Outline) -> bool:
    """Whether a name was made for a part of a loop."""
    # Of a panel all names begin with its own.
    return any(name.startswith(f"{loop.name}.") for loop in outline.loops if loop.kind != "outline")


def goals_of(scene: Scene) -> dict[str, np.ndarray]:
    """The goals (m, 2) [m] of a scene by name."""
    sections = {key: section for one in application_of(scene).physics for key, section in one.sections.items()}
    curved = ((section, scene.sections.get(key) or {}) for key, section in sections.items() if section.curve)
    return {name: section.curve_of(goal) for section, given in curved for name, goal in given.items()}


def _legend(scene: Scene, outline: Outline, goals: str) -> list[LegendLine]:
    """What colours mean: a line each; groups with what is in them."""

    def on(names: Sequence[str]) -> str:
        groups = outline.groups
        parts = [f"{name} ({first_named(groups[name], MOST_ON)})" if name in groups else name for name in names]
        return first_named(parts, MOST_ON)

    known, supports = scene.parameters, scene.supports.items()
    found = [
        LegendLine(SUPPORT, f"support {name} on {on(one.on)}: {support_words(one, known)}") for name, one in supports
    ]
    loads = zip(scene.loads.items(), load_colours(scene))
    found += [
        LegendLine(colour, f"load {name} on {on(one.on)}: {load_words(one, known)}") for (name, one), colour in loads
    ]
    found += [LegendLine(one.colour, f"{one.name} on {on(one.on)}: {one.words}") for one in conditions_of(scene)]
    if len(found) > MOST_CONDITIONS:
        found = [
            *found[:MOST_CONDITIONS],
            LegendLine("white", f"and {len(found) - MOST_CONDITIONS} more conditions"),
        ]
    for name, value in accelerations(scene).items():
        # One across the plane has no arrow.
        colour = ACCELERATION if in_plane(scene, name, value).any() else "white"
        found.append(LegendLine(colour, f"{name}: {with_symbol(value, 'acceleration', known)}"))
    return found + seam_legend(scene) + ([LegendLine(GOAL, f"goal {goals}")] if goals else [])


def _write_legend(figure: Figure, legend: list[LegendLine], wide: float, high: float) -> None:
    """The legend below the axes, a line or more each."""
    y = LINE * sum(len(wrap(one.text, int((wide - 0.95) / 0.07))) for one in legend) + 0.1
    for one in legend:
        lines = wrap(one.text, int((wide - 0.95) / 0.07))
        mark = Line2D([0.2 / wide, 0.5 / wide], [(y - 0.06) / high] * 2, color=one.colour, lw=3.0, ls=one.style)
        figure.add_artist(mark)
        figure.text(0.6 / wide, y / high, "\n".join(lines), va="top", color=INK, fontsize=8.5)
        y -= LINE * len(lines)
