"""Loose curves, as drawing files hold them, joined into closed loops and given names."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from restshape.arrays import Reals
from restshape.errors import UserError
from restshape.scene.plain_values import Table
from restshape.shape import curves
from restshape.shape.drawings.closed_splines import cut_closed
from restshape.shape.drawings.gaps import Gap, Joints, closed, joints
from restshape.shape.drawings.loose_curve import Curve
from restshape.shape.drawings.named_points import points_inside, vertex_names


@dataclass
class ClosedCurve:
    """A closed chain of curves: (index, forward)."""

    chain: list[tuple[int, bool]]
    area: float = 0.0


def shape_data(
    loose_curves: list[Curve], where: str, tolerance: float = 0.0, points: Mapping[str, Reals] | None = None
) -> tuple[Table, list[Gap]]:
    """Loose curves as the plain tables of a ``[shape]``: the largest loop is the outline, others holes or regions.

    An edge alone on its layer has the layer's name; several get ``LAYER-1``, ``LAYER-2`` ... and a group LAYER, which
    layers of these names, as exports have them, give as well. A loop that has a layer for itself has the layer's name,
    and is a region where the curves say so. A point where curves meet names that vertex; one inside of the material is
    a point of the shape; others, and repeated names, are left out.

    Args:
        loose_curves: the curves.
        where: the file, for messages.
        tolerance: the largest gap between two open ends that is closed [m].
        points: (2,) by name [m].

    Returns:
        The tables, and the gaps that were closed, the largest first.

    Raises:
        UserError: no curve, or loops that are open or branch.
    """
    if not loose_curves:
        raise UserError("no curve was found", where, "draw lines, arcs, circles or splines")
    everything = np.concatenate([curve.points for curve in loose_curves])
    size = float(np.hypot(*np.ptp(everything, axis=0)))
    loose_curves, own_gaps = cut_closed(loose_curves, size, tolerance)
    starts, stops = (np.array([curve.points[end] for curve in loose_curves]) for end in (0, -1))
    found, gaps = closed(joints(starts, stops, size), tolerance, [curve.source for curve in loose_curves])
    rings = _rings(loose_curves, found, where)
    ends, corners = found.ends, found.corners
    for ring in rings:
        ring.area = abs(_area(loose_curves, ring.chain))
    rings.sort(key=lambda ring: -ring.area)
    loops = _loop_names(loose_curves, rings)
    names, groups = _edge_names(loose_curves, set(loops))
    taken = {*names, *loops, *groups}
    named = vertex_names(points or {}, corners, size, taken)
    vertex = _vertex_names(named, len(corners), taken)
    edges = {
        names[i]: _edge_data(curve, vertex[ends[i][0]], vertex[ends[i][1]]) for i, curve in enumerate(loose_curves)
    }
    holes, regions, inner = _inner_loops(loose_curves, rings[1:], loops[1:], names)
    border, others = ([curve for i, curve in enumerate(loose_curves) if (i in inner) is part] for part in (False, True))
    left = {name: point for name, point in (points or {}).items() if name not in {*taken, *vertex}}
    tables: Table = {
        "vertices": {v: _pair(p) for v, p in zip(vertex, corners)},
        "edges": edges,
        "outline": [names[i] for i, _ in rings[0].chain],
        "holes": holes,
        "regions": regions,
        "groups": groups,
        "points": points_inside(left, border, others, size),
    }
    return tables, sorted(own_gaps + gaps, key=lambda gap: -gap.size)


def _inner_loops(
    loose_curves: list[Curve], rings: list[ClosedCurve], loops: list[str], names: list[str]
) -> tuple[Table, Table, set[int]]:
    """Holes and regions by name, and the curves of the regions; arguments: curves, loops, names of loops and curves."""
    holes: Table = {}
    regions: Table = {}
    inner: set[int] = set()
    for name, ring in zip(loops, rings):
        filled = any(loose_curves[i].region is not None for i, _ in ring.chain)
        inner.update(i for i, _ in ring.chain if filled)
        (regions if filled else holes)[name] = {"loop": [names[i] for i, _ in ring.chain]}
    return holes, regions, inner


def _vertex_names(named: Mapping[int, str], count: int, taken: set[str]) -> list[str]:
    """Names of all vertices: those that are named by their places, others p1, p2, ... with as many p as it takes."""
    plain = [named.get(i, f"p{i + 1}") for i in range(count)]
    letters = "p"
    while len(set(plain)) < count or set(plain) & taken:
        letters += "p"
        plain = [named.get(i, f"{letters}{i + 1}") for i in range(count)]
    return plain


def _pair(p: Reals) -> list[float]:
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


def _rings(loose_curves: list[Curve], found: Joints, where: str) -> list[ClosedCurve]:
    ends = found.ends
    at: dict[int, list[int]] = {}
    for i, pair in enumerate(ends):
        for v in pair:
            at.setdefault(v, []).append(i)
    for v, touching in at.items():
        if len(touching) != 2:
            raise _not_closed(loose_curves, found, v, touching, where)
    rings, left = [], dict.fromkeys(range(len(loose_curves)))
    while left:
        i = next(iter(left))
        chain, v = [], ends[i][0]
        while i in left:
            del left[i]
            forward = ends[i][0] == v
            chain.append((i, forward))
            v = ends[i][1] if forward else ends[i][0]
            i = next((j for j in at[v] if j in left), i)
        rings.append(ClosedCurve(chain))
    return rings


def _not_closed(loose_curves: list[Curve], found: Joints, vertex: int, touching: list[int], where: str) -> UserError:
    """The error of a vertex where not two curves meet."""
    what = "is open" if len(touching) == 1 else f"branches: {len(touching)} curves meet"
    sources = ", ".join(dict.fromkeys(loose_curves[i].source for i in touching))
    x, y = found.corners[vertex]
    message, do = f"an outline {what} at ({x:.6g}, {y:.6g}) [m]: {sources}", "let the curves meet end to end"
    if any(loose_curves[i].label for i in touching):
        do += ", or leave their layer out: shape.layers names those that are read"
    nearest = found.nearest_open(vertex) if len(touching) == 1 else None
    if nearest is not None:
        message += f"; the nearest open end, of {loose_curves[nearest[1]].source}, is {nearest[0]:.3g} m away"
        do += ", or set shape.tolerance to the largest gap that may be closed"
    return UserError(message, where, do)


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
    labels, groups = _members(curve.label for curve in loose_curves), _members(curve.loop for curve in loose_curves)
    names, number = ["outline"], 0
    taken = {"outline"}
    for ring in rings[1:]:
        own = {i for i, _ in ring.chain}
        first = loose_curves[ring.chain[0][0]]
        region = next((loose_curves[i].region for i in own if loose_curves[i].region), None)
        alone = first.label if labels[first.label] == own else ""
        whole = first.loop if groups[first.loop] == own and first.loop not in labels else ""
        name = region or alone or whole
        while not name or name in taken:
            number += 1
            name = f"hole{number}" if f"hole{number}" not in labels else ""
        names.append(name)
        taken.add(name)
    return names


def _members(words: Iterable[str]) -> dict[str, set[int]]:
    """Where each word stands."""
    found: dict[str, set[int]] = {}
    for i, word in enumerate(words):
        found.setdefault(word, set()).add(i)
    return found


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
    return names, _numbered(names, taken) | groups


def _numbered(names: list[str], taken: set[str]) -> dict[str, list[str]]:
    """Groups NAME of edges that are NAME-1, NAME-2, ..., as an exported drawing has them, if nothing has that name."""
    numbers: dict[str, dict[int, str]] = {}
    for name in names:
        stem, dash, number = name.rpartition("-")
        if dash and stem and stem not in taken and number.isdecimal() and not number.startswith("0"):
            numbers.setdefault(stem, {})[int(number)] = name
    whole = {stem: own for stem, own in numbers.items() if len(own) > 1 and max(own) == len(own)}
    return {stem: [own[k] for k in sorted(own)] for stem, own in whole.items()}
