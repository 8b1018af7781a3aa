"""An outline as the plain tables of a ``[shape]``: its edges, loops and names as they are."""

from __future__ import annotations

import numpy as np

from restshape.scene.plain_values import Table
from restshape.shape.curves import chord_parameters
from restshape.shape.outline import Edge, Loop, Outline

QUARTER = float(np.tan(np.pi / 8.0))
"""Bulge of a quarter of a circle."""
DIGITS = 14
"""Decimal digits of a circle's centre and radius that count, of numbers as large as the shape."""
ROUNDING = 1e-12
"""Share of the size of the shape by which points of a circle may be off it."""


def shape_tables(outline: Outline) -> Table:
    """The plain tables that give this outline again, with the same names, in metres.

    Round holes with the names of a circle stay circles, and polygons stay polygons; other loops name their edges.
    """
    whole = {loop.name: table for loop in outline.loops if (table := _circle(outline, loop) or _polygon(outline, loop))}
    inside = {e for loop in outline.loops if loop.name in whole for e, _ in loop.edges}
    edges = {edge.name: _edge(outline, i) for i, edge in enumerate(outline.edges) if i not in inside}
    ends = {v for i, edge in enumerate(outline.edges) if i not in inside for v in (edge.start, edge.end)}
    tables: Table = {
        "outline": [outline.edges[e].name for e, _ in outline.loops[0].edges],
        "vertices": {outline.vertex_names[v]: _pair(outline.points[v]) for v in sorted(ends)},
        "edges": edges,
    }
    for key, kind in (("holes", "hole"), ("regions", "region")):
        loops = [loop for loop in outline.loops if loop.kind == kind]
        tables[key] = {
            loop.name: whole.get(loop.name) or {"loop": [outline.edges[e].name for e, _ in loop.edges]}
            for loop in loops
        }
    tables["points"] = {outline.vertex_names[v]: _pair(outline.points[v]) for v in outline.embedded}
    tables["groups"] = {name: list(parts) for name, parts in outline.groups.items()}
    return {key: table for key, table in tables.items() if table}


def _pair(point: np.ndarray) -> list[float]:
    return [float(point[0]), float(point[1])]


def _edge(outline: Outline, index: int) -> Table:
    """The table of one edge."""
    edge, names = outline.edges[index], outline.vertex_names
    table: Table = {edge.kind: [names[edge.start], names[edge.end]]}
    if edge.kind == "arc":
        table["bulge"] = float(outline.bulges[index])
    if edge.inner:
        table["through"] = [_pair(outline.points[i]) for i in edge.inner]
    if edge.kind == "spline":
        table |= _parameters(outline, index, edge)
    if edge.parent != edge.name:
        table["part_of"] = edge.parent
    return table


def _parameters(outline: Outline, index: int, edge: Edge) -> Table:
    """Knots and ends of a spline, where they are not those that it would have without."""
    knots = edge.knots != chord_parameters(outline.points[outline.layout.controls[index]])
    ends = edge.ends != ("natural", "natural")
    return ({"knots": list(edge.knots[1:-1])} if knots else {}) | ({"ends": list(edge.ends)} if ends else {})


def _own_corners(outline: Outline, loop: Loop, kind: str) -> np.ndarray | None:
    """The corners (n, 2) of a loop whose edges and vertices are named by it, in their order; None of another one."""
    if loop.kind == "outline":
        return None
    own = {outline.edges[e].name: outline.edges[e] for e, _ in loop.edges}
    n, places = len(own), {name: i for i, name in enumerate(outline.vertex_names)}
    corners = []
    for i in range(1, n + 1):
        edge = own.get(f"{loop.name}.{i}")
        ends = (places.get(f"{loop.name}.v{i}"), places.get(f"{loop.name}.v{i % n + 1}"))
        if edge is None or edge.kind != kind or edge.parent != edge.name or (edge.start, edge.end) != ends:
            return None
        corners.append(outline.points[edge.start])
    return np.array(corners)


def _polygon(outline: Outline, loop: Loop) -> Table | None:
    corners = _own_corners(outline, loop, "line")
    return None if corners is None else {"polygon": [_pair(corner) for corner in corners]}


def _circle(outline: Outline, loop: Loop) -> Table | None:
    corners = _own_corners(outline, loop, "arc")
    if corners is None or len(corners) != 4:
        return None
    bulges = outline.bulges[[e for e, _ in loop.edges]]
    # Without the rounding of the corners, so that a circle that nobody has edited is the same to the last digit.
    digits = DIGITS - int(np.floor(np.log10(outline.size)))
    centre = np.round(0.5 * (corners[0] + corners[2]), digits)
    radius = round(0.5 * float(corners[0, 0] - corners[2, 0]), digits)
    circle = centre + radius * np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    off = max(float(np.abs(circle - corners).max()), float(np.abs(bulges - QUARTER).max()) * radius)
    if radius <= 0.0 or off > ROUNDING * outline.size:
        return None
    return {"circle": {"center": _pair(centre), "radius": radius}}
