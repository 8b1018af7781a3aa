"""Outlines from DXF drawings."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
from ezdxf import units

from restshape.bounds import BULGE, DRAWING_BYTES, LENGTH, NAME_CHARACTERS, READING_MEMORY, SPLINE_POINTS
from restshape.errors import UserError, printable
from restshape.memory import bounded_memory
from restshape.scene.plain_values import Table
from restshape.shape.bsplines import edges_of_cubic
from restshape.shape.unordered_curves import Curve, shape_data

NO_NAME = ("0", "Defpoints")
IGNORED = ("TEXT", "MTEXT", "DIMENSION", "POINT", "LEADER")
POINTS_A_CONTROL_POINT = 8
"""Points that stand for a B-spline, for each of its control points."""


def read_dxf(path: Path) -> Table:
    """The plain tables of a ``[shape]`` from a DXF drawing, in metres by its ``$INSUNITS`` (none: millimetres).

    Closed loops of LINE, ARC, CIRCLE, LWPOLYLINE, POLYLINE and SPLINE in model space; the largest is the outline.
    Layers name edges, holes and groups; a loop on a layer ``region...`` is a region. Lines, arcs and cubic SPLINEs
    without weights whose inner knots are simple are exact; another SPLINE with fit points interpolates them, one with
    control points alone interpolates 8 points of it for each of them. Texts, dimensions and points are ignored.

    Raises:
        UserError: unreadable, other entities, or open loops.
    """
    with _readable(path):
        drawing = ezdxf.readfile(path)
        scale = _metres(drawing)
        found = [_curves_of(entity, scale, path) for entity in drawing.modelspace()]
    return shape_data([curve for curves in found for curve in curves], path.name)


@contextmanager
def _readable(path: Path) -> Iterator[None]:
    """Has whatever is wrong with a drawing that is read within be an error of the user's."""
    if path.stat().st_size > DRAWING_BYTES:
        raise UserError(f"the drawing is longer than {DRAWING_BYTES} bytes", path.name, "draw less")
    do = "save it as ASCII DXF R2000 or later"
    try:
        with bounded_memory(READING_MEMORY):
            yield
    except UserError:
        raise
    except MemoryError:
        what = f"reading this drawing would take more than {READING_MEMORY >> 30} GB of memory"
        raise UserError(what, path.name, do) from None
    # ezdxf has some twenty kinds of errors, and damaged entities raise Python's own.
    except Exception as error:
        why = printable((str(error).strip() or type(error).__name__).splitlines()[0][:200])
        raise UserError(f"this cannot be read as DXF: {why}", path.name, do) from error


def _metres(drawing: Any) -> float:
    """Metres in one unit of a drawing."""
    unit = units.InsertUnits(int(drawing.header.get("$INSUNITS", 0)))
    return units.conversion_factor(unit, units.InsertUnits.Meters) if unit else 1e-3


def _curves_of(entity: Any, scale: float, path: Path) -> list[Curve]:
    """The curves of an entity, in metres; none of what is ignored."""
    kind, layer = entity.dxftype(), entity.dxf.layer
    if kind in IGNORED:
        return []
    found = _curves(entity, kind)
    if found is None:
        raise UserError(
            f"{kind} on layer {layer!r} cannot be part of an outline",
            path.name,
            "use LINE, ARC, CIRCLE, LWPOLYLINE, POLYLINE or SPLINE (explode blocks and hatches)",
        )
    label = "" if layer in NO_NAME else _name(layer)
    curves = []
    for curve in found:
        xy = np.asarray(curve.points, dtype=float)[:, :2] * scale
        if not (np.abs(xy).max() <= LENGTH and abs(curve.bulge) <= BULGE):
            what = f"{kind} on layer {layer!r} lies farther than {LENGTH:g} m from 0, or is bent too much"
            raise UserError(what, path.name, "check the unit of the drawing, $INSUNITS")
        region = label if label.lower().startswith("region") else None
        curves.append(replace(curve, points=xy, label=label, source=f"{kind} on layer {layer}", region=region))
    return curves


def has_unit(path: Path) -> bool:
    """Whether a drawing says its unit.

    Raises:
        UserError: it cannot be read.
    """
    with _readable(path):
        return bool(int(ezdxf.readfile(path).header.get("$INSUNITS", 0)))


def _name(layer: str) -> str:
    """A layer's name as a name in a scene."""
    name = re.sub(r"[^A-Za-z0-9_-]+", "_", layer)[: NAME_CHARACTERS // 2]
    return name if re.match(r"[A-Za-z_]", name) else f"layer_{name}"


def _curves(entity: Any, kind: str) -> list[Curve] | None:
    """The curves of an entity in units of the drawing, nameless; None where it is of no use here."""
    if kind == "LINE":
        return [Curve(_plane([entity.dxf.start, entity.dxf.end]), "line")]
    if kind == "ARC":
        angle = (entity.dxf.end_angle - entity.dxf.start_angle) % 360.0 or 360.0
        if angle == 360.0:
            return _circle(entity.dxf.center, entity.dxf.radius)
        bulge = float(np.tan(np.radians(angle) / 4.0))
        return [Curve(_plane([entity.start_point, entity.end_point]), "arc", bulge=bulge)]
    if kind == "CIRCLE":
        return _circle(entity.dxf.center, entity.dxf.radius)
    if kind in ("LWPOLYLINE", "POLYLINE"):
        return _polyline(entity, kind)
    if kind == "SPLINE":
        return _spline(entity)
    return None


def _plane(points: Any) -> np.ndarray:
    """The first two coordinates (n, 2) of points."""
    return np.array([tuple(p)[:2] for p in points], dtype=float)


def _circle(center: Any, radius: float) -> list[Curve]:
    corners = [(center[0] + radius * dx, center[1] + radius * dy) for dx, dy in ((1, 0), (0, 1), (-1, 0), (0, -1))]
    quarter = float(np.tan(np.pi / 8.0))
    return [Curve(_plane([corners[i], corners[(i + 1) % 4]]), "arc", bulge=quarter) for i in range(4)]


def _polyline(entity: Any, kind: str) -> list[Curve] | None:
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
    return [Curve(_plane([a, b]), "arc" if a[2] else "line", bulge=float(a[2])) for a, b in pairs]


def _spline(entity: Any) -> list[Curve]:
    """The edges of a SPLINE: exact where an edge can be it."""
    points = _plane(entity.fit_points)
    if len(points) < 3:
        exact = _exact(entity)
        if exact:
            return exact
        curve = entity.construction_tool()
        count = min(POINTS_A_CONTROL_POINT * len(entity.control_points), SPLINE_POINTS)
        points = _plane(curve.approximate(count))
    if np.hypot(*(points[0] - points[-1])) > 1e-9 * np.ptp(points):
        return [Curve(points, "spline")]
    # A closed spline becomes two edges, since an edge has two ends.
    half = len(points) // 2
    return [Curve(points[: half + 1], "spline"), Curve(points[half:], "spline")]


def _exact(entity: Any) -> list[Curve]:
    """The edges that are a cubic SPLINE by control points; none where no edge can be it."""
    weights = np.array(entity.weights)
    if entity.dxf.degree != 3 or (len(weights) and np.ptp(weights) > 0.0):
        return []
    found = edges_of_cubic(np.array(entity.knots, dtype=float), _plane(entity.control_points))
    return [Curve(points, "spline", knots=knots, ends=ends) for points, knots, ends in found]
