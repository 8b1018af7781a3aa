"""Panels that are cut on the fold: unfolded about an edge, which stays a straight line in the mesh."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TypeVar

from restshape.errors import UserError
from restshape.scene.dart_keys import IMAGE
from restshape.scene.model import Circle, CircleLoop, EdgeLoop, PolygonLoop, ShapeSpec
from restshape.scene.shape_edges import ArcSpec, EdgeSpec, LineSpec

Pair = tuple[float, float]
Loop = CircleLoop | EdgeLoop | PolygonLoop
Shape = TypeVar("Shape", bound=ShapeSpec)


def unfolded(panel: Shape, fold: str) -> Shape:
    """A panel with its other half: entities of that are named ``mirror.NAME``, all of it is the region ``mirror``.

    Args:
        panel: one half, whose outline has the fold.
        fold: name of the straight edge that it is unfolded about.

    Raises:
        UserError: there is no such edge around it, it is not straight, or a name is taken.
    """
    edge, around = panel.edges.get(fold), list(panel.outline or ())
    if edge is None or fold not in around:
        do = f"edges around it: {', '.join(around)}"
        raise UserError(f"there is no edge {fold!r} around the panel to unfold it about", "mirror", do)
    if not isinstance(edge, LineSpec):
        raise UserError(f"the edge {fold!r} is no straight line: a fold is one", "mirror", "name a line")
    if taken := next((one for one in panel.kinds() if one.partition(".")[0] == IMAGE), None):
        raise UserError(f"the name {taken!r} is that of the panel's other half", "mirror", "rename it")
    start, end = edge.line
    if not {start, end} <= panel.vertices.keys():
        return panel
    reflect = reflection(panel.vertices[start], panel.vertices[end])
    place = around.index(fold)
    own = [*around[place + 1 :], *around[:place]]
    outline = [*own, *(f"{IMAGE}.{name}" for name in reversed(own))]
    still = {start, end, fold}
    regions = panel.regions | {
        IMAGE: EdgeLoop.model_construct(loop=[fold, *(f"{IMAGE}.{name}" for name in own)]),
        **{f"{IMAGE}.{name}": _loop(loop, reflect, still) for name, loop in panel.regions.items()},
    }
    update = {
        "outline": outline,
        "vertices": _both(panel.vertices, reflect, still),
        "points": _both(panel.points, reflect, set()),
        "edges": _both(panel.edges, lambda one: _edge(one, reflect, still), still),
        "holes": _both(panel.holes, lambda one: _loop(one, reflect, still), set()),
        "regions": regions,
        "groups": _both(panel.groups, lambda one: [_image(name, still) for name in one], set()),
    }
    return panel.model_copy(update=update)


Value = TypeVar("Value")


def _both(table: Mapping[str, Value], image: Callable[[Value], Value], still: set[str]) -> dict[str, Value]:
    """A table with the images of what it holds, but for what lies on the fold."""
    images = {f"{IMAGE}.{name}": image(value) for name, value in table.items() if name not in still}
    return {**table, **images}


def _image(name: str, still: set[str]) -> str:
    return name if name in still else f"{IMAGE}.{name}"


def reflection(a: Pair, b: Pair) -> Callable[[Pair], Pair]:
    """Takes a point to its image about the line through two."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    length = math.hypot(dx, dy) or 1.0
    dx, dy = dx / length, dy / length

    def reflect(p: Pair) -> Pair:
        off = 2.0 * (dx * (p[1] - a[1]) - dy * (p[0] - a[0]))
        return p[0] + off * dy, p[1] - off * dx

    return reflect


def _edge(edge: EdgeSpec, reflect: Callable[[Pair], Pair], still: set[str]) -> EdgeSpec:
    start, end = getattr(edge, edge.kind)
    update: dict[str, object] = {edge.kind: (_image(start, still), _image(end, still))}
    if edge.part_of is not None:
        update["part_of"] = f"{IMAGE}.{edge.part_of}"
    if isinstance(edge, ArcSpec):
        update["through"] = None if edge.through is None else reflect(edge.through)
        update["bulge"] = None if edge.bulge is None else -edge.bulge
    elif not isinstance(edge, LineSpec):
        update["through"] = [reflect(p) for p in edge.through]
    return edge.model_copy(update=update)


def _loop(loop: Loop, reflect: Callable[[Pair], Pair], still: set[str]) -> Loop:
    if isinstance(loop, EdgeLoop):
        return EdgeLoop.model_construct(loop=[_image(name, still) for name in loop.loop])
    if isinstance(loop, PolygonLoop):
        return PolygonLoop.model_construct(polygon=[reflect(p) for p in loop.polygon])
    circle = Circle.model_construct(center=reflect(loop.circle.center), radius=loop.circle.radius)
    return CircleLoop.model_construct(circle=circle)
