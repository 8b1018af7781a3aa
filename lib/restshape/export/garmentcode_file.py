"""Sewing patterns as files of GarmentCode: see `restshape.shape.patterns.garmentcode`."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import numpy as np

from restshape.arrays import Reals
from restshape.export.pattern_marks import regions_at_others
from restshape.outputs.atomic_files import write_whole
from restshape.outputs.kinds import EXPORT_MARK
from restshape.outputs.si_numbers import counted
from restshape.scene.plain_values import Table, table_in
from restshape.shape.curves import arc_centre
from restshape.shape.drawings.bsplines import beziers_of, cubic_of
from restshape.shape.outline import Outline
from restshape.shape.patterns.pattern import Pattern, PatternPiece, Stitch
from restshape.shape.patterns.pattern_axes import turned_up

PROPERTIES: Table = {"normalize_panel_translation": False, "normalized_edge_loops": True, "units_in_meter": 100}
PROBES = np.linspace(0.0, 1.0, 12)[1:-1]
EASE = 0.05
"""Share by which edges may differ that are sewn one by one in a seam of several."""
SAME = 1e-11
"""Share of its size by which a spline may be off a cubic that it is."""


def write_garmentcode(pattern: Pattern, path: Path) -> list[str]:
    """Writes a pattern; what it leaves out: holes, and seams of several edges that do not pair one by one.

    Lines, arcs and splines of one cubic are as they are; other splines and polylines become several edges. What a file
    had besides is in it again.

    Raises:
        OSError: it cannot be written.
    """
    pattern = turned_up(pattern, "y")
    properties = {**(table_in(pattern.kept, "properties") or PROPERTIES), "curvature_coords": "relative"}
    unit = properties.setdefault("units_in_meter", 100)
    assert isinstance(unit, int | float), "readers see to that"
    notes: list[str] = []
    panels: Table = {}
    sides: dict[str, list[Table]] = {}
    lengths: dict[str, float] = {}
    for piece in pattern.pieces:
        outline = piece.outline()
        name = piece.file_name or piece.name
        panel = _PanelTable(piece, outline, float(unit))
        panels[name] = panel.table()
        lengths |= {f"{piece.name}.{edge.name}": outline.length(e) for e, edge in enumerate(outline.edges)}
        for edge, numbers in panel.numbers.items():
            sides[f"{piece.name}.{edge}"] = [{"panel": name, "edge": number} for number in numbers]
        if holes := outline.names("hole"):
            notes.append(f"left out, for panels have no holes: {', '.join(f'{piece.name}.{hole}' for hole in holes)}")
        shared = regions_at_others(outline)
        if regions := [f"{piece.name}.{region}" for region in outline.names("region") if region not in shared]:
            notes.append(f"left out, for panels have no lines within: {', '.join(regions)}")
    stitches, left = _stitches(pattern, sides, lengths)
    if left:
        count = f"{len(left)} of {counted(len(pattern.stitches), 'seam')}"
        notes.append(f"left out, {count}, for they do not join edges one by one: {'; '.join(left)}")
    if keys := sorted({key for stitch in pattern.stitches for key in stitch.keys}):
        notes.append(f"left out, for stitches have none: {', '.join(keys)} of seams")
    own = {**table_in(pattern.kept, "pattern")}
    kept = {key: value for key, value in pattern.kept.items() if key not in ("pattern", "properties", "note")}
    mine: Table = {"note": EXPORT_MARK, "pattern": {"panels": panels, "stitches": stitches, **own}}
    whole = {**mine, **kept, "properties": properties}
    write_whole(path, json.dumps(whole, indent=1) + "\n")
    return notes


def _stitches(
    pattern: Pattern, sides: Mapping[str, list[Table]], lengths: Mapping[str, float]
) -> tuple[list[list[object]], list[str]]:
    """Stitches of single edges, and those that are left out.

    Args:
        pattern: with its seams; sides: of the edges that each edge became; lengths: of all edges [m], by name.
    """
    found: list[list[object]] = []
    left = []
    for stitch in pattern.stitches:
        drawn = all(len(sides.get(edge, [])) == 1 for edge in (*stitch.first, *stitch.second))
        pairs = _one_by_one(stitch, lengths) if drawn else []
        if not pairs:
            left.append(f"{', '.join(stitch.first)} to {', '.join(stitch.second)}")
            continue
        for first, second in pairs:
            one, other = ({**sides[edge][0], **kept} for edge, kept in zip((first, second), stitch.kept))
            more = one.pop("more", [])
            found.append([one, other, *(more if isinstance(more, list) else [])])
    return found, left


def _one_by_one(stitch: Stitch, lengths: Mapping[str, float]) -> list[tuple[str, str]]:
    """The edges of a seam in pairs, in the order of its sides or against it; none where they are not of one length."""
    first, second = stitch.first, stitch.second
    if len(first) == 1 and len(second) == 1:
        return [(first[0], second[0])]
    for other in (second, second[::-1]):
        pairs = list(zip(first, other))
        near = all(abs(lengths[a] - lengths[b]) <= EASE * max(lengths[a], lengths[b]) for a, b in pairs)
        if near and len(first) == len(second):
            return pairs
    return []


@dataclass
class _PanelTable:
    """Makes the table of a panel.

    Args:
        piece: that it is; outline: of it; unit: units in a metre.
        numbers: of the edges that each edge of the outline becomes.
    """

    piece: PatternPiece
    outline: Outline
    unit: float
    numbers: dict[str, list[int]] = field(default_factory=dict)
    corners: list[list[float]] = field(default_factory=list)
    places: dict[int, int] = field(default_factory=dict)

    def table(self) -> Table:
        """The table of the panel; `numbers` is filled in."""
        edges: list[Table] = []
        for index, forward in self._ring():
            edge = self.outline.edges[index]
            ends = (edge.start, edge.end) if forward else (edge.end, edge.start)
            curves = self._curves(index)
            if not forward:
                curves = [curve[::-1] for curve in reversed(curves)]
            inner = [self._corner(curve[-1]) for curve in curves[:-1]]
            chain = [self._vertex(ends[0]), *inner, self._vertex(ends[1])]
            self.numbers[edge.name] = list(range(len(edges), len(edges) + len(curves)))
            bulge = float(self.outline.bulges[index]) * (1.0 if forward else -1.0) if edge.kind == "arc" else 0.0
            kept = self.piece.kept_edges.get(edge.name, {})
            for pair, curve in zip(pairwise(chain), curves):
                edges.append({"endpoints": list(pair), **_curvature(curve * self.unit, bulge), **kept})
        move = [x * self.unit for x in self.piece.move]
        turn = [float(x) for x in np.degrees(self.piece.turn)]
        return {"translation": move, "rotation": turn, "vertices": self.corners, "edges": edges, **self.piece.kept}

    def _ring(self) -> list[tuple[int, bool]]:
        """The edges around it in the order of its file, from the start of the first one, with their directions."""
        loop = self.outline.loops[0].edges
        first = min(range(len(loop)), key=lambda k: loop[k][0])
        ring = [*loop[first:], *loop[:first]]
        if ring[0][1]:
            return ring
        return [(edge, not forward) for edge, forward in (ring[0], *reversed(ring[1:]))]

    def _vertex(self, index: int) -> int:
        if index not in self.places:
            self.places[index] = self._corner(self.outline.points[index])
        return self.places[index]

    def _corner(self, point: Reals) -> int:
        self.corners.append([float(x) for x in point * self.unit])
        return len(self.corners) - 1

    def _curves(self, index: int) -> list[Reals]:
        """The curves of an edge: (2, 2) of lines and arcs, (4, 2) of cubic ones."""
        edge = self.outline.edges[index]
        points = self.outline.points[self.outline.layout.controls[index]]
        if edge.kind == "polyline":
            return [np.array(pair) for pair in pairwise(points)]
        if edge.kind != "spline":
            return [points]
        whole = cubic_of(points, edge.knots, edge.ends)
        a, p, q, b = (np.asarray(whole(s)) for s in (0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0))
        # The control points of the cubic that has these values.
        controls = np.array([a, (-5 * a + 18 * p - 9 * q + 2 * b) / 6.0, (2 * a - 9 * p + 18 * q - 5 * b) / 6.0, b])
        s = PROBES[:, None]
        share = [(1 - s) ** 3, 3 * s * (1 - s) ** 2, 3 * s**2 * (1 - s), s**3]
        off = np.abs(sum(weight * point for weight, point in zip(share, controls)) - whole(PROBES)).max()
        whole_one = off <= SAME * np.ptp(points, axis=0).max()
        return [controls] if whole_one else list(beziers_of(points, edge.knots, edge.ends))


def _curvature(curve: Reals, bulge: float) -> Table:
    """The key of a curve in units of the file; none of a line.

    Args:
        curve: (2, 2) of lines and arcs, (4, 2) of cubic ones; bulge: of an arc, else 0.
    """
    a, b = curve[0], curve[-1]
    if bulge:
        radius = arc_centre(a, b, bulge)[1]
        return {"curvature": {"type": "circle", "params": [radius, int(abs(bulge) > 1.0), int(bulge > 0.0)]}}
    if len(curve) == 2:
        return {}
    p, q = curve[1:3]
    third = np.abs(a - 3.0 * p + 3.0 * q - b).max()
    along = b - a
    left = np.array([-along[1], along[0]])
    inner = [0.25 * (3.0 * p - a + 3.0 * q - b)] if third <= SAME * np.ptp(curve, axis=0).max() else [p, q]
    shares = [[float((point - a) @ axis / (along @ along)) for axis in (along, left)] for point in inner]
    return {"curvature": {"type": "quadratic" if len(inner) == 1 else "cubic", "params": shares}}
