"""Operations of a Gmsh .geo file on what it has drawn: moves, copies and Boolean combinations in the plane."""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType
from typing import Any, Protocol, TypeVar

from restshape.shape.drawings.geo_numbers import Numbers
from restshape.shape.drawings.geo_tokens import Cursor

Result = TypeVar("Result")

Entities = list[tuple[int, int]]
BOOLEANS = {
    "BooleanUnion": "fuse",
    "BooleanDifference": "cut",
    "BooleanIntersection": "intersect",
    "BooleanFragments": "fragment",
}
DIMENSIONS = {"Point": 0, "Curve": 1, "Line": 1, "Surface": 2}


class GeoDrawing(Protocol):
    """What operations need of a file that is being read: see `geo_script.Script`."""

    gmsh: ModuleType
    cursor: Cursor
    kernel: Any
    numbers: Numbers

    def synchronize(self) -> None:
        """Puts what was drawn into gmsh's model."""

    def made(self, line: int, make: Callable[..., Result], *arguments: object) -> Result:
        """What a call of gmsh gives."""


def operation(script: GeoDrawing) -> Entities | None:
    """What the operation that follows leaves as (dimension, tag); None where none follows.

    Raises:
        UserError: it cannot be read or made.
    """
    word = script.cursor.peek()
    if word.text in BOOLEANS:
        script.cursor.next()
        return _boolean(script, BOOLEANS[word.text], word.line)
    move = TRANSFORMS.get(word.text)
    if move is None or script.cursor.peek(1).text != "{":
        return None
    script.cursor.next()
    script.cursor.enter()
    entities = move(script, word.line)
    script.cursor.leave()
    return entities


def _boolean(script: GeoDrawing, call: str, line: int) -> Entities:
    """``BooleanDifference{ Surface{1}; Delete; }{ Surface{2}; Delete; }``, ``(tag) =`` may come first."""
    tag = -1
    if script.cursor.takes("("):
        tag = script.numbers.tag()
        script.cursor.expect(")")
        script.cursor.expect("=")
    if script.kernel is not script.gmsh.model.occ:
        raise script.cursor.error("the built-in kernel combines nothing", 'SetFactory("OpenCASCADE");', line)
    objects, without_objects = _listed(script)
    tools, without_tools = _listed(script)
    combine = getattr(script.kernel, call)
    made, _ = script.made(line, combine, objects, tools, tag, without_objects, without_tools)
    return list(made)


def _listed(script: GeoDrawing) -> tuple[Entities, bool]:
    """The entities in the braces that follow, copied or moved first where these say so, and whether Delete is there."""
    cursor, found, delete = script.cursor, [], False
    cursor.expect("{")
    while not cursor.takes("}"):
        name = cursor.peek().text
        if cursor.takes("Delete"):
            delete = True
            cursor.expect(";")
        elif name in DIMENSIONS:
            cursor.next()
            if cursor.takes("{", ":", "}"):
                script.synchronize()
                found += [tuple(entity) for entity in script.gmsh.model.getEntities(DIMENSIONS[name])]
            else:
                found += [(DIMENSIONS[name], abs(tag)) for tag in script.numbers.tags()]
            cursor.takes(";")
        elif (inner := operation(script)) is not None:
            found += inner
            cursor.takes(";")
        else:
            raise cursor.error(f"points, curves or surfaces are wanted here, not {name!r}")
    return found, delete


def _vector(script: GeoDrawing) -> list[float]:
    line, values = script.cursor.peek().line, script.numbers.list()
    if len(values) != 3:
        raise script.cursor.error(f"3 numbers are wanted here, not {len(values)}", "write {x, y, z}", line)
    return values


def _translate(script: GeoDrawing, line: int) -> Entities:
    by = _vector(script)
    entities, _ = _listed(script)
    script.made(line, script.kernel.translate, entities, *by)
    return entities


def _rotate(script: GeoDrawing, line: int) -> Entities:
    """``Rotate {axis, centre, angle} { ... }``."""
    cursor = script.cursor
    cursor.expect("{")
    axis = _vector(script)
    cursor.expect(",")
    centre = _vector(script)
    cursor.expect(",")
    angle = script.numbers.number()
    cursor.expect("}")
    entities, _ = _listed(script)
    script.made(line, script.kernel.rotate, entities, *centre, *axis, angle)
    return entities


def _dilate(script: GeoDrawing, line: int) -> Entities:
    """``Dilate {centre, factor} { ... }``."""
    cursor = script.cursor
    cursor.expect("{")
    centre = _vector(script)
    cursor.expect(",")
    factors = _vector(script) if cursor.sees("{") else [script.numbers.number()] * 3
    cursor.expect("}")
    entities, _ = _listed(script)
    script.made(line, script.kernel.dilate, entities, *centre, *factors)
    return entities


def _mirror(script: GeoDrawing, line: int) -> Entities:
    """``Symmetry {a, b, c, d} { ... }``: in the plane a x + b y + c z + d = 0."""
    plane = script.numbers.list()
    if len(plane) != 4:
        raise script.cursor.error(f"4 numbers are wanted here, not {len(plane)}", "write {a, b, c, d}", line)
    entities, _ = _listed(script)
    script.made(line, script.kernel.mirror, entities, *plane)
    return entities


def _copy(script: GeoDrawing, line: int) -> Entities:
    entities, _ = _listed(script)
    return list(script.made(line, script.kernel.copy, entities))


TRANSFORMS: dict[str, Callable[[Any, int], Entities]] = {
    "Translate": _translate,
    "Rotate": _rotate,
    "Dilate": _dilate,
    "Symmetry": _mirror,
    "Duplicata": _copy,
}
