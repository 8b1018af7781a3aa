"""An outline as a DXF drawing: lines, arcs, circles and splines as they are, in millimetres."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
from ezdxf import units

from restshape.outputs.atomic_files import replacing
from restshape.outputs.kinds import EXPORT_MARK
from restshape.shape.curves import arc_centre
from restshape.shape.drawings.bsplines import cubic_of
from restshape.shape.outline import Loop, Outline

MM = 1e3
"""Millimetres in a metre."""
FLAT = 1e-5
"""Arcs of smaller bulge are pieces of a polyline with it: centre and radius of so large a circle would lose digits."""
ROUNDING = 1e-12
"""Share of the size of the shape by which arcs of one circle may be off it."""


def write_dxf(outline: Outline, path: Path) -> list[str]:
    """Writes a shape; the names of regions that it leaves out.

    LINE, ARC, CIRCLE (a round hole or region), SPLINE (the B-spline of degree 3 that the edge is), LWPOLYLINE
    (polylines, and arcs that are almost straight) and POINT. Layers have the names of the edges of the outline, of
    holes, of points and of vertices that are not those of a CIRCLE; those of regions begin with
    ``region``. Regions with edges of the outline are left out: in a drawing each curve bounds one area.

    Raises:
        OSError: it cannot be written.
    """
    drawing = ezdxf.new("R2010", units=units.MM)
    drawing.header.custom_vars.append("Writer", EXPORT_MARK)
    space, drawn, left = drawing.modelspace(), set(), []
    named = dict.fromkeys(outline.embedded)
    for loop in outline.loops:
        edges = {e for e, _ in loop.edges}
        if edges & drawn:
            left.append(loop.name)
            continue
        drawn |= edges
        if not _draw_loop(space, outline, loop):
            named.update(dict.fromkeys(v for e in edges for v in (outline.edges[e].start, outline.edges[e].end)))
    for v in named:
        space.add_point(MM * outline.points[v], dxfattribs={"layer": outline.vertex_names[v]})
    for layer in dict.fromkeys(entity.dxf.layer for entity in space):
        drawing.layers.add(layer)
    with replacing(path) as part:
        drawing.saveas(part)
    return left


def _draw_loop(space: Any, outline: Outline, loop: Loop) -> bool:
    """Draws a loop: an edge an entity, or a circle; whether it is a circle."""
    layer = loop.name
    if loop.kind == "region" and not layer.lower().startswith("region"):
        layer = f"region_{layer}"
    circle = circle_of(outline, loop) if loop.kind != "outline" else None
    if circle is not None:
        space.add_circle(MM * circle[0], MM * circle[1], dxfattribs={"layer": layer})
        return True
    for e, _ in loop.edges:
        draw_edge(space, outline, e, {"layer": outline.edges[e].name if loop.kind == "outline" else layer})
    return False


def circle_of(outline: Outline, loop: Loop) -> tuple[np.ndarray, float] | None:
    """Centre (2,) [m] and radius [m] of the circle that a loop of arcs is; None where it is another curve."""
    if any(outline.edges[e].kind != "arc" or abs(outline.bulges[e]) < FLAT for e, _ in loop.edges):
        return None
    found = [arc_centre(*outline.points[outline.layout.controls[e]], float(outline.bulges[e])) for e, _ in loop.edges]
    circles = np.array([[*centre, radius] for centre, radius in found])
    turned = sum((1.0 if forward else -1.0) * np.arctan(outline.bulges[e]) for e, forward in loop.edges)
    whole = abs(abs(turned) - 0.5 * np.pi) < ROUNDING
    if not whole or np.ptp(circles, axis=0).max() > ROUNDING * outline.size:
        return None
    return circles[0, :2], float(circles[0, 2])


def draw_edge(space: Any, outline: Outline, index: int, look: dict[str, str]) -> None:
    """Draws one edge."""
    edge, bulge = outline.edges[index], float(outline.bulges[index])
    points = MM * outline.points[outline.layout.controls[index]]
    if edge.kind == "polyline":
        space.add_lwpolyline(points.tolist(), dxfattribs=look)
    elif edge.kind == "spline":
        curve = cubic_of(points, edge.knots, edge.ends)
        space.add_open_spline([(x, y, 0.0) for x, y in curve.c], 3, curve.t.tolist(), dxfattribs=look)
    elif bulge == 0.0:
        space.add_line(points[0], points[1], dxfattribs=look)
    elif abs(bulge) < FLAT:
        space.add_lwpolyline([(*points[0], bulge), (*points[1], 0.0)], format="xyb", dxfattribs=look)
    else:
        centre, radius = arc_centre(points[0], points[1], bulge)
        first, last = (points[0], points[1]) if bulge > 0.0 else (points[1], points[0])
        angles = [float(np.degrees(np.arctan2(*(p - centre)[::-1]))) for p in (first, last)]
        space.add_arc(centre, radius, *angles, dxfattribs=look)
