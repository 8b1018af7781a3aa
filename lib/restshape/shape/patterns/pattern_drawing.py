"""Sewing patterns from DXF drawings with the layers of AAMA and ASTM.

ASTM D6673-10, Standard Practice for Sewn Products Pattern Data Interchange, and the AAMA's before it: a block is a
piece, and the number of a layer is what its lines are.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np

from restshape.arrays import Reals
from restshape.errors import UserError, quoted
from restshape.outputs.kinds import EXPORT_MARK
from restshape.scene.plain_values import Table, table_in
from restshape.shape.drawings.dxf import NO_UNIT, curves_of, metres_in, readable
from restshape.shape.drawings.dxf_blocks import placed
from restshape.shape.drawings.gaps import JOIN
from restshape.shape.drawings.loose_curve import Curve, gathered
from restshape.shape.drawings.named_points import chain_of_curve
from restshape.shape.patterns.pattern import Pattern, PatternPiece, edge_names
from restshape.shape.patterns.pattern_notes import kept, parts_in, placed_by
from restshape.shape.patterns.pattern_pieces import is_in, loops_of, pieces_of, place_in
from restshape.shape.patterns.seam_parts import SeamPart, stitches_of

CUT, TURNS, NOTCH, GRAIN, INTERNAL, CUTOUT, SEW, ANNOTATION = "1", "2", "4", "7", "8", "11", "14", "15"
"""Layers: border of a piece, its corners, notches, the grain, lines inside, openings, line of the seam, texts."""
LAYERS = {
    "3": "curve points",
    "5": "grade references",
    "6": "mirror lines",
    "9": "stripes",
    "10": "plaids",
    "13": "drill holes",
    ANNOTATION: "annotation",
}
"""What other layers hold, by the standard: it is counted."""
TEXTS = ("TEXT", "MTEXT", "ATTRIB", "ATTDEF")
NAME, UNITS = "piece name:", "units:"
TURN = np.radians(20.0)
"""Angle [rad] by which a polyline turns at a corner."""
WITHIN = 1e-6
"""Share of its size by which the line of a seam may leave the box around the cut line."""
LISTED = 8
"""Kinds of things that a note lists."""


def read_pattern_dxf(path: Path) -> Pattern:
    """The pattern of a DXF drawing by the layers of AAMA and ASTM.

    A block that is inserted is a piece; of lines outside of blocks each outermost loop is. Its border is the line of
    the seam, on layer 14, where it has one, else the cut line, on layer 1. Straight pieces of a polyline are one edge
    from corner to corner: at points of layer 2, or without any where it turns by `TURN`. Loops of layer 11 are holes,
    those of layer 8 regions. Points of layer 4 name vertices or are points of the shape; a line of layer 7 gives the
    grain.

    Raises:
        UserError: unreadable, no piece, or a border of entities that no edge can be.
    """
    with readable(path):
        drawing = ezdxf.readfile(path)
        scale, sized = metres_in(drawing)
        space = list(drawing.modelspace())
        if not sized:
            scale, sized = _scale_of_texts(space, scale)
        inserts = [entity for entity in space if entity.dxftype() == "INSERT"]
        loose = [entity for entity in space if entity.dxftype() != "INSERT"]
        groups = [_PieceSheet(path, scale).add(placed([one], drawing.blocks, path.name), one) for one in inserts]
        groups.append(_PieceSheet(path, scale).add(placed(loose, drawing.blocks, path.name)))
        pieces: list[PatternPiece] = []
        unread: Counter[str] = Counter()
        taken: set[str] = set()
        parts: list[tuple[str, SeamPart]] = []
        for sheet in groups:
            for piece in sheet.pieces():
                name = _other_name(piece.name, taken)
                pieces.append(replace(piece, name=name))
            unread += sheet.unread
            parts += sheet.parts
    if not pieces:
        what = f"no piece was found: no closed loop on layer {CUT} or {SEW}"
        do = "draw borders of pieces on layer 1, or lines of seams on layer 14"
        if any(one == ("Writer", EXPORT_MARK) for one in drawing.header.custom_vars):
            do = "`restshape export` made it of a whole shape; restshape pattern SCENE --out FILE.dxf writes pieces"
        raise UserError(what, path.name, do)
    keys = next((table for one in loose if (table := table_in(kept(one), "keys"))), {})
    stitches, left = stitches_of(parts, {name: table_in(keys, name) for name in keys}, edge_names(pieces))
    notes = unread_notes(unread + Counter(left))
    return Pattern(tuple(pieces), stitches, notes=notes, doubt="" if sized else NO_UNIT)


class _PieceSheet:
    """The entities of a block, or those outside of blocks.

    Args:
        path: the file; scale: metres in a unit.
    """

    def __init__(self, path: Path, scale: float) -> None:
        self.path, self.scale = path, scale
        self.name = ""
        self.layers: dict[str, list[Any]] = {}
        self.unread: Counter[str] = Counter()
        self.shift: Reals = np.zeros(2)
        self.place: Table = {}
        self.parts: list[tuple[str, SeamPart]] = []

    def add(self, entities: Iterable[tuple[Any, str]], insert: Any = None) -> _PieceSheet:
        """The same one with its entities sorted; without the place where a block is inserted."""
        if insert is not None:
            self.name = str(insert.dxf.name)
            self.shift = self.scale * np.array(tuple(insert.dxf.insert)[:2], dtype=float)
            self.place = kept(insert)
        for entity, layer in entities:
            kind = entity.dxftype()
            text = _text(entity) if kind in TEXTS else ""
            if text.lower().startswith(NAME) and insert is not None:
                self.name = text[len(NAME) :].strip() or self.name
            elif text.lower().startswith(UNITS) or (kind in TEXTS and kept(entity)):
                continue
            elif kind in TEXTS or not self._known(kind, layer):
                meant = f" ({LAYERS[layer]})" if layer in LAYERS else ""
                self.unread[f"{kind} on layer {layer}{meant}"] += 1
            else:
                self.layers.setdefault(layer, []).append(entity)
        return self

    @staticmethod
    def _known(kind: str, layer: str) -> bool:
        if layer in (NOTCH, TURNS):
            return kind == "POINT"
        return layer in (CUT, SEW, GRAIN, INTERNAL, CUTOUT) and kind != "POINT"

    def pieces(self) -> list[PatternPiece]:
        """The pieces of these entities."""
        loops = loops_of([*self._borders(), *self._cutouts(), *self._regions()])
        for curve in loops.open:
            self.unread[f"{curve.source} that closes no loop"] += 1
        own = [kept(one).get("vertex") for one in self.layers.get(NOTCH, [])]
        labels = [str(label) if label else f"notch{i}" for i, label in enumerate(own, 1)]
        points = dict(zip(labels, self._places(NOTCH)))
        names = [self.name] * len(loops.groups)
        found, missed = pieces_of(loops, names, self.path.name, points, self._grains())
        if missed:
            self.unread[f"POINT on layer {NOTCH} (notches) at no vertex and in no piece"] += missed
        return [placed_by(piece, self.place) for piece in found]

    def _borders(self) -> list[Curve]:
        """The curves around pieces: lines of seams, and cut lines around none of them."""
        sewn, cut = loops_of(self._curves(SEW)), loops_of(self._curves(CUT))
        found = [*(curve for group in sewn.groups for curve in group), *sewn.open, *cut.open]
        inner = [_chains(group[:around]) for group, around in zip(sewn.groups, sewn.around)]
        for group, around in zip(cut.groups, cut.around):
            border = _chains(group[:around])
            if not any(_lies_within(line, border) for line in inner):
                found += group
        return found

    def _cutouts(self) -> list[Curve]:
        """The curves of openings, but cut lines inside of a sewn one."""
        sewn, cut = loops_of(self._curves(SEW)), loops_of(self._curves(CUTOUT))
        inside = [group[around:] for group, around in zip(sewn.groups, sewn.around)]
        inner = [_chains(curves) for curves in _loops([curve for group in inside for curve in group])]
        found = list(cut.open)
        for group, around in zip(cut.groups, cut.around):
            line = _chains(group[:around])
            if not any(_lies_within(line, border) for border in inner):
                found += group
        return found

    def _curves(self, layer: str) -> list[Curve]:
        found = gathered((self._edges(one, layer) for one in self.layers.get(layer, [])), self.path.name)
        return [replace(curve, points=curve.points - self.shift) for curve in found]

    def _edges(self, entity: Any, layer: str) -> list[Curve]:
        """The curves of an entity: one edge with its name where it keeps that."""
        curves = curves_of(entity, layer, "", self.scale, self.path)
        table = kept(entity)
        edge = table.get("edge")
        if not isinstance(edge, str):
            return joined(curves, self._places(TURNS) + self.shift)
        self.parts += [(edge, part) for part in parts_in(table) if (edge, part) not in self.parts]
        region = table.get("region")
        named = [replace(curve, label=edge, region=region if isinstance(region, str) else None) for curve in curves]
        return [_polyline(named)] if all(curve.kind == "line" for curve in named) else named

    def _places(self, layer: str) -> Reals:
        """The points (n, 2) [m] of a layer, in coordinates of the piece."""
        places = [tuple(one.dxf.location)[:2] for one in self.layers.get(layer, [])]
        return self.scale * np.array(places, dtype=float).reshape(-1, 2) - self.shift

    def _regions(self) -> list[Curve]:
        """The curves of loops inside, as regions; those that close none are counted."""
        loops = loops_of(self._curves(INTERNAL))
        for curve in loops.open:
            self.unread[f"{curve.source} (lines inside) that closes no loop"] += 1
        return [
            replace(curve, region=next((one.region for one in group if one.region), f"internal{number}"))
            for number, group in enumerate(loops.groups, 1)
            for curve in group
        ]

    def _grains(self) -> list[tuple[Reals, float]]:
        """A place and the angle of each line of a grain."""
        return [
            (curve.points.mean(axis=0), float(np.arctan2(*(curve.points[-1] - curve.points[0])[::-1])))
            for curve in self._curves(GRAIN)
        ]


def joined(curves: list[Curve], corners: Reals) -> list[Curve]:
    """The curves of one entity with lines that follow each other joined to polylines, from corner to corner.

    Args:
        curves: in their order; corners: (n, 2) [m], none: where lines turn by `TURN`.
    """
    if len(curves) < 3 or any(curve.kind != "line" for curve in curves):
        return curves
    ends = np.array([curve.points[-1] for curve in curves])
    ways = ends - np.array([curve.points[0] for curve in curves])
    after = np.roll(ways, -1, axis=0)
    bend = np.abs(np.arctan2(ways[:, 0] * after[:, 1] - ways[:, 1] * after[:, 0], (ways * after).sum(axis=1)))
    sharp = bend > TURN
    if len(corners):
        near = JOIN * float(np.hypot(*np.ptp(ends, axis=0)))
        sharp = np.hypot(*(ends[:, None] - corners).T).min(axis=0) <= near
    closes = bool(np.hypot(*(curves[0].points[0] - ends[-1])) <= JOIN * float(np.hypot(*np.ptp(ends, axis=0))))
    stops = np.flatnonzero(sharp)
    if closes and len(stops) < 2:
        return curves
    if closes:
        order = np.roll(np.arange(len(curves)), -int(stops[0]) - 1)
        cuts = (stops - stops[0])[1:]
    else:
        order, cuts = np.arange(len(curves)), stops[stops < len(curves) - 1] + 1
    return [_polyline([curves[k] for k in run]) for run in np.split(order, cuts)]


def _polyline(lines: list[Curve]) -> Curve:
    if len(lines) == 1:
        return lines[0]
    points = np.array([lines[0].points[0], *(line.points[-1] for line in lines)])
    return replace(lines[0], points=points, kind="polyline")


def _loops(curves: list[Curve]) -> list[list[Curve]]:
    """The closed loops of curves, none of which is inside another one."""
    loops = loops_of(curves)
    return [group[:around] for group, around in zip(loops.groups, loops.around)]


def _chains(curves: list[Curve]) -> list[Reals]:
    return [chain_of_curve(curve) for curve in curves]


def _lies_within(line: list[Reals], border: list[Reals]) -> bool:
    """Whether a closed line of chains (m, 2) is inside of a closed border, which it may touch."""
    inner, outer = np.concatenate(line), np.concatenate(border)
    low, high = outer.min(axis=0), outer.max(axis=0)
    near = WITHIN * float(np.hypot(*(high - low)))
    boxed = (inner >= low - near).all() and (inner <= high + near).all()
    return bool(boxed) and is_in(place_in(line), border)


def _text(entity: Any) -> str:
    found = entity.dxf.get("text", "") or getattr(entity, "text", "")
    return str(found).strip()


def _scale_of_texts(space: list[Any], scale: float) -> tuple[float, bool]:
    """The metres in a unit by the text that the standard has for it, and whether there is one."""
    for entity in space:
        text = _text(entity).lower() if entity.dxftype() in TEXTS else ""
        if text.startswith(UNITS):
            return (25.4e-3 if "english" in text else 1e-3), True
    return scale, False


def _other_name(name: str, taken: set[str]) -> str:
    number, free = 1, name
    while free in taken:
        number += 1
        free = f"{name}_{number}"
    taken.add(free)
    return free


def unread_notes(unread: Counter[str]) -> tuple[str, ...]:
    """A note of what was not read, counted and named."""
    if not unread:
        return ()
    some = [f"{count} {what}" for what, count in unread.most_common(LISTED)]
    more = sum(unread.values()) - sum(count for _, count in unread.most_common(LISTED))
    return (f"not read: {quoted_list(some)}{f', and {more} more' if more else ''}",)


def quoted_list(texts: list[str]) -> str:
    """Texts of a file, one after the other, each no longer than a message has room for."""
    return ", ".join(quoted(text)[1:-1] for text in texts)
