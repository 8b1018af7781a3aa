"""Outlines as DXF drawings."""

from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
from ezdxf import units

from restshape.shape.curves import arc_centre
from restshape.shape.outline import Outline


def write_dxf(outline: Outline, path: Path) -> None:
    """Writes a shape as a DXF drawing in metres: one layer an edge, for holes and regions one a loop.

    The layer of a region gets ``region_`` before its name, so that it is read back as one.

    Lines, arcs and polylines are exact; splines are written with fit points.
    """
    drawing = ezdxf.new("R2010", units=units.M)
    space = drawing.modelspace()
    for loop in outline.loops:
        for e, _ in loop.edges:
            edge = outline.edges[e]
            layer = edge.name if loop.kind == "outline" else loop.name
            if loop.kind == "region" and not layer.lower().startswith("region"):
                layer = f"region_{layer}"
            _write_edge(space, outline, e, {"layer": layer})
    drawing.saveas(path)


def _write_edge(space: Any, outline: Outline, index: int, look: dict[str, str]) -> None:
    edge = outline.edges[index]
    points = outline.points[outline.layout.controls[index]]
    bulge = float(outline.bulges[index])
    if edge.kind == "polyline":
        space.add_lwpolyline(points.tolist(), dxfattribs=look)
    elif edge.kind == "spline":
        space.add_spline([(x, y, 0.0) for x, y in points], dxfattribs=look)
    elif abs(bulge) < 1e-12:
        space.add_line(points[0], points[1], dxfattribs=look)
    else:
        center, radius = arc_centre(points[0], points[1], bulge)
        first, last = (points[0], points[1]) if bulge > 0.0 else (points[1], points[0])
        angles = [float(np.degrees(np.arctan2(*(p - center)[::-1]))) for p in (first, last)]
        space.add_arc(center, radius, *angles, dxfattribs=look)
