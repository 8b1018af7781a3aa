"""Sewing patterns in the format of GarmentCode (JSON).

M. Korosteleva and O. Sorkine-Hornung, GarmentCode: Programming Parametric Sewing Patterns, ACM Transactions on Graphics
42 (6), 2023. Lengths are in units of ``units_in_meter``, y goes up; a panel is turned about x, then y, then z of space,
then moved. Control points of curves are relative to their edge: along it and to its left, in lengths of the edge.
"""

from __future__ import annotations

import json
import math
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from restshape.arrays import Reals
from restshape.bounds import BULGE, DRAWING_BYTES, LENGTH, OUTLINE_PIECES
from restshape.errors import UserError, printable, quoted
from restshape.scene.plain_values import Table
from restshape.shape.drawings.bsplines import edges_of_cubic
from restshape.shape.drawings.layer_names import name_of
from restshape.shape.patterns.pattern import Pattern, PatternPiece, Stitch, Triple, refuse_bad_stitches

KNOTS = np.array([0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0])
CURVES = ("quadratic", "cubic", "circle")
"""Kinds of curves that an edge may have; without any it is a line."""
OWN_KEYS = {"vertices", "edges", "translation", "rotation"}
"""Keys of a panel that are read; all others are kept as they are."""
REACH = 1e-9
"""Share by which half a chord may be longer than the radius of its arc: half a circle, rounded."""


def read_garmentcode(path: Path) -> Pattern:
    """The pattern of a file.

    Keys of the file that are not read are kept: those of the file, of panels, of edges and of stitches.

    Raises:
        UserError: unreadable, or a panel, an edge or a stitch is none; with its place.
    """
    if path.stat().st_size > DRAWING_BYTES:
        raise UserError(f"the pattern is longer than {DRAWING_BYTES} bytes", path.name, "take a smaller one")
    try:
        text = path.read_text(encoding="utf-8")
        whole = json.loads(text)
    except (UnicodeDecodeError, json.JSONDecodeError, RecursionError) as error:
        why = printable(str(error))[:200]
        raise UserError(f"this cannot be read as JSON: {why}", path.name, "save it as GarmentCode does") from None
    except ValueError:
        raise UserError("a whole number has thousands of digits", path.name, "write fewer of them") from None
    return _GarmentCode(path.name, text).pattern(whole)


