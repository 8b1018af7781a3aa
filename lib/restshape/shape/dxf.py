"""Outlines from DXF drawings."""

from __future__ import annotations

import re
from itertools import pairwise
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
from ezdxf import units

from restshape.errors import UserError
from restshape.shape.unordered_curves import Curve, shape_data

NO_NAME = ("0", "Defpoints")
IGNORED = ("TEXT", "MTEXT", "DIMENSION", "POINT", "LEADER")
SPLINE_POINTS = 8
"""Points that stand for a B-spline, for each of its control points."""


def read_dxf(path: Path) -> dict[str, Any]:
    """The plain tables of a ``[shape]`` from a DXF drawing, in metres by its ``$INSUNITS`` (none: millimetres).

    Closed loops of LINE, ARC, CIRCLE, LWPOLYLINE, POLYLINE and SPLINE in model space; the largest is the outline.
    Layers name edges, holes and groups; a loop on a layer ``region...`` is a region. Lines and arcs are exact; a SPLINE
    with fit points interpolates them, one with control points alone interpolates 8 points of it for each of them.
    Texts, dimensions and points are ignored.

    Raises:
        UserError: unreadable, other entities, or open loops.
    """
    try:
        drawing = ezdxf.readfile(path)
    except (OSError, ezdxf.DXFError) as error:
        raise UserError(
            f"this cannot be read as DXF: {error}", path.name, "save it as ASCII DXF R2000 or later"
        ) from error
    unit = int(drawing.header.get("$INSUNITS", 0))
    scale = units.conversion_factor(unit, units.M) if unit else 1e-3
    loose_curves: list[Curve] = []
    for entity in drawing.modelspace():
        kind, layer = entity.dxftype(), entity.dxf.layer
        if kind in IGNORED:
            continue
        found = _curves(entity, kind)
        if found is None:
            raise UserError(
                f"{kind} on layer {layer!r} cannot be part of an outline",
                path.name,
                "use LINE, ARC, CIRCLE, LWPOLYLINE, POLYLINE or SPLINE (explode blocks and hatches)",
            )
        label = "" if layer in NO_NAME else _name(layer)
        for points, form, bulge in found:
            xy = np.asarray(points, dtype=float)[:, :2] * scale
            region = label if label.lower().startswith("region") else None
            loose_curves.append(Curve(xy, form, label, bulge, f"{kind} on layer {layer}", region))
    return shape_data(loose_curves, path.name)


def has_unit(path: Path) -> bool:
    """Whether a drawing that can be read says its unit."""
    return bool(int(ezdxf.readfile(path).header.get("$INSUNITS", 0)))


def _name(layer: str) -> str:
    """A layer's name as a name in a scene."""
    name = re.sub(r"[^A-Za-z0-9_-]+", "_", layer)
    return name if re.match(r"[A-Za-z_]", name) else f"layer_{name}"


def _curves(entity: Any, kind: str) -> list[tuple[Any, str, float]] | None:
    """(points, kind, bulge) of each curve of an entity; None where it is of no use here."""
    if kind == "LINE":
        return [([entity.dxf.start, entity.dxf.end], "line", 0.0)]
    if kind == "ARC":
        angle = (entity.dxf.end_angle - entity.dxf.start_angle) % 360.0 or 360.0
        if angle == 360.0:
            return _circle(entity.dxf.center, entity.dxf.radius)
        return [([entity.start_point, entity.end_point], "arc", float(np.tan(np.radians(angle) / 4.0)))]
    if kind == "CIRCLE":
        return _circle(entity.dxf.center, entity.dxf.radius)
    if kind in ("LWPOLYLINE", "POLYLINE"):
        return _polyline(entity, kind)
    if kind == "SPLINE":
        return _spline(entity)
    return None


def _circle(center: Any, radius: float) -> list[tuple[Any, str, float]]:
    corners = [(center[0] + radius * dx, center[1] + radius * dy) for dx, dy in ((1, 0), (0, 1), (-1, 0), (0, -1))]
    quarter = float(np.tan(np.pi / 8.0))
    return [([corners[i], corners[(i + 1) % 4]], "arc", quarter) for i in range(4)]


def _polyline(entity: Any, kind: str) -> list[tuple[Any, str, float]] | None:
    if kind == "LWPOLYLINE":
        corners, closed = [(x, y, bulge) for x, y, bulge in entity.get_points("xyb")], entity.closed
    elif entity.is_2d_polyline:
        corners = [(*v.dxf.location.vec2, v.dxf.get("bulge", 0.0)) for v in entity.vertices]
        closed = entity.is_closed
    else:
        return None
    if closed and corners[0][:2] != corners[-1][:2]:
        corners.append(corners[0])
    pairs = [(a, b) for a, b in pairwise(corners) if a[:2] != b[:2]]
    return [([a[:2], b[:2]], "arc" if a[2] else "line", float(a[2])) for a, b in pairs]


def _spline(entity: Any) -> list[tuple[Any, str, float]]:
    points = [tuple(p)[:2] for p in entity.fit_points]
    if len(points) < 3:
        curve = entity.construction_tool()
        points = [(p.x, p.y) for p in curve.approximate(SPLINE_POINTS * len(entity.control_points))]
    chain = np.array(points)
    if np.hypot(*(chain[0] - chain[-1])) > 1e-9 * np.ptp(chain):
        return [(points, "spline", 0.0)]
    # A closed spline becomes two edges, since an edge has two ends.
    half = len(points) // 2
    return [(points[: half + 1], "spline", 0.0), (points[half:], "spline", 0.0)]
