"""Seams drawn on the pattern: both sides of each in its colour and dashes, before anything is sewn."""

from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from restshape.report.conditions import Moved
from restshape.report.entity_outlines import place_of
from restshape.report.legends import LegendLine
from restshape.scene.model import Scene
from restshape.scene.seam_keys import Seam
from restshape.shape.outline import Outline

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#b8860b")
DASHES = ((1.6, 0.8), (0.5, 0.5), (3.0, 0.7, 0.5, 0.7))
"""Lengths of dashes and gaps, over the width of the line: another one after each round of colours."""
WIDTH = 4.0
"""Of a line [points]."""
MOST = 24
"""Seams in the legend, which counts the others."""


def draw_seams(axes: Axes, scene: Scene, outline: Outline, moved: Moved) -> None:
    """Draws both sides of each seam beneath the outline."""
    for i, seam in enumerate(_seams_of(scene).values()):
        colour, style = _look(i)
        lines = [moved(line) for side in seam.sides for name in side for line in place_of(outline, name).lines]
        found = LineCollection(lines, colors=colour, linestyles=[style], linewidths=WIDTH, zorder=4.6)
        axes.add_collection(found, autolim=False)


def seam_legend(scene: Scene) -> list[LegendLine]:
    """A line of the legend for each seam: which edges it joins."""
    found = []
    for i, (name, seam) in enumerate(_seams_of(scene).items()):
        (colour, style), (start, to) = _look(i), (", ".join(side) for side in seam.sides)
        found.append(LegendLine(colour, f"seam {name}: {start} to {to}", style))
    more = [LegendLine("white", f"and {len(found) - MOST} more seams")] if len(found) > MOST else []
    return found[:MOST] + more


def _seams_of(scene: Scene) -> dict[str, Seam]:
    """Those of a scene whose physics has some; else none."""
    return getattr(scene, "seams", {})


def _look(number: int) -> tuple[str, tuple[float, tuple[float, ...]]]:
    """Colour and line style of a seam by its number."""
    return COLOURS[number % len(COLOURS)], (0.0, DASHES[number // len(COLOURS) % len(DASHES)])
