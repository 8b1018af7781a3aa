"""Places of a plane solid at which stress has no bound, and the quantities that are taken there."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from restshape.mesh.regions import contains, loop_polygon
from restshape.physics.elasticity.corner_exponents import Condition, exponent, kolosov
from restshape.scene.model import Quantity, Scene
from restshape.shape.outline import Outline

BOUNDED = 0.99
"""Exponents from here on count as those of bounded stress: it grows by less than 7 % from a size to a thousandth."""
SMALL = 1e-6
"""Share of the shape's size below which two places are one."""
POINT = "point load"
SUPPORT = "point support"


@dataclass(frozen=True)
class SingularPlace:
    """A place at which stress goes as r^(lambda - 1) with the distance r.

    Args:
        vertex: index in the outline; name: of it.
        cause: "re-entrant corner", "end of a support", "point load" or "point support", for people.
        exponent: the real part of lambda; 0 at a point load or support.
    """

    vertex: int
    name: str
    cause: str
    exponent: float


def singular_places(scene: Scene, outline: Outline) -> list[SingularPlace]:
    """The places of a plane solid at which stress has no bound, by angles, supports and loads of its outline.

    Between materials corners count as those of one body, and the load between vertices as smooth.
    """
    constrained, points = _supports(scene, outline), _points(scene, outline)
    found = [SingularPlace(v, outline.vertex_names[v], cause, 0.0) for v, cause in points.items()]
    corners = (_place(scene, outline, constrained, corner) for corner in _corners(outline))
    return found + [place for place in corners if place is not None and place.vertex not in points]


def singular_quantities(scene: Scene, outline: Outline) -> dict[str, SingularPlace]:
    """The worst singular place of each quantity that does not converge there: stress that is not averaged, and
    displacements and positions of a point that bears a point load.
    """
    if not any(_moves(one) or _unbounded(one) for one in scene.quantities.values()):
        return {}
    places = sorted(singular_places(scene, outline), key=lambda place: place.exponent)
    found = {}
    for name, quantity in scene.quantities.items():
        there = (place for place in places if _diverges(quantity, place) and _holds(outline, quantity, place))
        if (worst := next(there, None)) is not None:
            found[name] = worst
    return found


def warning(name: str, quantity: Quantity, place: SingularPlace) -> str:
    """What is wrong with a quantity at a singular place, and what to ask for instead."""
    what = "stress" if quantity.stress is not None else "displacement"
    if place.exponent:
        how = f"goes as r^{place.exponent - 1.0:.3f}"
    else:
        how = "goes as 1/r" if what == "stress" else "goes as log r"
    do = f'take it away from {place.name}: at = a hole, an edge or a region that leaves it out, or reduce = "mean"'
    if what == "displacement":
        do = "spread the load over an edge, or ask at another place"
    where = f"at the {place.cause} {place.name}" + (", if that bears a force" if place.cause == SUPPORT else "")
    return f"quantities.{name}: {what} {how} {where}: its value is one of the mesh size and does not converge; {do}"


# --- where ------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Corner:
    """Where a boundary edge ends and the next begins: the body is left of both.

    Args:
        vertex: index; before, after: indices of the edges; along: direction of the second edge away from the vertex;
            angle: of the body [rad].
    """

    vertex: int
    before: int
    after: int
    along: np.ndarray
    angle: float


def _corners(outline: Outline) -> Iterator[_Corner]:
    for loop in outline.loops:
        if loop.kind == "region":
            continue
        for (before, forward), (after, onward) in zip((loop.edges[-1], *loop.edges[:-1]), loop.edges, strict=True):
            # Both directions point away from the vertex.
            back = -_direction(outline, before, 1.0) if forward else _direction(outline, before, 0.0)
            along = _direction(outline, after, 0.0) if onward else -_direction(outline, after, 1.0)
            edge = outline.edges[after]
            turn = np.arctan2(along[0] * back[1] - along[1] * back[0], along @ back)
            angle = float(turn % (2.0 * np.pi)) or 2.0 * np.pi
            yield _Corner(edge.start if onward else edge.end, before, after, along, angle)


def _direction(outline: Outline, edge: int, s: float) -> np.ndarray:
    """The direction (2,) in which an edge runs at its start (0) or its end (1)."""
    t = outline.tangent(edge, s)[0]
    return t / np.hypot(*t)


