"""All pieces of a pattern on one sheet in true size: lines and texts, in millimetres."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from restshape.arrays import Reals
from restshape.export.pattern_marks import edge_labels, grain_line, notches
from restshape.export.seam_allowance import cut_lines, hole_cut_lines, sewn_holes
from restshape.scene.pattern_packing import PanelBounds, Where, packed
from restshape.shape.outline import Loop, Outline
from restshape.shape.patterns.pattern import Pattern, PatternPiece
from restshape.shape.patterns.seam_parts import SeamPart, seam_colours, seam_names, seam_parts

MM = 1e3
CHORD = 2e-5
"""Most distance of what is drawn from a curve [m]."""
NOTCH = 6.0
"""Length of notches without an allowance [mm]."""
HEAD = 5.0
"""Length of the heads of arrows [mm]."""
INK = "#222222"
LETTERS, NAMES = 9.0, 16.0
"""Sizes of the names of seams and of pieces [points]."""
SOLID, DASHED, DOTTED = (), (4.0, 2.0), (1.0, 2.0)


@dataclass(frozen=True)
class SheetLine:
    """A line (m, 2) [mm], its width [points], its colour and dashes."""

    points: Reals
    width: float
    colour: str = INK
    dashes: tuple[float, ...] = SOLID


@dataclass(frozen=True)
class SheetText:
    """A text about its middle (2,) [mm], its size [points], its angle [rad] and colour."""

    text: str
    place: Reals
    size: float
    angle: float = 0.0
    colour: str = INK


@dataclass
class PatternSheet:
    """Lines and texts in millimetres; `seams` are their colours by name."""

    lines: list[SheetLine] = field(default_factory=list)
    texts: list[SheetText] = field(default_factory=list)
    seams: dict[str, str] = field(default_factory=dict)

    @property
    def box(self) -> tuple[Reals, Reals]:
        """Lower and upper corner (2,) of the box around all lines."""
        points = np.concatenate([line.points for line in self.lines])
        return points.min(axis=0), points.max(axis=0)


def pattern_sheet(pattern: Pattern, allowance: float) -> PatternSheet:
    """The pieces of a pattern beside and above each other.

    Lines of seams are dashed inside of the cut line of an allowance, and have the colours of their seams.

    Args:
        pattern: to draw; allowance: outside of pieces, and inside of sewn holes [m], or 0.

    Raises:
        UserError: an allowance cannot be made.
    """
    outlines = {piece.name: piece.outline() for piece in pattern.pieces}
    room = max(allowance, NOTCH / MM)
    boxes = {name: _box(outline, room) for name, outline in outlines.items()}
    frames = packed({name: Where(box, None, 0.0) for name, box in boxes.items()})
    parts = seam_parts(pattern)
    sheet = PatternSheet(seams=seam_colours(seam_names(pattern)))
    for piece in pattern.pieces:
        x, y, _ = frames[piece.name]
        _draw(sheet, piece, outlines[piece.name], np.array([x, y]), parts, allowance)
    return sheet


def _box(outline: Outline, room: float) -> PanelBounds:
    low, high = outline.bounds()
    return PanelBounds(*(low - room).tolist(), *(high + room).tolist())


def _draw(
    sheet: PatternSheet,
    piece: PatternPiece,
    outline: Outline,
    shift: Reals,
    parts: Mapping[str, Sequence[SeamPart]],
    allowance: float,
) -> None:
    """Adds a piece, moved by a shift (2,) [m]."""
    for line in cut_lines(outline, allowance, piece.name) if allowance else []:
        sheet.lines.append(SheetLine(MM * (np.vstack([line, line[:1]]) + shift), 1.0))
    sewn = sewn_holes(outline, piece.name, parts) if allowance else []
    for loop in sewn:
        for line in hole_cut_lines(outline, loop, allowance, piece.name):
            sheet.lines.append(SheetLine(MM * (np.vstack([line, line[:1]]) + shift), 1.0))
    dashed = {"outline", *(loop.name for loop in sewn)} if allowance else ()
    _draw_edges(sheet, piece.name, outline, shift, parts, dashed)
    for notch in notches(outline, piece.name, parts):
        start, length = MM * (notch.place + shift), MM * allowance or NOTCH
        ends = np.array([start, start + length * notch.outward])
        sheet.lines.append(SheetLine(ends, 0.8, sheet.seams[notch.seam]))
    for label in edge_labels(outline, piece.name, parts):
        place = MM * (label.place + shift) - 5.0 * label.outward
        sheet.texts.append(SheetText(label.seam, place, LETTERS, label.angle, sheet.seams[label.seam]))
    low, high = outline.bounds()
    middle = MM * (0.5 * (low + high) + shift)
    if piece.grain is not None:
        sheet.lines += _arrow(MM * (grain_line(outline, piece.grain) + shift))
    wide, high_ = MM * (high - low)
    beside = np.array([0.0, 12.0])
    sheet.texts.append(SheetText(piece.name, middle + beside, NAMES))
    sheet.texts.append(SheetText(f"{wide:.0f} × {high_:.0f} mm", middle - beside, LETTERS))


def _draw_edges(
    sheet: PatternSheet,
    name: str,
    outline: Outline,
    shift: Reals,
    parts: Mapping[str, Sequence[SeamPart]],
    dashed: Collection[str],
) -> None:
    """Adds the edges of a piece: its border, holes and regions; dashed are those of "outline", or of holes by name."""
    drawn: set[int] = set()
    for loop in outline.loops:
        for e, _ in loop.edges:
            if e in drawn:
                continue
            drawn.add(e)
            sewn = parts.get(f"{name}.{outline.edges[e].name}", ())
            dashes = DOTTED if loop.kind == "region" else DASHED if _within(loop, dashed) else SOLID
            colour = sheet.seams[sewn[0].seam] if sewn else INK
            points = MM * (outline.polyline(e, CHORD) + shift)
            sheet.lines.append(SheetLine(points, 0.5 if loop.kind == "region" else 0.8, colour, dashes))
    for vertex in outline.embedded:
        place = MM * (outline.points[vertex] + shift)
        for way in ((2.0, 0.0), (0.0, 2.0)):
            sheet.lines.append(SheetLine(np.array([place - way, place + way]), 0.5))


def _within(loop: Loop, names: Collection[str]) -> bool:
    """Whether a loop is in a set of names, the border of a piece as "outline"."""
    return ("outline" if loop.kind == "outline" else loop.name) in names


def _arrow(ends: Reals) -> list[SheetLine]:
    """A line (2, 2) [mm] with heads at both of its ends."""
    way = ends[1] - ends[0]
    along = HEAD * way / float(np.hypot(*way))
    across = 0.3 * np.array([-along[1], along[0]])
    heads = [
        np.array([end + side * along + across, end, end + side * along - across])
        for end, side in ((ends[0], 1.0), (ends[1], -1.0))
    ]
    return [SheetLine(points, 0.6) for points in (ends, *heads)]
