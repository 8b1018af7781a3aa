"""Sewing patterns as drawings: DXF with the layers of AAMA and ASTM, and SVG; pieces side by side, in true size."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape, quoteattr

import ezdxf
import numpy as np
from ezdxf import units

from restshape.arrays import Reals
from restshape.export.dxf_drawing import MM, draw_edge
from restshape.export.pattern_marks import edge_labels, grain_line, notches
from restshape.export.seam_allowance import cut_lines
from restshape.export.svg_drawing import path_of, svg_head
from restshape.outputs.atomic_files import replacing, write_whole
from restshape.outputs.kinds import EXPORT_MARK
from restshape.shape.outline import Outline
from restshape.shape.pattern import Pattern, PatternPiece
from restshape.shape.pattern_axes import turned_up
from restshape.shape.pattern_drawing import ANNOTATION, CUT, CUTOUT, GRAIN, INTERNAL, NOTCH, SEW
from restshape.shape.pattern_notes import APPLICATION, METADATA, keep, place_of
from restshape.shape.seam_parts import SeamPart, seam_colours, seam_names, seam_parts
from restshape.shape.svg_tree import NO_SHAPE

GAP = 0.05
"""Room between pieces, over the size of the largest."""
STROKE = 0.001
"""Width of lines, over the width of the drawing."""
LETTERS = 8e-3
"""Height of names of seams [m]."""
NOTCH_LENGTH = 6e-3
"""Length of notches [m] where there is no allowance."""
LAYER_OF = {"hole": CUTOUT, "region": INTERNAL}
Parts = Mapping[str, Sequence[SeamPart]]


def write_pattern_dxf(pattern: Pattern, path: Path, allowance: float = 0.0) -> list[str]:
    """Writes a pattern, a block a piece; what it leaves out.

    Layer 1 has the cut line, layer 14 the line of the seams: the same border without an allowance. Layer 4 has notches
    at the ends of seams and points of the shape, 7 the grain, 8 regions, 11 holes, 15 the names of seams. Curves are
    as they are: LINE, ARC, SPLINE, LWPOLYLINE. Names of edges, seams, and where pieces lie in space are extended data.

    Args:
        pattern: to write; path: of the file; allowance: of all borders [m].

    Raises:
        UserError: an allowance cannot be made.
        OSError: it cannot be written.
    """
    pattern = turned_up(pattern, "z")
    drawing = ezdxf.new("R2010", units=units.MM)
    drawing.header.custom_vars.append("Writer", EXPORT_MARK)
    drawing.appids.add(APPLICATION)
    for layer in (CUT, NOTCH, GRAIN, INTERNAL, CUTOUT, SEW, ANNOTATION):
        drawing.layers.add(layer)
    space, outlines = drawing.modelspace(), [piece.outline() for piece in pattern.pieces]
    space.add_text("Units: METRIC", dxfattribs={"layer": CUT})
    keys = {name: stitch.keys for name, stitch in zip(seam_names(pattern), pattern.stitches) if stitch.keys}
    if keys:
        keep(space.add_text("Seams", dxfattribs={"layer": ANNOTATION, "invisible": 1}), {"keys": keys})
    for piece, outline, place in zip(pattern.pieces, outlines, _places(outlines, allowance)):
        block = drawing.blocks.new(piece.name)
        block.add_text(f"Piece Name: {piece.name}", dxfattribs={"layer": CUT})
        _draw_piece(block, piece, outline, seam_parts(pattern), allowance)
        insert = space.add_blockref(piece.name, MM * place, dxfattribs={"layer": CUT})
        if where := place_of(piece):
            keep(insert, where)
    with replacing(path) as part:
        drawing.saveas(part)
    return _left_out(pattern)


def _draw_piece(block: Any, piece: PatternPiece, outline: Outline, parts: Parts, allowance: float) -> None:
    cut = cut_lines(outline, allowance, piece.name) if allowance else []
    for line in cut:
        block.add_lwpolyline((MM * line).tolist(), close=True, dxfattribs={"layer": CUT})
    drawn: set[int] = set()
    for loop in outline.loops:
        own = [e for e, _ in loop.edges if e not in drawn]
        drawn.update(own)
        border = (SEW,) if cut else (CUT, SEW)
        for layer in border if loop.kind == "outline" else (LAYER_OF[loop.kind],):
            for e in own:
                draw_edge(block, outline, e, {"layer": layer})
                edge = f"{piece.name}.{outline.edges[e].name}"
                if layer in (SEW, CUTOUT):
                    keep(block[-1], {"edge": edge, "seams": [list(part) for part in parts.get(edge, ())]})
    for vertex in dict.fromkeys([*outline.embedded, *(one.vertex for one in notches(outline, piece.name, parts))]):
        point = block.add_point(MM * outline.points[vertex], dxfattribs={"layer": NOTCH})
        keep(point, {"vertex": outline.vertex_names[vertex]})
    for label in edge_labels(outline, piece.name, parts):
        look = {"layer": ANNOTATION, "height": MM * LETTERS, "rotation": float(np.degrees(label.angle))}
        text = block.add_text(label.seam, dxfattribs=look)
        text.dxf.insert = MM * (label.place - 2.0 * LETTERS * label.outward)
        keep(text, {"seam": label.seam})
    if piece.grain is not None:
        a, b = MM * grain_line(outline, piece.grain)
        block.add_line(a, b, dxfattribs={"layer": GRAIN})


def write_pattern_svg(pattern: Pattern, path: Path, allowance: float = 0.0) -> list[str]:
    """Writes a pattern: a group a piece, a group a loop in it, a path an edge; one unit is a millimetre.

    Edges have the colours of their seams. Cut lines, notches and names of seams are in groups of the class `NO_SHAPE`,
    which readers of shapes leave out. Seams, grain and places in space are metadata. Arguments as of
    `write_pattern_dxf`.

    Raises:
        UserError: an allowance cannot be made.
        OSError: it cannot be written.
    """
    pattern = turned_up(pattern, "z")
    outlines = [piece.outline() for piece in pattern.pieces]
    places = _places(outlines, allowance)
    corners = [np.array(outline.bounds()) + place for outline, place in zip(outlines, places)]
    low, high = MM * np.min(corners, axis=(0, 1)), MM * np.max(corners, axis=(0, 1))
    margin = 0.02 * float(np.hypot(*(high - low))) + MM * (allowance or NOTCH_LENGTH)
    width = STROKE * (float(high[0] - low[0]) + 2.0 * margin)
    parts, colours = seam_parts(pattern), seam_colours(seam_names(pattern))
    lines = svg_head(low, high, margin, width)
    lines.append(f"<metadata id={quoteattr(METADATA)}>{escape(json.dumps(_metadata(pattern)))}</metadata>")
    for piece, outline, place in zip(pattern.pieces, outlines, places):
        shift = f"translate({float(MM * place[0])!r} {float(0.0 - MM * place[1])!r})"
        lines.append(f"<g transform={quoteattr(shift)}>")
        lines += [*_loops(piece.name, outline, parts, colours), *_marks(piece, outline, parts, colours, allowance)]
        lines.append("</g>")
    write_whole(path, "\n".join([*lines, "</svg>", ""]))
    return _left_out(pattern)


def _metadata(pattern: Pattern) -> dict[str, object]:
    """Seams, grain and places in space, for those who read the drawing."""
    pieces: dict[str, object] = {}
    for piece in pattern.pieces:
        grain = {} if piece.grain is None else {"grain": piece.grain}
        if own := {**place_of(piece), **grain}:
            pieces[piece.name] = own
    seams = {
        name: {"from": stitch.first, "to": stitch.second, "keys": stitch.keys}
        for name, stitch in zip(seam_names(pattern), pattern.stitches)
    }
    return {"pieces": pieces, "seams": seams}


def _loops(name: str, outline: Outline, parts: Parts, colours: Mapping[str, str]) -> list[str]:
    """The lines of one piece, without regions that share edges with its border."""
    lines, drawn = [], set[int]()
    for loop in outline.loops:
        if drawn & {e for e, _ in loop.edges}:
            continue
        own = name if loop.kind == "outline" else f"{name}.{loop.name}"
        lines.append(f"<g id={quoteattr(own)} class={quoteattr(loop.kind)}>")
        for e, forward in loop.edges:
            edge = f"{name}.{outline.edges[e].name}"
            sewn = parts.get(edge, ())
            colour = f" stroke={quoteattr(colours[sewn[0].seam])}" if sewn else ""
            seams = f" data-seam={quoteattr(' '.join(part.seam for part in sewn))}" if sewn else ""
            lines.append(f"<path id={quoteattr(edge)}{seams}{colour} d={quoteattr(path_of(outline, e, forward))}/>")
            drawn.add(e)
        lines.append("</g>")
    return lines


def _marks(
    piece: PatternPiece, outline: Outline, parts: Parts, colours: Mapping[str, str], allowance: float
) -> list[str]:
    """The group of all that is no part of the shape: cut lines, notches, the grain, names of seams."""
    lines = [f'<g class="{NO_SHAPE}">']
    for line in cut_lines(outline, allowance, piece.name) if allowance else []:
        lines.append(f"<path d={quoteattr(f'M {_pairs(line)} Z')}/>")
    for notch in notches(outline, piece.name, parts):
        ends = np.array([notch.place, notch.place + (allowance or NOTCH_LENGTH) * notch.outward])
        lines.append(f"<path d={quoteattr(f'M {_pairs(ends)}')} stroke={quoteattr(colours[notch.seam])}/>")
    if piece.grain is not None:
        lines.append(f"<path d={quoteattr(f'M {_pairs(grain_line(outline, piece.grain))}')}/>")
    for label in edge_labels(outline, piece.name, parts):
        x, y = MM * (label.place - 2.0 * LETTERS * label.outward)
        turned = f"translate({x:.6g} {-y:.6g}) rotate({-np.degrees(label.angle):.6g})"
        look = f'font-size="{MM * LETTERS:g}" text-anchor="middle" stroke="none" fill="{colours[label.seam]}"'
        lines.append(f"<text transform={quoteattr(turned)} {look}>{escape(label.seam)}</text>")
    return [*lines, "</g>"]


def _pairs(points: Reals) -> str:
    """Points (n, 2) [m] in mm, y down."""
    return " ".join(f"{MM * x:.6g},{0.0 - MM * y:.6g}" for x, y in points)


def _places(outlines: Sequence[Outline], allowance: float) -> list[Reals]:
    """Displacements (2,) [m] that bring pieces side by side."""
    boxes = [np.array(outline.bounds()) for outline in outlines]
    gap = GAP * max(float(np.ptp(box, axis=0).max()) for box in boxes) + 2.0 * allowance
    found, x = [], 0.0
    for low, high in boxes:
        found.append(np.array([x - low[0], -low[1]]))
        x += float(high[0] - low[0]) + gap
    return found


def _left_out(pattern: Pattern) -> list[str]:
    """Notes of what a drawing has no place for."""
    kept = [piece.name for piece in pattern.pieces if piece.kept or any(piece.kept_edges.values())]
    return (
        [f"left out, for drawings have no such keys: what the file says besides of {', '.join(kept)}"] if kept else []
    )
