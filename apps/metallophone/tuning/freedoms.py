"""What may change as a bar is tuned: numbers of its scene that give its outline or its thickness."""

from __future__ import annotations

from collections.abc import Sequence
from copy import deepcopy
from dataclasses import dataclass
from typing import Any

import numpy as np

from restshape.errors import UserError
from restshape.scene.given_numbers import given_number, value_below
from restshape.scene.load import remade
from restshape.scene.model import CircleLoop, PolygonLoop, Scene
from restshape.scene.overrides import put
from restshape.scene.shape_edges import ArcSpec, PolylineSpec, SplineSpec
from restshape.scene.source import split_key, suggestion
from restshape.shape.build import unchecked_outline
from restshape.shape.outline import Outline

Key = tuple[str, ...]


@dataclass(frozen=True)
class Freedom:
    """A number that may change.

    Args:
        key: of the scene.
        start: its value in the scene [SI].
    """

    key: Key
    start: float

    @property
    def name(self) -> str:
        """The key with dots."""
        return ".".join(self.key)


def with_fixed_curves(scene: Scene) -> Scene:
    """The scene with the knots of its splines and the bulges of its arcs written out, so that points alone move them.

    The shape stays as it is.
    """
    drawn = unchecked_outline(scene.shape, scene.folder)
    there = {edge.name: k for k, edge in enumerate(drawn.edges)}
    raw = deepcopy(scene.raw)
    for key, value in _fixed(scene, drawn, there):
        put(raw, key, value, ".".join(key))
    return remade(scene, raw)


def fixed_curves(scene: Scene) -> list[tuple[Key, object]]:
    """Keys that `with_fixed_curves` sets, with their values; those of a scene that has been through it as well."""
    drawn = unchecked_outline(scene.shape, scene.folder)
    return list(_fixed(scene, drawn, {edge.name: k for k, edge in enumerate(drawn.edges)}))


def _fixed(scene: Scene, drawn, there):
    for name, edge in scene.shape.edges.items():
        if name not in there or name not in scene.raw.get("shape", {}).get("edges", {}):
            continue
        if isinstance(edge, SplineSpec):
            yield ("shape", "edges", name, "knots"), [float(one) for one in drawn.edges[there[name]].knots[1:-1]]
        elif isinstance(edge, ArcSpec):
            bulge = float(drawn.bulges[there[name]])
            yield ("shape", "edges", name), {"arc": list(edge.arc), "bulge": bulge} | _parent(edge)


def _parent(edge: ArcSpec) -> dict[str, str]:
    return {"part_of": edge.part_of} if edge.part_of else {}


def freedoms_of(scene: Scene, words: Sequence[str]) -> list[Freedom]:
    """The numbers that words name, or by default all points of the outline.

    Args:
        scene: whose curves are fixed.
        words: keys, or names of vertices, edges and holes; "outline" stands for all points of it.

    Raises:
        UserError: there is no such freedom, or one is given by a formula or named twice.
    """
    keys = [key for word in words or ["outline"] for key in keys_of(scene, word)]
    if not words:
        keys = [key for key in keys if given_number(scene, key) is None]
        if not keys:
            remedy = f"name freedoms, such as {' '.join(f'--by {name}' for name in _beside_points(scene))}"
            raise UserError("all points of the outline are given by formulas", "--by", remedy)
    twice = next((key for key in keys if keys.count(key) > 1), None)
    if twice:
        raise UserError(f"{'.'.join(twice)} is named twice", "--by", "name each freedom once")
    return [Freedom(key, _number(scene, key)) for key in keys]


def _beside_points(scene: Scene) -> list[str]:
    """Words for freedoms of a scene that are no points: its parameters, and thicknesses that are numbers."""
    materials = [f"material.{name}.thickness" for name in scene.material]
    numbers = [name for name in materials if isinstance(value_below(scene, split_key(name)), int | float)]
    return [*scene.parameters, *numbers]


def keys_of(scene: Scene, word: str) -> list[Key]:
    """The keys of the numbers that a word stands for.

    Raises:
        UserError: it stands for none, or for what no tool changes.
    """
    shape = scene.shape
    if word == "outline":
        bent = [name for name, edge in shape.edges.items() if isinstance(edge, SplineSpec | PolylineSpec)]
        return [key for name in [*shape.vertices, *bent] for key in keys_of(scene, name)]
    key = split_key(word)
    if key[0] in shape.vertices:
        key = ("shape", "vertices", *key)
    elif key[0] in shape.edges:
        key = ("shape", "edges", *key) if len(key) > 1 else ("shape", "edges", key[0], "through")
    elif key[0] in shape.holes:
        key = ("shape", "holes", *key)
    elif key[0] in scene.parameters:
        key = ("parameters", *key)
    return _numbers_below(scene, key, word)


def _numbers_below(scene: Scene, key: Key, word: str) -> list[Key]:
    here = value_below(scene, key)
    if isinstance(here, CircleLoop):
        return [(*key, "circle", "center", "0"), (*key, "circle", "center", "1"), (*key, "circle", "radius")]
    if isinstance(here, PolygonLoop):
        return _numbers_below(scene, (*key, "polygon"), word)
    if isinstance(here, list | tuple):
        return [one for k in range(len(here)) for one in _numbers_below(scene, (*key, str(k)), word)]
    if isinstance(here, int | float) and not isinstance(here, bool):
        _refuse_table(key, word)
        return [key]
    names = [*scene.shape.vertices, *scene.shape.edges, *scene.shape.holes, *scene.parameters]
    hint = suggestion(word, sorted(names))
    remedy = "name a vertex, a spline, a hole, a parameter, or a key such as material.brass.thickness"
    raise UserError(f"there is no freedom {word!r} in this scene", "--by", f"{hint}; or {remedy}" if hint else remedy)


def _refuse_table(key: Key, word: str) -> None:
    movable = key[0] in ("shape", "parameters") or (key[0] == "material" and key[-1] == "thickness")
    if not movable or "knots" in key or key[-1] == "bulge":
        remedy = "name points of the shape, parameters, or the thickness of a material"
        raise UserError(f"{word} is no freedom of a bar: no tool changes it", "--by", remedy)


def _number(scene: Scene, key: Key) -> float:
    given = given_number(scene, key)
    if given is not None:
        names = ", ".join(f"parameters.{name}" for name in given.formula.parameters)
        raise UserError(f"{'.'.join(key)} is given by the formula {given.formula.text!r}", "--by", f"name {names}")
    return float(value_below(scene, key))


def with_values(scene: Scene, freedoms: Sequence[Freedom], values: np.ndarray) -> Scene:
    """The scene with other values (k,) of its freedoms.

    Raises:
        UserError: they make no scene.
    """
    raw = deepcopy(scene.raw)
    for freedom, value in zip(freedoms, values):
        *above, last = freedom.key
        here: Any = raw
        for part in above:
            here = here[int(part)] if isinstance(here, list) else here[part]
        here[int(last) if isinstance(here, list) else last] = float(value)
    return remade(scene, raw)


def point_of(outline: Outline, key: Key) -> tuple[int, int] | None:
    """The control point that a key moves alone, and along which axis; None where it does something else."""
    if key[:2] == ("shape", "vertices") and len(key) == 4:
        return outline.vertex_names.index(key[2]), int(key[3])
    if key[:2] == ("shape", "edges") and key[3:4] == ("through",) and len(key) == 6:
        edge = next(edge for edge in outline.edges if edge.name == key[2])
        return edge.inner[int(key[4])], int(key[5])
    return None
