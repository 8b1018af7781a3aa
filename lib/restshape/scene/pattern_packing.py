"""Where panels lie in the pattern plane: as they say themselves, or packed in rows."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from restshape.scene.model import ShapeSpec
from restshape.scene.shape_edges import ArcSpec, EdgeSpec, SplineSpec

GAP = 0.1
"""Room between panels that are packed, over the longest side of all boxes around them."""
OVERSHOOT = 0.25
"""How far a spline may leave the box around its points, over the longest way between two that follow each other."""
SLACK = 1.2
"""Area of the square that rows are packed into, over that of the panels with the room around them."""

Pair = tuple[float, float]


class PanelBounds(NamedTuple):
    """A box by its lower and upper corner [m]."""

    x0: float
    y0: float
    x1: float
    y1: float


class PanelFrame(NamedTuple):
    """Where the coordinates of a panel lie in the pattern plane: its origin [m], and their angle [rad]."""

    x: float
    y: float
    angle: float

    def place(self, point: Pair) -> Pair:
        """The place in the pattern plane of a point in the panel's own coordinates [m]."""
        u, v = turned(point, self.angle)
        return self.x + u, self.y + v


class Where(NamedTuple):
    """What a panel says of its place: the box around it when it is turned [m], its origin [m] or None, its angle."""

    box: PanelBounds
    at: Pair | None
    angle: float


def turned(point: Pair, angle: float) -> Pair:
    """A point turned about the origin by an angle [rad]; the same numbers without one."""
    if angle == 0.0:
        return point
    c, s = math.cos(angle), math.sin(angle)
    return c * point[0] - s * point[1], s * point[0] + c * point[1]


def packed(panels: Mapping[str, Where]) -> dict[str, PanelFrame]:
    """Where panels lie: those that say it there, the others above them in rows, the highest first."""
    fixed = {name: panel for name, panel in panels.items() if panel.at is not None}
    free = [name for name, panel in panels.items() if panel.at is None]
    free.sort(key=lambda name: panels[name].box.y0 - panels[name].box.y1)
    frames = {name: PanelFrame(*panel.at, panel.angle) for name, panel in fixed.items() if panel.at is not None}
    sides = [side for panel in panels.values() for side in _sides(panel.box)]
    gap = GAP * max(sides, default=0.0)
    left = min((frames[name].x + panel.box.x0 for name, panel in fixed.items()), default=0.0)
    below = max((frames[name].y + panel.box.y1 + gap for name, panel in fixed.items()), default=0.0)
    width = _row_width([_sides(panels[name].box) for name in free], gap)
    x, y, highest = 0.0, below, 0.0
    for name in free:
        box, (wide, high) = panels[name].box, _sides(panels[name].box)
        if x > 0.0 and x + wide > width:
            x, y, highest = 0.0, y + highest + gap, 0.0
        frames[name] = PanelFrame(left + x - box.x0, y - box.y0, panels[name].angle)
        x, highest = x + wide + gap, max(highest, high)
    return {name: frames[name] for name in panels}


def _row_width(sides: list[Pair], gap: float) -> float:
    area = sum((wide + gap) * (high + gap) for wide, high in sides)
    return max([math.sqrt(SLACK * area), *(wide for wide, _ in sides)])


def _sides(box: PanelBounds) -> Pair:
    return box.x1 - box.x0, box.y1 - box.y0


def bounds(shape: ShapeSpec, angle: float) -> PanelBounds:
    """A box around the edges of a shape that is turned by an angle [rad]: that of lines and arcs, a larger one of
    splines."""
    corners = [turned(point, angle) for edge in shape.edges.values() for point in _around(edge, shape.vertices)]
    x, y = zip(*corners) if corners else ((0.0,), (0.0,))
    return PanelBounds(min(x), min(y), max(x), max(y))


def _around(edge: EdgeSpec, vertices: Mapping[str, Pair]) -> Iterator[Pair]:
    """Points whose box holds an edge, however it is turned; none of an edge between vertices that are not there."""
    ends = getattr(edge, edge.kind)
    if not all(end in vertices for end in ends):
        return
    a, b = (vertices[end] for end in ends)
    yield a
    yield b
    if isinstance(edge, ArcSpec):
        yield from _around_arc(a, b, edge.bulge if edge.bulge is not None else _bulge(a, b, edge.through or a))
        return
    inner = getattr(edge, "through", [])
    way = max((math.dist(p, q) for p, q in zip([a, *inner], [*inner, b])), default=0.0)
    pad = OVERSHOOT * way if isinstance(edge, SplineSpec) else 0.0
    for x, y in inner:
        yield from ((x + dx, y + dy) for dx in (-pad, pad) for dy in (-pad, pad))


def with_bulge(edge: EdgeSpec, vertices: Mapping[str, Pair]) -> EdgeSpec:
    """An arc through a point by its bulge, which does not hang on where the panel lies; all else as it is."""
    if not isinstance(edge, ArcSpec) or edge.through is None or not set(edge.arc) <= vertices.keys():
        return edge
    bulge = _bulge(vertices[edge.arc[0]], vertices[edge.arc[1]], edge.through)
    # One that no arc passes through is left to be refused.
    return edge.model_copy(update={"through": None, "bulge": bulge}) if bulge else edge


def _bulge(a: Pair, b: Pair, through: Pair) -> float:
    """tan(angle / 4) of the arc from a to b through a point, from the angle at which that sees them."""
    u, v = (a[0] - through[0], a[1] - through[1]), (b[0] - through[0], b[1] - through[1])
    seen = math.atan2(u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1])
    return math.copysign(math.tan(0.5 * (math.pi - abs(seen))), -seen) if seen else 0.0


def _around_arc(a: Pair, b: Pair, bulge: float) -> Iterator[Pair]:
    """Corners around an arc: of the slab of its height over its chord, or around its circle where it is the larger part
    of one."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    # To the right of the way from a to b.
    rise = 0.5 * bulge * dy, -0.5 * bulge * dx
    if abs(bulge) <= 1.0:
        yield a[0] + rise[0], a[1] + rise[1]
        yield b[0] + rise[0], b[1] + rise[1]
        return
    chord = math.hypot(dx, dy)
    radius = 0.25 * chord * (abs(bulge) + 1.0 / abs(bulge))
    top = 0.5 * (a[0] + b[0]) + rise[0], 0.5 * (a[1] + b[1]) + rise[1]
    back = radius / (0.5 * chord * abs(bulge))
    centre = top[0] - back * rise[0], top[1] - back * rise[1]
    reach = math.sqrt(2.0) * radius
    yield from ((centre[0] + p, centre[1] + q) for p, q in ((reach, 0.0), (0.0, reach), (-reach, 0.0), (0.0, -reach)))
