"""Places of a plane solid at which stress has no bound, and the quantities that are taken there."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from restshape.mesh.regions import contains, loop_polygon
from restshape.mesh.thickness import Thickness
from restshape.physics.elasticity.corner_exponents import Condition, Sector, bonded_exponent, exponent, kolosov
from restshape.physics.elasticity.wedges import SMALL, Wedge, wedges
from restshape.scene.model import Quantity, Scene
from restshape.shape.nearness import distances
from restshape.shape.outline import Outline

BOUNDED = 0.99
"""Exponents from here on count as those of bounded stress: it grows by less than 7 % from a size to a thousandth."""
TURN = np.radians(15.0) + 1e-6
"""Turn of the border at a point inside of a polyline [rad] up to which the polyline stands for a smooth curve."""
STRAIGHT = np.radians(1.0)
"""Turn of the border between two materials [rad] below which it is smooth at a vertex."""
NAMED = 3
"""Places that a warning names."""
MATERIALS = "meeting of materials"
POINT = "point load"
SUPPORT = "point support"


@dataclass(frozen=True)
class SingularPlace:
    """A place at which stress goes as r^(lambda - 1) with the distance r.

    Args:
        point: index of the control point in the outline; name: of the vertex, or such as "top, point 1".
        cause: "re-entrant corner", "end of a support", "meeting of materials", "point load" or "point support", for
            people.
        exponent: the real part of lambda; 0 at a point load or support.
    """

    point: int
    name: str
    cause: str
    exponent: float


def singular_places(
    scene: Scene, outline: Outline, asked: Callable[[int], bool] | None = lambda point: True
) -> list[SingularPlace]:
    """The places of a plane solid at which stress has no bound, by angles, supports and loads of its outline.

    Points inside of polylines that turn by no more than `TURN` count as those of a smooth curve, and the load between
    vertices as smooth.

    Args:
        scene, outline: of the solid.
        asked: whether a control point is asked for where no force is taken or borne at a point: exponents take time.
            None: no such point is.
    """
    constrained = _supports(scene, outline)
    points = _points(scene, outline, constrained)
    found = [SingularPlace(v, outline.vertex_names[v], cause, 0.0) for v, cause in points.items()]
    if asked is None:
        return found
    corners = (wedge for wedge in wedges(scene, outline) if wedge.point not in points and asked(wedge.point))
    others = (_place(scene, constrained, outline, wedge) for wedge in corners)
    return found + [place for place in others if place is not None]


def singular_quantities(scene: Scene, outline: Outline) -> dict[str, SingularPlace]:
    """The worst singular place of each quantity that does not converge there: see `places_of_quantities`."""
    return {name: places[0] for name, places in places_of_quantities(scene, outline).items()}


def places_of_quantities(scene: Scene, outline: Outline) -> dict[str, list[SingularPlace]]:
    """The singular places, the worst first, of each quantity that does not converge there: stress that is not averaged,
    and displacements and positions of a point that bears a point load.
    """
    if not any(_moves(one) or _unbounded(one) for one in scene.quantities.values()):
        return {}
    stresses = [one for one in scene.quantities.values() if _unbounded(one)]
    if not (stresses or any(load.force is not None for load in scene.loads.values())):
        # Nothing else makes displacements unbounded.
        return {}

    def asked(point: int) -> bool:
        return any(_holds(outline, one, point) for one in stresses)

    places = sorted(singular_places(scene, outline, asked if stresses else None), key=lambda place: place.exponent)
    found = {}
    for name, quantity in scene.quantities.items():
        there = [place for place in places if _diverges(quantity, place) and _holds(outline, quantity, place.point)]
        if there:
            found[name] = there
    return found


def worst_places(places: Mapping[str, Sequence[SingularPlace]]) -> tuple[dict[str, float], tuple[int, ...]]:
    """The least exponent of each quantity of `places_of_quantities`, and all control points, the worst first."""
    worst = sorted((place.exponent, place.point) for there in places.values() for place in there)
    points = tuple(dict.fromkeys(point for _, point in worst))
    return {name: there[0].exponent for name, there in places.items()}, points


def exponents_and_points(scene: Scene, outline: Outline) -> tuple[dict[str, float], tuple[int, ...]]:
    """Exponents of the quantities that do not converge, and the control points at fault: `worst_places`."""
    return worst_places(places_of_quantities(scene, outline))


def warning(name: str, quantity: Quantity, places: Sequence[SingularPlace]) -> str:
    """What is wrong with a quantity at singular places, the worst first, and what to ask for instead."""
    place, names = places[0], listed([one.name for one in places])
    what = "stress" if quantity.stress is not None else "displacement"
    if place.exponent:
        how = f"goes as r^{place.exponent - 1.0:.3f}"
    else:
        how = "goes as 1/r" if what == "stress" else "goes as log r"
    do = f'take it away from {names}: at = a hole, an edge or a region that leaves it out, or reduce = "mean"'
    if what == "displacement":
        do = "spread the load over an edge, or ask at another place"
    where = f"at the {place.cause} {place.name}" + (", if that bears a force" if place.cause == SUPPORT else "")
    if len(places) > 1:
        where += f" (and so, or less, at {listed([one.name for one in places[1:]], NAMED - 1)})"
    return f"quantities.{name}: {what} {how} {where}: its value is one of the mesh size and does not converge; {do}"


def listed(names: Sequence[str], most: int = NAMED) -> str:
    """The first names, and how many more there are."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more


# --- where ------------------------------------------------------------------------------------------------------------


