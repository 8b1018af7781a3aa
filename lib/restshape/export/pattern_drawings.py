"""Sewing patterns as drawings: DXF with the layers of AAMA and ASTM, and SVG; pieces side by side, in true size."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import ezdxf
import numpy as np
from ezdxf import units

from restshape.arrays import Reals
from restshape.export.dxf_drawing import MM, draw_edge
from restshape.export.svg_drawing import path_of, svg_head
from restshape.outputs.atomic_files import replacing, write_whole
from restshape.outputs.kinds import EXPORT_MARK
from restshape.shape.outline import Outline
from restshape.shape.pattern import Pattern, PatternPiece
from restshape.shape.pattern_drawing import CUT, CUTOUT, GRAIN, INTERNAL, NOTCH, SEW

GAP = 0.05
"""Room between pieces, over the size of the largest."""
STROKE = 0.001
"""Width of lines, over the width of the drawing."""
ALONG = 0.3
"""Half the length of the line of a grain, over the size of its piece."""
LAYER_OF = {"hole": CUTOUT, "region": INTERNAL}


def write_pattern_dxf(pattern: Pattern, path: Path) -> list[str]:
    """Writes a pattern, a block a piece; what it leaves out.

    Layer 1 has the border, layer 14 the line of the seams, which is the same: patterns have no allowance. Layer 4 has
    points of the shape, 7 the grain, 8 regions, 11 holes. Curves are as they are: LINE, ARC, SPLINE, LWPOLYLINE.

    Raises:
        OSError: it cannot be written.
    """
    drawing = ezdxf.new("R2010", units=units.MM)
    drawing.header.custom_vars.append("Writer", EXPORT_MARK)
    for layer in (CUT, NOTCH, GRAIN, INTERNAL, CUTOUT, SEW):
        drawing.layers.add(layer)
    space, outlines = drawing.modelspace(), [piece.outline() for piece in pattern.pieces]
    space.add_text("Units: METRIC", dxfattribs={"layer": CUT})
    for piece, outline, place in zip(pattern.pieces, outlines, _places(outlines)):
        block = drawing.blocks.new(piece.name)
        block.add_text(f"Piece Name: {piece.name}", dxfattribs={"layer": CUT})
        _draw_piece(block, piece, outline)
        space.add_blockref(piece.name, MM * place, dxfattribs={"layer": CUT})
    with replacing(path) as part:
        drawing.saveas(part)
    return _left_out(pattern, "a DXF of pieces")


def _draw_piece(block: Any, piece: PatternPiece, outline: Outline) -> None:
    drawn: set[int] = set()
    for loop in outline.loops:
        own = [e for e, _ in loop.edges if e not in drawn]
        drawn.update(own)
        for layer in (CUT, SEW) if loop.kind == "outline" else (LAYER_OF[loop.kind],):
            for e in own:
                draw_edge(block, outline, e, {"layer": layer})
    for vertex in outline.embedded:
        block.add_point(MM * outline.points[vertex], dxfattribs={"layer": NOTCH})
    if piece.grain is not None:
        low, high = outline.bounds()
        way = ALONG * float(np.hypot(*(high - low))) * np.array([np.cos(piece.grain), np.sin(piece.grain)])
        middle = 0.5 * (low + high)
        block.add_line(MM * (middle - way), MM * (middle + way), dxfattribs={"layer": GRAIN})


def write_pattern_svg(pattern: Pattern, path: Path) -> list[str]:
    """Writes a pattern: a group a piece, a group a loop in it, a path an edge; one unit is a millimetre.

    Raises:
        OSError: it cannot be written.
    """
    outlines = [piece.outline() for piece in pattern.pieces]
    places = _places(outlines)
    corners = [np.array(outline.bounds()) + place for outline, place in zip(outlines, places)]
    low, high = MM * np.min(corners, axis=(0, 1)), MM * np.max(corners, axis=(0, 1))
    margin = 0.02 * float(np.hypot(*(high - low)))
    width = STROKE * (float(high[0] - low[0]) + 2.0 * margin)
    lines = svg_head(low, high, margin, width)
    for piece, outline, place in zip(pattern.pieces, outlines, places):
        lines += _group(piece.name, outline, place)
    write_whole(path, "\n".join([*lines, "</svg>", ""]))
    return _left_out(pattern, "an SVG")


def _group(name: str, outline: Outline, place: Reals) -> list[str]:
    """The lines of one piece, without regions that share edges with its border."""
    shift = f"translate({float(MM * place[0])!r} {float(0.0 - MM * place[1])!r})"
    lines, drawn = [f"<g transform={quoteattr(shift)}>"], set[int]()
    for loop in outline.loops:
        if drawn & {e for e, _ in loop.edges}:
            continue
        own = name if loop.kind == "outline" else f"{name}.{loop.name}"
        lines.append(f"<g id={quoteattr(own)} class={quoteattr(loop.kind)}>")
        for e, forward in loop.edges:
            edge = quoteattr(f"{name}.{outline.edges[e].name}")
            lines.append(f"<path id={edge} d={quoteattr(path_of(outline, e, forward))}/>")
            drawn.add(e)
        lines.append("</g>")
    return [*lines, "</g>"]


def _places(outlines: Sequence[Outline]) -> list[Reals]:
    """Displacements (2,) [m] that bring pieces side by side."""
    boxes = [np.array(outline.bounds()) for outline in outlines]
    gap = GAP * max(float(np.ptp(box, axis=0).max()) for box in boxes)
    found, x = [], 0.0
    for low, high in boxes:
        found.append(np.array([x - low[0], -low[1]]))
        x += float(high[0] - low[0]) + gap
    return found


def _left_out(pattern: Pattern, what: str) -> list[str]:
    """Notes of what a drawing has no place for."""
    notes = []
    if pattern.stitches:
        notes.append(f"left out, for {what} has none: {len(pattern.stitches)} seams")
    if any(any(piece.move) or any(piece.turn) for piece in pattern.pieces):
        notes.append(f"left out, for {what} is flat: where the pieces lie in space")
    return notes
