"""Loose curves, as drawing files hold them, joined into closed loops and given names."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from restshape.errors import UserError
from restshape.scene.plain_values import Table
from restshape.shape import curves

JOIN = 1e-6
"""Ends closer than this share of the drawing's size are one vertex."""


@dataclass
class Curve:
    """A loose curve.

    Args:
        points: (n, 2) [m]: start, what it interpolates, end.
        bulge: of an arc of two points; kind: "line", "arc", "spline" or "polyline".
        label: name of its layer or Physical group; "" for none.
        source: what it is in the file, for messages.
        region: the name of the region that it bounds, if any.
        knots, ends: of a spline, see `restshape.shape.outline.Edge`; no knots: by the lengths of its chords.
    """

    points: np.ndarray
    kind: str
    label: str = ""
    bulge: float = 0.0
    source: str = ""
    region: str | None = None
    knots: tuple[float, ...] = ()
    ends: tuple[str, str] = ("natural", "natural")


@dataclass
class ClosedCurve:
    """A closed chain of curves: (index, forward)."""

    chain: list[tuple[int, bool]]
    area: float = 0.0
    labels: set[str] = field(default_factory=set)


def shape_data(loose_curves: list[Curve], where: str) -> Table:
    """Loose curves as the plain tables of a ``[shape]``: the largest loop is the outline, others holes or regions.

    An edge alone on its layer has the layer's name; several get ``LAYER-1``, ``LAYER-2`` ... and a group LAYER. A loop
    that has a layer for itself has the layer's name, and is a region where the curves say so.

    Args:
        loose_curves: the curves.
        where: the file, for messages.

    Raises:
        UserError: no curve, or loops that are open or branch.
    """
    if not loose_curves:
        raise UserError("no curve was found", where, "draw lines, arcs, circles or splines")
    ends, corners = _joined(loose_curves)
    rings = _rings(loose_curves, ends, corners, where)
    for ring in rings:
        ring.area = abs(_area(loose_curves, ring.chain))
        ring.labels = {loose_curves[i].label for i, _ in ring.chain}
    rings.sort(key=lambda ring: -ring.area)
    loops = _loop_names(loose_curves, rings)
    names, groups = _edge_names(loose_curves, set(loops))
    vertex = [f"p{i + 1}" for i in range(len(corners))]
    while set(vertex) & {*names, *loops, *groups}:
        vertex = [f"p{name}" for name in vertex]
    edges = {
        names[i]: _edge_data(curve, vertex[ends[i][0]], vertex[ends[i][1]]) for i, curve in enumerate(loose_curves)
    }
    holes: Table = {}
    regions: Table = {}
    for name, ring in zip(loops[1:], rings[1:]):
        filled = any(loose_curves[i].region is not None for i, _ in ring.chain)
        (regions if filled else holes)[name] = {"loop": [names[i] for i, _ in ring.chain]}
    return {
        "vertices": {v: _pair(p) for v, p in zip(vertex, corners)},
        "edges": edges,
        "outline": [names[i] for i, _ in rings[0].chain],
        "holes": holes,
        "regions": regions,
        "groups": groups,
    }


def _pair(p: np.ndarray) -> list[float]:
    return [float(p[0]), float(p[1])]


def _edge_data(curve: Curve, start: str, end: str) -> Table:
    data: Table = {curve.kind: [start, end]}
    if curve.kind == "arc":
        data["bulge"] = float(curve.bulge)
    elif curve.kind != "line":
        data["through"] = [_pair(p) for p in curve.points[1:-1]]
    if curve.knots:
        data |= {"knots": list(curve.knots[1:-1]), "ends": list(curve.ends)}
    return data