def _supports(scene: Scene, outline: Outline) -> dict[int, set[str]]:
    """The axes in which each constrained edge is constrained."""
    constrained: dict[int, set[str]] = {}
    for support in scene.supports.values():
        for entity in map(outline.entity, support.on):
            loops = [edge for loop in entity.loops for edge, _ in outline.loops[loop].edges]
            for edge in (*entity.edges, *loops):
                constrained.setdefault(edge, set()).update(set("xy").intersection(support.fix))
    return constrained


def _points(scene: Scene, outline: Outline, constrained: dict[int, set[str]]) -> dict[int, str]:
    """Vertices that are loaded or constrained as points, with the cause; `constrained` are edges that are."""
    found = {}
    on_edges = {v for edge in constrained for v in (outline.edges[edge].start, outline.edges[edge].end)}
    for support in scene.supports.values():
        for entity in map(outline.entity, support.on):
            found.update({v: SUPPORT for v in entity.vertices if not entity.edges and v not in on_edges})
    for load in scene.loads.values():
        if load.force is None:
            continue
        for entity in map(outline.entity, load.on):
            found.update({v: POINT for v in entity.vertices if not entity.edges})
    return found


def _place(scene: Scene, constrained: dict[int, set[str]], outline: Outline, wedge: Wedge) -> SingularPlace | None:
    """What the place of a wedge is; None where stress is bounded."""
    axes = [constrained.get(edge, set()) for edge in wedge.sides]
    same = len(axes) == 2 and axes[0] == axes[1] and len(axes[0]) != 1
    bounded = same and wedge.angle < np.pi * (1.0 + SMALL)
    if bounded and len(wedge.sectors) == 1:
        return None
    kinds = {name: _kind(scene, name, outline.points[wedge.point]) for name in {name for _, name in wedge.sectors}}
    sectors = _merged([Sector(angle, *kinds[name]) for angle, name in wedge.sectors], not wedge.sides)
    if wedge.within and abs((wedge if wedge.sides else sectors[0]).angle - np.pi) <= TURN:
        return None
    if not wedge.sides:
        found = bonded_exponent(sectors, None, None) if len(sectors) > 1 and not _straight(sectors) else None
        cause = MATERIALS
    else:
        if bounded and len(sectors) == 1:
            return None
        x, y = round(wedge.along.real, 9), round(wedge.along.imag, 9)
        turned = {"x": (x, -y), "y": (y, x)}
        first, last = (_condition(one, turned) for one in axes)
        if len(sectors) == 1:
            found = exponent(sectors[0].angle, first, last, sectors[0].kappa)
        else:
            found = bonded_exponent(sectors, first, last)
        cause = "end of a support" if axes[0] != axes[1] else MATERIALS if len(sectors) > 1 else "re-entrant corner"
    if found is None or found.real >= BOUNDED:
        return None
    return SingularPlace(wedge.point, _name(outline, wedge.point), cause, found.real)


def _kind(scene: Scene, name: str, place: np.ndarray) -> tuple[float, float]:
    """Kolosov's constant of a material, and its shear modulus times its thickness [N/m] at a place (2,)."""
    material = scene.material[name]
    thickness = float(Thickness(material.thickness, scene.parameters).at(place[None])[0])
    strain = scene.effects.get("solid", {}).get("model") == "plane_strain"
    return round(kolosov(material.nu, strain), 9), 0.5 * material.E / (1.0 + material.nu) * thickness


def _merged(sectors: list[Sector], ring: bool) -> tuple[Sector, ...]:
    """Sectors of which no two neighbours are of the same stiffness, with rounded angles and shares of stiffness."""
    stiffest = max(sector.stiffness for sector in sectors)
    found: list[Sector] = []
    for sector in sectors:
        one = sector._replace(stiffness=round(sector.stiffness / stiffest, 9))
        if found and found[-1][1:] == one[1:]:
            one = one._replace(angle=found.pop().angle + one.angle)
        found.append(one)
    if ring and len(found) > 1 and found[0][1:] == found[-1][1:]:
        found[0] = found[0]._replace(angle=found[0].angle + found.pop().angle)
    return tuple(sector._replace(angle=round(sector.angle, 7)) for sector in found)


def _straight(sectors: tuple[Sector, ...]) -> bool:
    """Whether two materials meet along a straight line through the place."""
    return len(sectors) == 2 and abs(sectors[0].angle - np.pi) < STRAIGHT


def _name(outline: Outline, point: int) -> str:
    """The name of a vertex, or of a point inside a polyline, counted from 1 from its start."""
    if point < len(outline.vertex_names):
        return outline.vertex_names[point]
    edge = next(edge for edge in outline.edges if point in edge.inner)
    return f"{edge.name}, point {edge.inner.index(point) + 1}"


def _condition(axes: set[str], turned: dict[str, tuple[float, float]]) -> Condition:
    """The constrained directions of a side in axes of which x points along the corner's first side."""
    return ((1.0, 0.0), (0.0, 1.0)) if len(axes) == 2 else tuple(turned[axis] for axis in axes)


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


def _holds(outline: Outline, quantity: Quantity, point: int) -> bool:
    """Whether a quantity is taken over a control point."""
    if _moves(quantity):
        return quantity.at is not None and outline.entity(quantity.at).vertices == (point,)
    if quantity.at is None:
        return True
    entity = outline.entity(quantity.at)
    if point in outline.control_points(entity):
        return True
    return any(_inside(outline, loop, point) for loop in entity.loops)


def _inside(outline: Outline, loop: int, control: int) -> bool:
    """Whether a control point lies in a region, or on its border."""
    if outline.loops[loop].kind != "region":
        return False
    polygon, point = loop_polygon(outline, outline.loops[loop]), outline.points[control]
    nearest = distances(point[None], polygon, np.roll(polygon, -1, axis=0))[0]
    return bool(nearest < SMALL * outline.size or contains(polygon, point[None])[0])
