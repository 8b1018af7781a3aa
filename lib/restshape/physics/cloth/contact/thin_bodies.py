"""Bodies that are small beside the cloth, and what they have to bear."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

from restshape.scene.bodies import Body, MeshBody
from restshape.scene.duals import Dual
from restshape.scene.expressions import Value
from restshape.scene.model import Scene
from restshape.scene.panels import panels_of, whole
from restshape.scene.space_values import number

if TYPE_CHECKING:
    from restshape.mesh.surface_distance import SurfaceDistance

BORNE = 10.0
"""Multiple of the cloth's own weight that contact bears at half of its thickness, at least."""
SPARE = 1.5
"""Multiple of what a body bears on which the whole cloth lies."""


def borne(scene: Scene, thickness: float, bodies: Mapping[str, Body] | None = None) -> tuple[float, str]:
    """How many times the cloth's weight by area contact must bear at half of its thickness [m], and what asks for it.

    All of a cloth may come to lie on one thin body, which has little of its area below it. On one that is thin beside
    the mesh, each flat triangle lies on a point. What hangs over an edge pulls on the quarter of a circle around it.
    Bodies are those of the scene, or given as numbers; dual ones, and such a thickness, give a dual multiple.
    """
    sides, size = _sides(scene), scene.mesh.size or 0.0
    loads, causes = {}, {}
    for name, body in (bodies or _evaluated_bodies(scene)).items():
        whole = _concentration(sides, body) * max(1.0, size / (min(_diameters(body)) + 2.0 * thickness))
        edge = 0.5 * max(sides) / (0.5 * math.pi * (_edge_radius(body) + thickness))
        loads[name] = SPARE * max(whole, edge)
        causes[name] = (
            "is small and may have to bear all of the cloth" if whole >= edge else "has edges that cloth hangs over"
        )
    most = max(loads, key=loads.__getitem__, default="")
    if not most or loads[most] <= BORNE:
        return BORNE, ""
    return loads[most], f"bodies.{most} {causes[most]}"


def _evaluated_bodies(scene: Scene) -> dict[str, Body]:
    return {name: body.evaluated(scene.parameters) for name, body in scene.bodies.items()}


def _sides(scene: Scene) -> tuple[float, float]:
    """Width and height [m] of the pattern's vertices; 0 of one that comes from a file.

    Of panels they are those of the largest group that is sewn together, one above the other, wherever they lie.
    """
    panels = panels_of(scene)
    if not panels:
        return _box(scene, scene.shape.vertices.values())
    group = {name: name for name in panels}
    for seam in scene.seams.values():
        names = [edge.partition(".")[0] for side in seam.sides for edge in side]
        joined = {group[name] for name in names}
        group |= {name: group[names[0]] for name, one in group.items() if one in joined}
    boxes = {name: _box(scene, whole(name, panel).vertices.values()) for name, panel in panels.items()}
    groups = [[boxes[name] for name in panels if group[name] == one] for one in set(group.values())]
    width, height = max(((max(w for w, _ in own), sum(h for _, h in own)) for own in groups), key=math.prod)
    return width, height


def _box(scene: Scene, vertices: Iterable[Sequence[Value]]) -> tuple[float, float]:
    points = [[number(value, scene.parameters) for value in point] for point in vertices]
    width, height = (max(column) - min(column) for column in zip(*points)) if points else (0.0, 0.0)
    return width, height


def _diameters(body: Body) -> tuple[float, float]:
    """The two smaller ways through a body [m]."""
    form = body.form
    match body.kind:
        case "sphere":
            return 2.0 * form.radius, 2.0 * form.radius
        case "capsule":
            return 2.0 * form.radius, 2.0 * form.radius + _distance(form.start, form.end)
        case "cylinder":
            first, second, _ = sorted((2.0 * form.radius, 2.0 * form.radius, _distance(form.start, form.end)))
            return first, second
        case "box":
            first, second, _ = sorted(form.half)
            return 2.0 * first, 2.0 * second
        case "mesh" | "mannequin":
            surface = _surface(form).X
            first, second, _ = sorted((surface.max(axis=0) - surface.min(axis=0)).tolist())
            return first * form.scale, second * form.scale
        case _:
            return math.inf, math.inf


def _surface(form: MeshBody) -> SurfaceDistance:
    # Imported here: scenes are checked, and reports written, without kernels.
    from restshape.physics.cloth.contact.mesh_bodies import distance_of

    return distance_of(form)


def _distance(start: Sequence[float], end: Sequence[float]) -> float:
    if any(isinstance(value, Dual) for value in (*start, *end)):
        return sum((a - b) ** 2 for a, b in zip(start, end)) ** 0.5
    return math.dist(start, end)


def _edge_radius(body: Body) -> float:
    """The radius of a body's edges [m]; infinite without any."""
    match body.kind:
        case "box":
            return body.form.radius
        case "cylinder":
            return body.form.rounded
        case "mesh" | "mannequin":
            return _surface(body.form).facts.edge * body.form.scale
        case _:
            return math.inf


def _concentration(sides: tuple[float, float], body: Body) -> float:
    """The cloth's area over that of it which a body can have below it, at worst."""
    first, second = _diameters(body)
    ways = ((first, second), (second, first))
    return max(math.prod(max(side / across, 1.0) for side, across in zip(sides, way)) for way in ways)
