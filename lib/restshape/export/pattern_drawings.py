"""Sewing patterns as DXF with the layers of AAMA and ASTM: pieces side by side, in true size."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
from ezdxf import units

from restshape.arrays import Reals
from restshape.export.dxf_drawing import MM, draw_edge
from restshape.export.pattern_marks import edge_labels, grain_line, notches, regions_at_others
from restshape.export.seam_allowance import cut_lines, hole_cut_lines, holes_noted, sewn_holes
from restshape.outputs.atomic_files import replacing
from restshape.outputs.kinds import EXPORT_MARK
from restshape.scene.plain_values import Table
from restshape.shape.outline import Outline
from restshape.shape.patterns.pattern import Pattern, PatternPiece, Stitch
from restshape.shape.patterns.pattern_axes import turned_up
from restshape.shape.patterns.pattern_drawing import ANNOTATION, CUT, CUTOUT, GRAIN, INTERNAL, NOTCH, SEW
from restshape.shape.patterns.pattern_notes import APPLICATION, keep, place_of
from restshape.shape.patterns.seam_parts import SeamPart, seam_names, seam_parts

GAP = 0.05
"""Room between pieces, over the size of the largest."""
LETTERS = 8e-3
"""Height of names of seams [m]."""
LAYER_OF = {"hole": CUTOUT, "region": INTERNAL}
Parts = Mapping[str, Sequence[SeamPart]]


def write_pattern_dxf(pattern: Pattern, path: Path, allowance: float = 0.0) -> list[str]:
    """Writes a pattern, a block a piece; what it leaves out.

    Layer 1 has the cut line, layer 14 the line of the seams: the same border without an allowance. Layer 4 has notches
    at the ends of seams and points of the shape, 7 the grain, 8 regions, 11 holes, 15 the names of seams. With an
    allowance the seams of sewn holes are on layer 14, too, and their cut lines on 11. Curves stay what they are: LINE,
    ARC, SPLINE, LWPOLYLINE. Names of edges, seams, and where pieces lie in space are extended data.

    Args:
        pattern: to write; path: of the file; allowance: outside of pieces, and inside of sewn holes [m].

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
    keys = {name: own for name, one in zip(seam_names(pattern), pattern.stitches) if (own := drawn_keys(one))}
    if keys:
        keep(space.add_text("Seams", dxfattribs={"layer": ANNOTATION, "invisible": 1}), {"keys": keys})
    for piece, outline, place in zip(pattern.pieces, outlines, side_by_side(outlines, allowance)):
        block = drawing.blocks.new(piece.name)
        block.add_text(f"Piece Name: {piece.name}", dxfattribs={"layer": CUT})
        _draw_piece(block, piece, outline, seam_parts(pattern), allowance)
        insert = space.add_blockref(piece.name, MM * place, dxfattribs={"layer": CUT})
        if where := place_of(piece):
            keep(insert, where)
    with replacing(path) as part:
        drawing.saveas(part)
    return [*left_out(pattern, outlines), *(holes_noted(pattern, allowance) if allowance else [])]


def _draw_piece(block: Any, piece: PatternPiece, outline: Outline, parts: Parts, allowance: float) -> None:
    cut = cut_lines(outline, allowance, piece.name) if allowance else []
    for line in cut:
        block.add_lwpolyline((MM * line).tolist(), close=True, dxfattribs={"layer": CUT})
    sewn = sewn_holes(outline, piece.name, parts) if cut else []
    for loop in sewn:
        for line in hole_cut_lines(outline, loop, allowance, piece.name):
            block.add_lwpolyline((MM * line).tolist(), close=True, dxfattribs={"layer": CUTOUT})
    drawn: set[int] = set()
    for loop in outline.loops:
        own = [e for e, _ in loop.edges if e not in drawn]
        drawn.update(own)
        border = (SEW,) if cut else (CUT, SEW)
        inside = SEW if loop in sewn else LAYER_OF.get(loop.kind, SEW)
        for layer in border if loop.kind == "outline" else (inside,):
            for e in own:
                draw_edge(block, outline, e, {"layer": layer})
                edge = f"{piece.name}.{outline.edges[e].name}"
                region = {"region": loop.name} if layer == INTERNAL else {}
                if layer in (SEW, CUTOUT, INTERNAL):
                    keep(block[-1], {"edge": edge, "seams": [list(part) for part in parts.get(edge, ())], **region})
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


def side_by_side(outlines: Sequence[Outline], allowance: float) -> list[Reals]:
    """Displacements (2,) [m] that bring pieces side by side."""
    boxes = [np.array(outline.bounds()) for outline in outlines]
    gap = GAP * max(float(np.ptp(box, axis=0).max()) for box in boxes) + 2.0 * allowance
    found, x = [], 0.0
    for low, high in boxes:
        found.append(np.array([x - low[0], -low[1]]))
        x += float(high[0] - low[0]) + gap
    return found


def drawn_keys(stitch: Stitch) -> Table:
    """The keys of a seam without its pleats, which are on an edge that is drawn in parts."""
    return {key: value for key, value in stitch.keys.items() if key != "pleats"}


def left_out(pattern: Pattern, outlines: Sequence[Outline]) -> list[str]:
    """Notes of what a drawing has no place for, and of what readers take for no region.

    Args:
        pattern: that is drawn; outlines: of its pieces.
    """
    kept = [piece.name for piece in pattern.pieces if piece.kept or any(piece.kept_edges.values())]
    notes = (
        [f"left out, for drawings have no such keys: what the file says besides of {', '.join(kept)}"] if kept else []
    )
    if pleated := [one.name for one in pattern.stitches if "pleats" in one.keys]:
        notes.append(f"left out, but for the ends of their folds: pleats of the seams {', '.join(pleated)}")
    if lines := [
        f"{piece.name}.{region}"
        for piece, outline in zip(pattern.pieces, outlines)
        for region in regions_at_others(outline)
    ]:
        notes.append(f"drawn as lines, for they share edges with other loops: the regions {', '.join(lines)}")
    return notes