def _joined(loose_curves: list[Curve]) -> tuple[list[tuple[int, int]], list[np.ndarray]]:
    """Vertices at the ends of each curve, and where they are."""
    everything = np.concatenate([curve.points for curve in loose_curves])
    reach = JOIN * float(np.hypot(*(everything.max(axis=0) - everything.min(axis=0))))
    corners: list[np.ndarray] = []

    def vertex(p: np.ndarray) -> int:
        if corners:
            gaps = np.hypot(*(np.array(corners) - p).T)
            if gaps.min() <= reach:
                return int(gaps.argmin())
        corners.append(p)
        return len(corners) - 1

    return [(vertex(curve.points[0]), vertex(curve.points[-1])) for curve in loose_curves], corners


def _rings(
    loose_curves: list[Curve], ends: list[tuple[int, int]], corners: list[np.ndarray], where: str
) -> list[ClosedCurve]:
    at: dict[int, list[int]] = {}
    for i, pair in enumerate(ends):
        for v in pair:
            at.setdefault(v, []).append(i)
    for v, touching in at.items():
        if len(touching) != 2:
            what = "is open" if len(touching) == 1 else f"branches: {len(touching)} curves meet"
            sources = ", ".join(dict.fromkeys(loose_curves[i].source for i in touching))
            place = f"({corners[v][0]:.6g}, {corners[v][1]:.6g})"
            raise UserError(f"an outline {what} at {place} [m]: {sources}", where, "let the curves meet end to end")
    rings, left = [], set(range(len(loose_curves)))
    while left:
        i = min(left)
        chain, v = [], ends[i][0]
        while i in left:
            left.discard(i)
            forward = ends[i][0] == v
            chain.append((i, forward))
            v = ends[i][1] if forward else ends[i][0]
            i = next((j for j in at[v] if j in left), i)
        rings.append(ClosedCurve(chain))
    return rings


def _area(loose_curves: list[Curve], chain: list[tuple[int, bool]]) -> float:
    total = 0.0
    for i, forward in chain:
        curve = loose_curves[i]
        p = curve.points
        part = 0.5 * float(np.sum(p[:-1, 0] * p[1:, 1] - p[1:, 0] * p[:-1, 1]))
        if curve.kind == "arc" and abs(curve.bulge) > 1e-9:
            angle = 4.0 * np.arctan(curve.bulge)
            radius = curves.arc_centre(p[0], p[-1], curve.bulge)[1]
            part += 0.5 * radius**2 * (angle - np.sin(angle))
        total += part if forward else -part
    return total


def _loop_names(loose_curves: list[Curve], rings: list[ClosedCurve]) -> list[str]:
    """Names of the loops: that of a region, of a layer that holds this loop alone, or hole1, hole2, ..."""
    names, number = ["outline"], 0
    for ring in rings[1:]:
        own = {i for i, _ in ring.chain}
        region = next((loose_curves[i].region for i in own if loose_curves[i].region), None)
        label = next(iter(ring.labels)) if len(ring.labels) == 1 else ""
        alone = label and all(i in own for i, curve in enumerate(loose_curves) if curve.label == label)
        name = region or (label if alone else "")
        used = {*names, *(curve.label for curve in loose_curves if curve.label != name)}
        while not name or name in names:
            number += 1
            name = f"hole{number}" if f"hole{number}" not in used else ""
        names.append(name)
    return names


def _edge_names(loose_curves: list[Curve], loops: set[str]) -> tuple[list[str], dict[str, list[str]]]:
    """Names of the edges, and groups for layers of several edges that are not a loop's own."""
    count: dict[str, int] = {}
    for curve in loose_curves:
        count[curve.label] = count.get(curve.label, 0) + 1
    names: list[str] = []
    groups: dict[str, list[str]] = {}
    numbers: dict[str, int] = {}
    taken = loops | set(count)
    for curve in loose_curves:
        label = curve.label
        if label and count[label] == 1 and label not in loops:
            names.append(label)
            continue
        stem = label or "edge"
        name = stem
        while name in taken or name == stem:
            numbers[stem] = numbers.get(stem, 0) + 1
            name = f"{stem}-{numbers[stem]}" if label else f"{stem}{numbers[stem]}"
        taken.add(name)
        names.append(name)
        if label and label not in loops:
            groups.setdefault(label, []).append(name)
    return names, groups