@dataclass(frozen=True)
class _GarmentCode:
    """Reads what a file holds.

    Args:
        where: the file, for messages; text: of it, for the numbers of lines.
    """

    where: str
    text: str

    def pattern(self, whole: object) -> Pattern:
        """The pattern of the whole file."""
        raw = self._table(self._table(whole, "the file").get("pattern"), "pattern")
        properties = self._table(self._table(whole, "the file").get("properties", {}), "properties")
        unit = self._number(properties.get("units_in_meter", 100.0), "properties.units_in_meter")
        if unit <= 0.0:
            raise self._error(f"{unit:g} units in a metre are none", "properties.units_in_meter", "100 for cm")
        coords = properties.get("curvature_coords", "relative")
        if coords not in ("relative", "absolute"):
            what = f"control points are {quoted(str(coords))}"
            raise self._error(what, "properties.curvature_coords", "relative or absolute")
        panels = self._table(raw.get("panels"), "pattern.panels")
        if not panels:
            raise self._error("the pattern has no panels", "pattern.panels", "draw one")
        names = self._names(list(panels))
        pieces = tuple(self._piece(names[name], name, panel, unit, coords) for name, panel in panels.items())
        stitches = self._stitches(raw.get("stitches", []), names, pieces)
        kept = {key: value for key, value in self._table(whole, "the file").items() if key != "pattern"}
        kept["pattern"] = {key: value for key, value in raw.items() if key not in ("panels", "stitches")}
        doubt = "" if "units_in_meter" in properties else "the pattern has no units_in_meter: it is read in centimetres"
        found = Pattern(pieces, stitches, "y", kept, (), doubt)
        refuse_bad_stitches(found, self.where)
        return found

    def _names(self, panels: list[str]) -> dict[str, str]:
        """Names of pieces by those of panels."""
        names = {panel: name_of(panel).replace(".", "_") or "panel" for panel in panels}
        taken: set[str] = set()
        for panel, name in names.items():
            number, free = 1, name
            while free in taken:
                number += 1
                free = f"{name}_{number}"
            names[panel] = free
            taken.add(free)
        return names

    def _piece(self, name: str, panel: str, raw: object, unit: float, coords: str) -> PatternPiece:
        table, place = self._table(raw, f"panel {panel}"), f"panel {panel}"
        corners = self._points(table.get("vertices"), f"{place}, vertices") / unit
        edges = table.get("edges")
        if not isinstance(edges, list) or not 2 <= len(edges) <= OUTLINE_PIECES:
            raise self._error("a panel has two edges or more", f"{place}, edges", "draw its border")
        if not np.abs(corners).max() <= LENGTH:
            raise self._error(f"it lies farther than {LENGTH:g} m from 0", place, "check units_in_meter")
        ends = [self._ends(edge, len(corners), f"{place}, edge {k}") for k, edge in enumerate(edges)]
        used = sorted({vertex for pair in ends for vertex in pair})
        tables = {
            f"e{k}": self._edge(self._table(edge, place), pair, corners, unit, coords, f"{place}, edge {k}")
            for k, (edge, pair) in enumerate(zip(edges, ends))
        }
        shape: Table = {
            "outline": [f"e{k}" for k in self._ring(ends, place)],
            "vertices": {f"v{i}": [float(x) for x in corners[i]] for i in used},
            "edges": tables,
        }
        kept = {key: value for key, value in table.items() if key not in OWN_KEYS}
        others = {f"e{k}": {key: v for key, v in self._table(edge, place).items()} for k, edge in enumerate(edges)}
        for own in others.values():
            own.pop("endpoints", None)
            own.pop("curvature", None)
        x, y, z = (v / unit for v in self._triple(table.get("translation", [0, 0, 0]), f"{place}, translation"))
        a, b, c = (math.radians(v) for v in self._triple(table.get("rotation", [0, 0, 0]), f"{place}, rotation"))
        kept_edges = {edge: own for edge, own in others.items() if own}
        file_name = panel if name != panel else ""
        return PatternPiece(name, shape, (x, y, z), (a, b, c), None, kept, kept_edges, file_name)

    def _ring(self, ends: list[tuple[int, int]], place: str) -> list[int]:
        """Numbers of the edges around a panel, in their order."""
        at: dict[int, list[int]] = {}
        for k, pair in enumerate(ends):
            for vertex in pair:
                at.setdefault(vertex, []).append(k)
        odd = next((vertex for vertex, touching in at.items() if len(touching) != 2), None)
        if odd is not None:
            touching = ", ".join(map(str, at[odd]))
            what = f"the border is open or branches at vertex {odd}: edges {touching}"
            raise self._error(what, place, "let two edges meet at each vertex")
        ring, here = [0], ends[0][1]
        while len(ring) < len(ends):
            following = next(k for k in at[here] if k != ring[-1])
            if following == ring[0]:
                raise self._error("its edges are several loops", place, "draw one border a panel")
            ring.append(following)
            here = sum(ends[following]) - here
        return ring

    def _ends(self, raw: object, count: int, place: str) -> tuple[int, int]:
        pair = self._table(raw, place).get("endpoints")
        whole = isinstance(pair, list) and len(pair) == 2 and all(type(one) is int for one in pair)
        if not whole or not isinstance(pair, list) or not all(0 <= one < count for one in pair) or pair[0] == pair[1]:
            what = f"its endpoints are {quoted(str(pair))}"
            raise self._error(what, place, f"two numbers of vertices, 0 to {count - 1}")
        return pair[0], pair[1]

    def _edge(self, raw: Table, ends: tuple[int, int], corners: Reals, unit: float, coords: str, place: str) -> Table:
        """The plain table of an edge."""
        names = [f"v{i}" for i in ends]
        a, b = corners[list(ends)]
        curve = raw.get("curvature")
        if curve is None:
            return {"line": names}
        if isinstance(curve, list):
            curve = {"type": "quadratic", "params": [curve]}
        table = self._table(curve, f"{place}, curvature")
        kind, given = table.get("type"), table.get("params")
        if kind not in CURVES:
            raise self._unknown(kind, place)
        if kind == "circle":
            return {"arc": names, "bulge": self._bulge(given, float(np.hypot(*(b - a))), unit, place)}
        points = self._points(given, f"{place}, curvature.params")
        if len(points) != (1 if kind == "quadratic" else 2):
            what = f"a {kind} curve has {len(points)} control points"
            raise self._error(what, place, "one of a quadratic curve, two of a cubic one")
        left = np.array([a[1] - b[1], b[0] - a[0]])
        inner = a + points[:, :1] * (b - a) + points[:, 1:] * left if coords == "relative" else points / unit
        controls = np.array([a, *inner, b])
        if kind == "quadratic":
            controls = np.array([a, (a + 2.0 * inner[0]) / 3.0, (b + 2.0 * inner[0]) / 3.0, b])
        found = edges_of_cubic(KNOTS, controls)
        if len(found) != 1:
            raise self._error("its curve ends where it begins", place, "cut it in two")
        through, knots, smooth = found[0]
        inside = [[float(x) for x in point] for point in through[1:-1]]
        return {"spline": names, "through": inside, "knots": list(knots[1:-1]), "ends": list(smooth)}

    def _bulge(self, given: object, chord: float, unit: float, place: str) -> float:
        """tan(angle/4) of an arc by radius, whether it is the larger one, and whether it bulges to the right."""
        radius, large, right = self._triple(given, f"{place}, curvature.params")
        radius /= unit
        if radius <= 0.0 or 0.5 * chord > radius * (1.0 + REACH):
            what = f"an arc of radius {radius:g} m does not reach over {chord:g} m"
            raise self._error(what, place, f"a radius of {0.5 * chord * unit:g} or more, in the units of the file")
        half = math.tan(0.5 * math.asin(min(1.0, 0.5 * chord / radius)))
        size = 1.0 / half if large else half
        if size > BULGE:
            raise self._error("its arc is bent too much", place, "take a smaller radius")
        return size if right else -size

    def _unknown(self, kind: object, place: str) -> UserError:
        """The error of a curve of a kind that is not known, with its line in the file."""
        found = re.search(rf'"type"\s*:\s*{re.escape(json.dumps(kind))}', self.text)
        line = f", line {self.text.count(chr(10), 0, found.start()) + 1}" if found else ""
        return self._error(f"its curve is of the kind {quoted(str(kind))}{line}", place, f"use {', '.join(CURVES)}")

    def _stitches(self, raw: object, names: dict[str, str], pieces: tuple[PatternPiece, ...]) -> tuple[Stitch, ...]:
        if not isinstance(raw, list):
            raise self._error("stitches are a list", "pattern.stitches", "a list of pairs of sides")
        found = []
        for k, pair in enumerate(raw):
            if not isinstance(pair, list) or len(pair) < 2:
                raise self._error("a stitch has two sides", f"stitch {k}", '{"panel": NAME, "edge": NUMBER} twice')
            first, second = (self._side(side, names, f"stitch {k}") for side in pair[:2])
            others = tuple(
                {key: value for key, value in self._table(side, "").items() if key not in ("panel", "edge")}
                for side in pair[:2]
            )
            if len(pair) > 2:
                others[0]["more"] = pair[2:]
            found.append(Stitch((first,), (second,), (others[0], others[1])))
        return tuple(found)

    def _side(self, raw: object, names: dict[str, str], place: str) -> str:
        """The name of the edge that one side of a stitch is."""
        side = self._table(raw, place)
        panel, edge = side.get("panel"), side.get("edge")
        if not isinstance(panel, str) or panel not in names or type(edge) is not int:
            what = f"it is of the edge {quoted(str(edge))} of the panel {quoted(str(panel))}, which is not there"
            raise self._error(what, place, f"panels: {', '.join(names)}; edges by their numbers")
        return f"{names[panel]}.e{edge}"

    def _points(self, raw: object, place: str) -> Reals:
        """Points (n, 2) of a list of pairs."""
        if not isinstance(raw, list) or not raw or not all(isinstance(p, list) and len(p) == 2 for p in raw):
            raise self._error("it is no list of points", place, "write [[x, y], ...]")
        return np.array([[self._number(x, place) for x in point] for point in raw])

    def _triple(self, raw: object, place: str) -> Triple:
        if not isinstance(raw, list) or len(raw) != 3:
            raise self._error("three numbers are wanted", place, "write [a, b, c]")
        a, b, c = (self._number(x, place) for x in raw)
        return a, b, c

    def _number(self, raw: object, place: str) -> float:
        if isinstance(raw, bool):
            return float(raw)
        if not isinstance(raw, int | float) or not abs(raw) < 1e300:
            raise self._error(f"{quoted(str(raw))} is no number", place, "write a finite number")
        return float(raw)

    def _table(self, raw: object, place: str) -> Table:
        if not isinstance(raw, dict):
            raise self._error("a table is wanted", place, "write { ... }, as GarmentCode does")
        return raw

    def _error(self, what: str, place: str, do: str) -> UserError:
        return UserError(what, ": ".join(filter(None, (self.where, printable(place)))), do)