def _supports(scene: Scene, outline: Outline) -> dict[int, set[str]]:
    """The axes in which each constrained edge is constrained."""
    constrained: dict[int, set[str]] = {}
    for support in scene.supports.values():
        for entity in map(outline.entity, support.on):
            loops = [edge for loop in entity.loops for edge, _ in outline.loops[loop].edges]
            for edge in (*entity.edges, *loops):
                constrained.setdefault(edge, set()).update(set("xy").intersection(support.fix))
    return constrained


def _points(scene: Scene, outline: Outline) -> dict[int, str]:
    """Vertices that are loaded or constrained as points, with the cause."""
    found = {}
    on_edges = {v for edge in _supports(scene, outline) for v in (outline.edges[edge].start, outline.edges[edge].end)}
    for support in scene.supports.values():
        for entity in map(outline.entity, support.on):
            found.update({v: SUPPORT for v in entity.vertices if not entity.edges and v not in on_edges})
    for load in scene.loads.values():
        if load.force is None:
            continue
        for entity in map(outline.entity, load.on):
            found.update({v: POINT for v in entity.vertices if not entity.edges})
    return found


def _place(scene: Scene, outline: Outline, constrained: dict[int, set[str]], corner: _Corner) -> SingularPlace | None:
    """What a corner is; None where stress is bounded."""
    axes = [constrained.get(corner.after, set()), constrained.get(corner.before, set())]
    same = axes[0] == axes[1] and len(axes[0]) != 1
    if same and corner.angle < np.pi * (1.0 + SMALL):
        return None
    x, y = corner.along
    turned = {"x": (round(float(x), 9), round(float(-y), 9)), "y": (round(float(y), 9), round(float(x), 9))}
    first, last = (_condition(one, turned) for one in axes)
    nu, strain = _largest_ratio(scene), scene.effects.get("solid", {}).get("model") == "plane_strain"
    found = exponent(round(corner.angle, 7), first, last, round(kolosov(nu, strain), 9))
    if found is None or found.real >= BOUNDED:
        return None
    cause = "end of a support" if axes[0] != axes[1] else "re-entrant corner"
    return SingularPlace(corner.vertex, outline.vertex_names[corner.vertex], cause, found.real)


def _condition(axes: set[str], turned: dict[str, tuple[float, float]]) -> Condition:
    """The constrained directions of a side in axes of which x points along the corner's first side."""
    return ((1.0, 0.0), (0.0, 1.0)) if len(axes) == 2 else tuple(turned[axis] for axis in axes)


def _largest_ratio(scene: Scene) -> float:
    """The largest of Poisson's ratios: at the end of a support it gives the strongest stress."""
    return max((material.nu for material in scene.material.values() if material.nu is not None), default=0.3)


# --- which quantities -------------------------------------------------------------------------------------------------


def _diverges(quantity: Quantity, place: SingularPlace) -> bool:
    """Whether a quantity that holds a place has no limit there."""
    if quantity.stress is not None:
        return _unbounded(quantity)
    return _moves(quantity) and place.cause == POINT


def _moves(quantity: Quantity) -> bool:
    """Whether a quantity follows the displacement of its place."""
    return quantity.displacement is not None or quantity.position is not None


def _unbounded(quantity: Quantity) -> bool:
    return quantity.stress is not None and quantity.reduce not in ("mean", "sum")


def _holds(outline: Outline, quantity: Quantity, place: SingularPlace) -> bool:
    """Whether a quantity is taken over a place."""
    if _moves(quantity):
        return quantity.at is not None and outline.entity(quantity.at).vertices == (place.vertex,)
    if quantity.at is None:
        return True
    entity = outline.entity(quantity.at)
    ends = {v for edge in entity.edges for v in (outline.edges[edge].start, outline.edges[edge].end)}
    if place.vertex in ends or place.vertex in entity.vertices:
        return True
    return any(_inside(outline, loop, place.vertex) for loop in entity.loops)


def _inside(outline: Outline, loop: int, vertex: int) -> bool:
    """Whether a vertex lies in a region, or on its border."""
    if outline.loops[loop].kind != "region":
        return False
    polygon, point = loop_polygon(outline, outline.loops[loop]), outline.points[vertex]
    sides = np.roll(polygon, -1, axis=0) - polygon
    lengths = np.maximum((sides**2).sum(axis=1), 1e-300)
    s = np.clip(((point - polygon) * sides).sum(axis=1) / lengths, 0.0, 1.0)
    nearest = np.hypot(*(polygon + s[:, None] * sides - point).T).min()
    return bool(nearest < SMALL * outline.size or contains(polygon, point[None])[0])
