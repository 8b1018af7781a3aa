"""Drawings for a workshop as DXF and SVG, on the layers CUT, HOLES and ENGRAVE."""

from __future__ import annotations

from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

import ezdxf
import numpy as np
from ezdxf import units
from ezdxf.enums import TextEntityAlignment

from restshape.export.cut_drawing import CUT, ENGRAVE, HOLES, LAYER_OF, CutDrawing
from restshape.export.dxf_drawing import MM, circle_of, draw_edge
from restshape.export.svg_drawing import path_of, svg_head
from restshape.outputs.atomic_files import replacing, write_whole
from restshape.outputs.kinds import EXPORT_MARK
from restshape.shape.outline import Loop, Outline

UNITS = {"mm": (1e-3, units.MM), "cm": (1e-2, units.CM), "m": (1.0, units.M), "in": (0.0254, units.IN)}
"""Metres in a unit of a drawing, and its number in ``$INSUNITS``."""
COLOURS = {ENGRAVE: (7, "#222222"), HOLES: (5, "#0000ff"), CUT: (1, "#ff0000")}
"""Of each layer, by number in DXF and by name in SVG, in the order of the work."""
HAIRLINE = 0.1
"""Width of lines in SVG [mm]."""
MARGIN = 5.0
"""Room around a drawing in SVG [mm]."""


def write_cut_dxf(drawing: CutDrawing, path: Path, unit: str = "mm") -> None:
    """Writes LINE, ARC, CIRCLE, SPLINE, LWPOLYLINE, POINT and TEXT.

    Args:
        drawing: what is drawn; path: of the file; unit: key of `UNITS`.

    Raises:
        OSError: it cannot be written.
    """
    metres, number = UNITS[unit]
    document = ezdxf.new("R2010", units=number)
    document.header.custom_vars.append("Writer", EXPORT_MARK)
    for layer, (colour, _) in COLOURS.items():
        document.layers.add(layer, color=colour)
    space, scale = document.modelspace(), 1.0 / (MM * metres)
    scaled = {id(own): own.moved(scale * own.points) for own in (drawing.path, drawing.shape)}
    circles = _circles(drawing.path)
    for layer, outline, edge, _ in drawing.edges(ENGRAVE, HOLES, CUT):
        if outline is not drawing.path or edge not in circles:
            draw_edge(space, scaled[id(outline)], edge, {"layer": layer})
        elif (circle := circles[edge]) is not None:
            centre, radius = circle
            space.add_circle(centre / metres, radius / metres, dxfattribs={"layer": layer})
    for a, b in drawing.engraving.lines():
        space.add_line(a / metres, b / metres, dxfattribs={"layer": ENGRAVE})
    for place in drawing.points():
        space.add_point(place / metres, dxfattribs={"layer": ENGRAVE})
    for text in drawing.engraving.texts:
        written = space.add_text(text.text, height=text.height / metres, dxfattribs={"layer": ENGRAVE})
        written.set_placement(text.place / metres, align=TextEntityAlignment.MIDDLE_CENTER)
    with replacing(path) as part:
        document.saveas(part)


def _circles(outline: Outline) -> dict[int, tuple[np.ndarray, float] | None]:
    """Edges that are parts of a round hole: centre (2,) and radius [m] by the first of them, None by the others."""
    found: dict[int, tuple[np.ndarray, float] | None] = {}
    for loop in outline.loops:
        circle = circle_of(outline, loop) if loop.kind == "hole" else None
        if circle is not None:
            found |= dict.fromkeys((e for e, _ in loop.edges), None)
            found[loop.edges[0][0]] = circle
    return found


def write_cut_svg(drawing: CutDrawing, path: Path) -> None:
    """Writes a group a layer: a path a loop, and one an edge of what is engraved; one unit is a millimetre, y goes up.

    Raises:
        OSError: it cannot be written.
    """
    lower, upper = (MM * corner for corner in drawing.path.bounds())
    lines = svg_head(lower, upper, MARGIN, HAIRLINE)
    for layer, (_, colour) in COLOURS.items():
        lines.append(f"<g id={quoteattr(layer)} stroke={quoteattr(colour)}>")
        if layer == ENGRAVE:
            own = [path_of(outline, edge, forward) for _, outline, edge, forward in drawing.edges(ENGRAVE)]
            lines += [*(f"<path d={quoteattr(words)}/>" for words in own), *_engraved(drawing, colour)]
        else:
            loops = [loop for loop in drawing.path.loops if LAYER_OF[loop.kind] == layer]
            lines += [f"<path d={quoteattr(_closed(drawing.path, loop))}/>" for loop in loops]
        lines.append("</g>")
    write_whole(path, "\n".join([*lines, "</svg>", ""]))


def _closed(outline: Outline, loop: Loop) -> str:
    """The path of a loop, in one go."""
    first, *others = (path_of(outline, edge, forward) for edge, forward in loop.edges)
    # Without the words that go to the start of each other edge, where the path is already.
    return " ".join([first, *(words.split(" ", 2)[2] for words in others), "Z"])


def _engraved(drawing: CutDrawing, colour: str) -> list[str]:
    """Crosses, points and texts; a point is a dot as wide as a line."""
    found = []
    for ends in MM * np.array(drawing.engraving.lines()).reshape(-1, 2, 2):
        (x, y), (u, v) = ends.tolist()
        found.append(f'<path d="M {x!r},{-y!r} L {u!r},{-v!r}"/>')
    for x, y in (MM * drawing.points()).tolist():
        found.append(f'<circle cx="{x!r}" cy="{-y!r}" r="{HAIRLINE}"/>')
    for text in drawing.engraving.texts:
        x, y = (MM * text.place).tolist()
        # Capital letters of most fonts are 0.7 of the font's size high.
        size = MM * text.height / 0.7
        look = f'text-anchor="middle" fill={quoteattr(colour)} stroke="none" font-family="sans-serif"'
        where = f'x="{x!r}" y="{-y + 0.35 * size!r}" font-size="{size!r}"'
        found.append(f"<text {where} {look}>{escape(text.text)}</text>")
    return found
