"""Wedges of material around points of a plane outline: where its sides turn, and where materials meet."""

from __future__ import annotations

from cmath import exp, phase
from collections.abc import Iterator
from dataclasses import dataclass
from math import atan, pi

import numpy as np

from restshape.fem.region_materials import materials_of_regions
from restshape.mesh.regions import contains, loop_polygon, signed_area
from restshape.scene.model import Scene
from restshape.shape.outline import Outline

SMALL = 1e-6
"""Share of the shape's size below which two places are one, and angle [rad] below which two directions are."""


@dataclass(frozen=True)
class Wedge:
    """The material around a point, counter-clockwise.

    Args:
        point: index of the control point.
        sides: indices of the boundary edges that it lies between, the first side's first; none around an inner point.
        along: direction of the first side away from the point, x + i y of length 1.
        sectors: angle [rad] and name of the material of each part, counter-clockwise from the first side.
        within: it is a point inside a polyline.
    """

    point: int
    sides: tuple[int, ...]
    along: complex
    sectors: tuple[tuple[float, str], ...]
    within: bool

    @property
    def angle(self) -> float:
        """Of all parts [rad]."""
        return sum(angle for angle, _ in self.sectors)


@dataclass(frozen=True)
class _Ray:
    """A border between materials as it leaves a point: its direction, x + i y, and the material to its left."""

    direction: complex
    left: str
    within: bool


def wedges(scene: Scene, outline: Outline) -> Iterator[Wedge]:
    """All wedges at the border of the body, and those at points inside of it at which materials meet."""
    materials = _side_materials(scene, outline)
    places = (outline.points @ [1.0, 1j]).tolist()
    rays = _rays(outline, materials, places)
    for loop in outline.loops:
        if loop.kind == "region":
            continue
        for (before, forward), (after, onward) in zip((loop.edges[-1], *loop.edges[:-1]), loop.edges, strict=True):
            edge, left = outline.edges[after], materials[after][0 if onward else 1]
            # Both directions point away from the vertex.
            back, along = _leaving(outline, before, not forward, places), _leaving(outline, after, onward, places)
            vertex = edge.start if onward else edge.end
            sectors = _sectors(along, _angle(along, back), left, rays.pop(vertex, []))
            yield Wedge(vertex, (after, before), along, sectors, False)
            for point, forth, towards in _turns(outline, after, onward):
                yield Wedge(point, (after, after), forth, ((_angle(forth, towards), left),), True)
    for point, around in rays.items():
        first, *others = sorted(around, key=lambda ray: phase(ray.direction))
        sectors = _sectors(first.direction, 2.0 * pi, first.left, others)
        yield Wedge(point, (), first.direction, sectors, all(ray.within for ray in around))


def _angle(first: complex, last: complex) -> float:
    """From a direction to another [rad], counter-clockwise, above 0."""
    return phase(last * first.conjugate()) % (2.0 * pi) or 2.0 * pi


def _sectors(along: complex, angle: float, left: str, rays: list[_Ray]) -> tuple[tuple[float, str], ...]:
    """The parts of an angle that starts at a direction with a material to its left, cut by rays."""
    inner = sorted((_angle(along, ray.direction), ray.left) for ray in rays)
    starts = [(0.0, left), *((at, name) for at, name in inner if SMALL < at < angle - SMALL)]
    ends = [*(at for at, _ in starts[1:]), angle]
    return tuple((end - start, name) for (start, name), end in zip(starts, ends, strict=True))


def _leaving(outline: Outline, index: int, onward: bool, places: list[complex]) -> complex:
    """The direction in which an edge leaves its start, or its end where it is gone along backwards.

    Args:
        outline: of the edge with this index; places: x + i y of its control points.
        onward: from its start.
    """
    edge = outline.edges[index]
    if edge.kind in ("line", "arc"):
        # Half of the arc's angle, from the chord.
        chord, turn = places[edge.end] - places[edge.start], exp(2j * atan(outline.bulges[index]))
        way = chord / turn if onward else -chord * turn
    else:
        way = complex(*outline.tangent(index, 0.0)[0]) if onward else -complex(*outline.tangent(index, 1.0)[0])
    return way / abs(way)


def _turns(outline: Outline, edge: int, onward: bool) -> Iterator[tuple[int, complex, complex]]:
    """The inner points of a polyline, each with its directions onward and back."""
    if outline.edges[edge].kind != "polyline":
        return
    controls = outline.layout.controls[edge][:: 1 if onward else -1].tolist()
    steps = np.diff(outline.points[controls], axis=0) @ [1.0, 1j]
    steps /= np.abs(steps)
    for point, came, goes in zip(controls[1:-1], steps[:-1].tolist(), steps[1:].tolist(), strict=True):
        yield point, goes, -came


def _side_materials(scene: Scene, outline: Outline) -> list[tuple[str, str]]:
    """The materials to the left and to the right of each edge, as if the body went on beyond its border."""
    rest, by_region = materials_of_regions(scene, outline)
    rest = rest or next(iter(by_region.values()), "")
    loops = [loop for loop in outline.loops if loop.kind == "region"]
    if not loops:
        return [(rest, rest)] * len(outline.edges)
    chains = [outline.polyline(edge) for edge in range(len(outline.edges))]
    along = np.array([chain[1] - chain[0] for chain in chains])
    middle = np.array([chain[:2].mean(axis=0) for chain in chains])
    left = SMALL * outline.size * np.column_stack([-along[:, 1], along[:, 0]]) / np.hypot(*along.T)[:, None]
    found = np.full((2, len(chains)), rest, dtype=object)
    polygons = [(loop_polygon(outline, loop), by_region.get(loop.name, rest)) for loop in loops]
    # From the largest to the smallest: the innermost region has the last word.
    for polygon, name in sorted(polygons, key=lambda item: -abs(signed_area(item[0]))):
        for row, places in zip(found, (middle + left, middle - left), strict=True):
            row[contains(polygon, places)] = name
    return list(zip(*found.tolist(), strict=True))


def _rays(outline: Outline, materials: list[tuple[str, str]], places: list[complex]) -> dict[int, list[_Ray]]:
    """What leaves points of borders between two materials, by point; `places` as of `_leaving`."""
    border = {edge for loop in outline.loops if loop.kind != "region" for edge, _ in loop.edges}
    found: dict[int, list[_Ray]] = {}
    for edge, (left, right) in enumerate(materials):
        if edge in border or left == right:
            continue
        for point, onward, side in ((outline.edges[edge].start, True, left), (outline.edges[edge].end, False, right)):
            found.setdefault(point, []).append(_Ray(_leaving(outline, edge, onward, places), side, False))
        for point, forth, back in _turns(outline, edge, True):
            found.setdefault(point, []).extend([_Ray(forth, left, True), _Ray(back, right, True)])
    return found
