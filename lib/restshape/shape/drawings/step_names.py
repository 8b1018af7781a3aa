"""Names of edges and faces, and knots, in the text of a STEP file (ISO 10303-21), which gmsh does not hand on."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from restshape.arrays import Reals

FILLER = {"", "none", "unnamed", "null"}
"""What programs write where there is no name, in small letters."""
KINDS = ("Line", "Circle")
NEAR = 1e-6
"""Distance of ends that are the same, over the size of all edges."""
MILLIMETRES = {"": 1e3, "MILLI": 1.0, "CENTI": 10.0, "MICRO": 1e-3, "KILO": 1e6, "INCH": 25.4, "FOOT": 304.8}
"""Of a unit of length, by its SI prefix or its name."""
TYPES = (
    "CARTESIAN_POINT|VERTEX_POINT|EDGE_CURVE|ORIENTED_EDGE|EDGE_LOOP|FACE_BOUND|FACE_OUTER_BOUND|ADVANCED_FACE"
    "|LINE|CIRCLE|B_SPLINE_CURVE_WITH_KNOTS|SURFACE_CURVE|SEAM_CURVE|INTERSECTION_CURVE"
)
_ENTITY = re.compile(rf"#(\d+)\s*=\s*({TYPES})\s*\(\s*'((?:[^']|'')*+)'\s*,((?:[^';]|'(?:[^']|'')*+')*+)\s*;")
_CUBIC = re.compile(r"\s*3\s*,\s*\([^()]*\)\s*,[^()]*\(\s*4\s*,((?:\s*1\s*,)*)\s*4\s*\)\s*,\s*\(([^()]*)\)[^()]*\)\s*")
"""What follows the name of a cubic B-spline whose inner knots are simple: its knots are the last list."""
_LENGTH = re.compile(r"[^;]*\bLENGTH_UNIT\s*\([^;]*")
_UNIT = re.compile(r"SI_UNIT\s*\(\s*(?:\.(\w*)\.|\$)\s*,\s*\.METRE\.|CONVERSION_BASED_UNIT\s*\(\s*'(\w*)'")
_REFERENCE = re.compile(r"#(\d+)")


@dataclass(frozen=True)
class StepEdge:
    """An edge of a STEP file.

    Args:
        name: "" where it has none; at: where in the text it begins.
        ends: (2, 3) its first and last place [mm].
        kind: "Line", "Circle", or "" of other curves.
        knots: of a cubic B-spline with simple inner knots, each once; none of other curves.
    """

    name: str
    at: int
    ends: Reals
    kind: str
    knots: tuple[float, ...] = ()


class StepText:
    """What the text of a STEP file says of edges and faces.

    Args:
        text: of the file.

    Attributes:
        edges: by their number.
    """

    def __init__(self, text: str) -> None:
        self._found = {int(m[1]): m for m in _ENTITY.finditer(re.sub(r"/\*.*?\*/", _blank, text, flags=re.DOTALL))}
        self.edges: dict[int, StepEdge] = {}
        factor = _millimetres(text)
        if factor:
            for number, match in self._found.items():
                if match[2] == "EDGE_CURVE" and (edge := self._edge(match, factor)):
                    self.edges[number] = edge

    def _edge(self, match: re.Match[str], factor: float) -> StepEdge | None:
        """An edge, where its ends are points of the file."""
        numbers = _references(match)
        if len(numbers) < 3:
            return None
        ends = [self._place(vertex) for vertex in numbers[:2]]
        if None in ends:
            return None
        curve = self._curve(numbers[2])
        kind = curve[2].title() if curve else ""
        known = kind if kind in KINDS else ""
        return StepEdge(_name(match[3]), match.start(3), factor * np.array(ends), known, _knots(curve) if curve else ())

    def _curve(self, curve: int) -> re.Match[str] | None:
        """A curve in space, which may be given with its images on surfaces."""
        match = self._found.get(curve)
        if match and match[2].endswith("_CURVE"):
            match = self._found.get(next(iter(_references(match)), 0))
        return match

    def _place(self, vertex: int) -> list[float] | None:
        match = self._found.get(vertex)
        point = self._found.get(next(iter(_references(match)), 0)) if match else None
        if point is None or point[2] != "CARTESIAN_POINT":
            return None
        try:
            place = [float(word) for word in point[4].strip(" ()\r\n").split(",")]
        except ValueError:
            return None
        return place if len(place) == 3 else None

    def faces(self) -> Iterator[tuple[str, list[StepEdge]]]:
        """The name of each face that has one, and its edges."""
        for match in self._found.values():
            if match[2] == "ADVANCED_FACE" and _name(match[3]):
                bounds = self._below([match], ("FACE_BOUND", "FACE_OUTER_BOUND"))
                edges = self._below(
                    self._below(self._below(bounds, ("EDGE_LOOP",)), ("ORIENTED_EDGE",)), ("EDGE_CURVE",)
                )
                numbers = [int(edge[1]) for edge in edges]
                if numbers and all(number in self.edges for number in numbers):
                    yield _name(match[3]), [self.edges[number] for number in numbers]

    def _below(self, matches: Iterable[re.Match[str]], types: tuple[str, ...]) -> list[re.Match[str]]:
        """The entities of some types that others refer to."""
        numbers = [number for match in matches for number in _references(match)]
        return [self._found[number] for number in numbers if number in self._found and self._found[number][2] in types]


def candidates(model: Any, curves: Iterable[int], edges: Iterable[StepEdge]) -> dict[int, list[StepEdge]]:
    """The edges that each curve of a model of gmsh's may be, by its ends and its kind.

    Edges that two faces share may be there twice; a curve that lies elsewhere than the file says, as in an assembly,
    has none.
    """
    known = list(edges)
    found: dict[int, list[StepEdge]] = {tag: [] for tag in curves}
    if not known:
        return found
    ends = np.array([edge.ends for edge in known])
    near = NEAR * float(np.ptp(ends.reshape(-1, 3), axis=0).max())
    for tag, own in ((tag, _ends(model, tag)) for tag in found):
        kind = model.getType(1, tag)
        kind = kind if kind in KINDS else ""
        for way in (own, own[::-1]) if len(own) else ():
            there = (known[k] for k in np.flatnonzero(np.abs(ends - way).max(axis=(1, 2)) <= near))
            found[tag] = found[tag] or [edge for edge in there if edge.kind == kind]
    return found


def knots_in(model: Any, curves: Iterable[int], text: str) -> dict[int, list[tuple[float, ...]]]:
    """The knots that each curve of a model may have, of those that are cubic B-splines with simple inner knots.

    Args:
        model: of gmsh, in mm; curves: of it; text: of the file.
    """
    edges = candidates(model, curves, StepText(text).edges.values())
    found = {curve: list(dict.fromkeys(edge.knots for edge in own if edge.knots)) for curve, own in edges.items()}
    return {curve: knots for curve, knots in found.items() if knots}


def names_in(model: Any, faces: Mapping[int, Iterable[int]], text: str) -> dict[tuple[int, int], str]:
    """Names that a file gives curves and faces of a model, by (dimension, entity).

    Args:
        model: of gmsh, in mm; faces: the curves that bound each; text: of the file.
    """
    known = StepText(text)
    edges = candidates(model, {curve for own in faces.values() for curve in own}, known.edges.values())
    names = {(1, curve): own[0].name for curve, own in edges.items() if len({edge.name for edge in own}) == 1}
    for name, bound in known.faces():
        for face, curves in faces.items():
            own = [{id(edge) for edge in edges[curve]} for curve in curves]
            if len(own) == len(bound) and all(any(id(edge) in one for one in own) for edge in bound):
                names[2, face] = name
    return {entity: name for entity, name in names.items() if name}


def with_names(model: Any, names: Mapping[int, str], text: str) -> str:
    """The text of a STEP file in which edges have the names of curves of the model that it was written from."""
    known = candidates(model, names, StepText(text).edges.values())
    found = {own[0].at: names[tag] for tag, own in known.items() if len(own) == 1}
    for at in sorted(found, reverse=True):
        text = f"{text[:at]}{found[at]}{text[at:]}"
    return text


def _references(match: re.Match[str]) -> list[int]:
    """The numbers of the entities that one refers to."""
    return [int(number) for number in _REFERENCE.findall(match[4])]


def _knots(curve: re.Match[str]) -> tuple[float, ...]:
    """Those of a cubic B-spline with simple inner knots, rising; none of another curve."""
    cubic = _CUBIC.fullmatch(curve[4]) if curve[2] == "B_SPLINE_CURVE_WITH_KNOTS" else None
    try:
        knots = tuple(float(word) for word in cubic[2].split(",")) if cubic else ()
    except ValueError:
        return ()
    simple = cubic is not None and len(knots) == cubic[1].count(",") + 2
    return knots if simple and all(a < b for a, b in pairwise(knots)) else ()


def _name(text: str) -> str:
    text = text.replace("''", "'").strip()
    return "" if text.lower() in FILLER else text


def _blank(match: re.Match[str]) -> str:
    return " " * len(match[0])


def _millimetres(text: str) -> float:
    """Of the file's unit of length; 0 where it is none that is known."""
    unit = next((_UNIT.search(found[0]) for found in _LENGTH.finditer(text) if "_MEASURE" not in found[0]), None)
    return MILLIMETRES.get((unit[1] or unit[2] or "").upper(), 0.0) if unit else 0.0


def _ends(model: Any, tag: int) -> Reals:
    """First and last place (2, 3) of a curve [mm]; (0, 3) where it has none."""
    tags = [abs(point) for _, point in model.getBoundary([(1, tag)], combined=False, oriented=True)]
    return np.array([model.getValue(0, point, []) for point in (tags * 2)[:2]]).reshape(-1, 3)
