"""Sewing patterns as SVG: pieces side by side, in true size."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from restshape.arrays import Reals
from restshape.export.dxf_drawing import MM
from restshape.export.pattern_drawings import LETTERS, Parts, drawn_keys, left_out, side_by_side
from restshape.export.pattern_marks import edge_labels, grain_line, notches
from restshape.export.seam_allowance import cut_lines, hole_cut_lines, holes_noted, sewn_holes
from restshape.export.svg_drawing import path_of, svg_head
from restshape.outputs.atomic_files import write_whole
from restshape.shape.drawings.svg_tree import NO_SHAPE
from restshape.shape.outline import Outline
from restshape.shape.patterns.pattern import Pattern, PatternPiece
from restshape.shape.patterns.pattern_axes import turned_up
from restshape.shape.patterns.pattern_notes import METADATA, ORIGIN, place_of
from restshape.shape.patterns.seam_parts import seam_colours, seam_names, seam_parts

STROKE = 0.001
"""Width of lines, over the width of the drawing."""
NOTCH_LENGTH = 6e-3
"""Length of notches [m] where there is no allowance."""


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
    places = side_by_side(outlines, allowance)
    corners = [np.array(outline.bounds()) + place for outline, place in zip(outlines, places)]
    low, high = MM * np.min(corners, axis=(0, 1)), MM * np.max(corners, axis=(0, 1))
    margin = 0.02 * float(np.hypot(*(high - low))) + MM * (allowance or NOTCH_LENGTH)
    width = STROKE * (float(high[0] - low[0]) + 2.0 * margin)
    parts, colours = seam_parts(pattern), seam_colours(seam_names(pattern))
    lines = svg_head(low, high, margin, width)
    lines.append(f"<metadata id={quoteattr(METADATA)}>{escape(json.dumps(_metadata(pattern, places)))}</metadata>")
    for piece, outline, place in zip(pattern.pieces, outlines, places):
        shift = f"translate({float(MM * place[0])!r} {float(0.0 - MM * place[1])!r})"
        lines.append(f"<g transform={quoteattr(shift)}>")
        lines += [*_loops(piece.name, outline, parts, colours), *_marks(piece, outline, parts, colours, allowance)]
        lines.append("</g>")
    write_whole(path, "\n".join([*lines, "</svg>", ""]))
    return [*left_out(pattern, outlines), *(holes_noted(pattern, allowance) if allowance else [])]


def _metadata(pattern: Pattern, places: Sequence[Reals]) -> dict[str, object]:
    """Seams, grain, places in space, and those (2,) [m] of the pieces' origins in the drawing, for its readers."""
    pieces: dict[str, object] = {}
    for piece, place in zip(pattern.pieces, places):
        grain = {} if piece.grain is None else {"grain": piece.grain}
        if own := {**place_of(piece), **grain, ORIGIN: place.tolist()}:
            pieces[piece.name] = own
    seams = {
        name: {"from": stitch.first, "to": stitch.second, "keys": drawn_keys(stitch)}
        for name, stitch in zip(seam_names(pattern), pattern.stitches)
    }
    return {"pieces": pieces, "seams": seams}


def _loops(name: str, outline: Outline, parts: Parts, colours: Mapping[str, str]) -> list[str]:
    """The lines of one piece; of regions that share edges with other loops what is left of them, as no shape."""
    lines, drawn = [], set[int]()
    for loop in outline.loops:
        left = [(e, forward) for e, forward in loop.edges if e not in drawn]
        if not left:
            continue
        own = name if loop.kind == "outline" else f"{name}.{loop.name}"
        what = loop.kind if len(left) == len(loop.edges) else NO_SHAPE
        lines.append(f"<g id={quoteattr(own)} class={quoteattr(what)}>")
        for e, forward in left:
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
    cut = cut_lines(outline, allowance, piece.name) if allowance else []
    for loop in sewn_holes(outline, piece.name, parts) if allowance else []:
        cut += hole_cut_lines(outline, loop, allowance, piece.name)
    for line in cut:
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
