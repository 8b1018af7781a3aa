"""Outlines from DXF drawings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
from ezdxf import units

from restshape.arrays import Reals
from restshape.bounds import DRAWING_BYTES, READING_MEMORY
from restshape.errors import UserError, printable
from restshape.memory import bounded_memory
from restshape.shape.drawings.bsplines import edges_of_cubic
from restshape.shape.drawings.dxf_blocks import placed
from restshape.shape.drawings.fitted_spline import SMOOTH, fitted_spline
from restshape.shape.drawings.layer_names import name_of, refuse_layers, region_named
from restshape.shape.drawings.loose_curve import Curve, LooseCurves, gathered

NO_NAME = ("0", "Defpoints")
IGNORED = ("TEXT", "MTEXT", "DIMENSION", "LEADER", "ATTDEF", "ATTRIB", "VIEWPORT")
READ = "LINE, ARC, CIRCLE, ELLIPSE, LWPOLYLINE, POLYLINE, SPLINE, or an INSERT of a block of them"
NO_UNIT = "the drawing has no unit ($INSUNITS), and is read in millimetres"
FULL_TURN = 2.0 * np.pi
ROUND = 1e-9
"""Share by which the axes of an ellipse may differ that is a circle."""


def read_dxf(path: Path, layers: Mapping[str, str] | None = None) -> LooseCurves:
    """The curves of a DXF drawing, in metres by its ``$INSUNITS`` (none: millimetres).

    LINE, ARC, CIRCLE, ELLIPSE, LWPOLYLINE, POLYLINE and SPLINE in model space, and in blocks that INSERTs put there.
    Layers name edges, holes and groups; a loop on a layer ``region...``, by either of its names, is a region.
    Lines, arcs and cubic SPLINEs without weights whose inner knots are simple are exact; a SPLINE with fit points
    interpolates them; ELLIPSEs and all other SPLINEs become splines within `fitted_spline.WITHIN`. A POINT that has
    a layer for itself has its name. Texts, dimensions and all other points are ignored.

    Args:
        path: the file.
        layers: names by layer, where those layers alone are read; empty: all are, by their own names.

    Raises:
        UserError: unreadable, or other entities.
    """
    layers = layers or {}
    with readable(path):
        drawing = ezdxf.readfile(path)
        scale, sized = metres_in(drawing)
        there = [
            (entity, layer)
            for entity, layer in placed(drawing.modelspace(), drawing.blocks, path.name)
            if entity.dxftype() not in IGNORED
        ]
        points = _points(there)
        there = [(entity, layer) for entity, layer in there if entity.dxftype() != "POINT" or layer in points]
        refuse_layers(layers, dict.fromkeys(layer for _, layer in there), path.name)
        label = {layer: layers.get(layer) or ("" if layer in NO_NAME else name_of(layer)) for _, layer in there}
        read = [(entity, layer) for entity, layer in there if not layers or layer in layers]
        drawn = ((entity, layer) for entity, layer in read if layer not in points)
        curves = gathered((curves_of(one, layer, label[layer], scale, path) for one, layer in drawn), path.name)
        named = {label[layer]: scale * points[layer] for _, layer in read if layer in points}
    return LooseCurves(curves, doubt="" if sized else NO_UNIT, points=named)


def metres_in(drawing: Any) -> tuple[float, bool]:
    """The metres in a unit of a drawing, and whether it says so; those of a millimetre where it does not."""
    unit = units.InsertUnits(int(drawing.header.get("$INSUNITS", 0)))
    return (units.conversion_factor(unit, units.InsertUnits.Meters) if unit else 1e-3), bool(unit)


def _points(there: list[tuple[Any, str]]) -> dict[str, Reals]:
    """The POINTs (2,) that have a layer for themselves, by layer, in units of the drawing."""
    kinds: dict[str, list[Any]] = {}
    for entity, layer in there:
        kinds.setdefault(layer, []).append(entity)
    alone = {layer: found[0] for layer, found in kinds.items() if len(found) == 1 and layer not in NO_NAME}
    return {layer: _plane([one.dxf.location])[0] for layer, one in alone.items() if one.dxftype() == "POINT"}


@contextmanager
def readable(path: Path) -> Iterator[None]:
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


def curves_of(entity: Any, layer: str, label: str, scale: float, path: Path) -> list[Curve]:
    """The curves of an entity, in metres."""
    kind = entity.dxftype()
    source = f"{kind} on layer {layer}"
    _refuse_radius(entity, source, path)
    found = _curves(entity, kind, source)
    if found is None:
        do = f"use {READ}; shape.layers reads some layers alone; explode hatches"
        raise UserError(
            f"{kind} on layer {layer!r}{_line_of(entity, path)} cannot be part of an outline", path.name, do
        )
    region = label if region_named(layer, label) else None
    return [
        replace(curve, points=np.asarray(curve.points, float)[:, :2] * scale, label=label, source=source, region=region)
        for curve in found
    ]


def _line_of(entity: Any, path: Path) -> str:
    """Where an entity stands in the text of its file, by its handle; "" where it has none."""
    handle = entity.dxf.get("handle")
    try:
        lines = path.read_text(encoding="utf-8", errors="replace").splitlines() if handle else []
    except OSError:
        return ""
    number = next((k for k in range(1, len(lines)) if lines[k].strip() == handle and lines[k - 1].strip() == "5"), None)
    return "" if number is None else f", line {number + 1}"


def _refuse_radius(entity: Any, what: str, path: Path) -> None:
    """Refuses a circle or an arc whose radius is no length.

    Raises:
        UserError: it is not a number greater than 0.
    """
    radius = entity.dxf.radius if entity.dxftype() in ("CIRCLE", "ARC") else 1.0
    if not 0.0 < radius < np.inf:
        wrong = f"{what}: a radius of {radius:g} is none: it must be a number greater than 0"
        raise UserError(wrong, path.name, "mend it in the drawing")


def _curves(entity: Any, kind: str, source: str) -> list[Curve] | None:
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
    if kind == "ELLIPSE":
        return _ellipse(entity, source)
    if kind in ("LWPOLYLINE", "POLYLINE"):
        return _polyline(entity, kind)
    if kind == "SPLINE":
        return _spline(entity, source)
    return None


def _plane(points: Any) -> Reals:
    """The first two coordinates (n, 2) of points."""
    return np.array([tuple(p)[:2] for p in points], dtype=float)


def _circle(center: Any, radius: float) -> list[Curve]:
    corners = [(center[0] + radius * dx, center[1] + radius * dy) for dx, dy in ((1, 0), (0, 1), (-1, 0), (0, -1))]
    quarter = float(np.tan(np.pi / 8.0))
    return [Curve(_plane([corners[i], corners[(i + 1) % 4]]), "arc", bulge=quarter) for i in range(4)]


def _ellipse(entity: Any, source: str) -> list[Curve]:
    """The edges of an ELLIPSE: arcs where it is round, else a spline for each quarter or less."""
    center, major, minor = (_plane([p])[0] for p in (entity.dxf.center, entity.dxf.major_axis, entity.minor_axis))
    low, high = float(entity.dxf.start_param), float(entity.dxf.end_param)
    turn = (high - low) % FULL_TURN or FULL_TURN
    cuts = np.linspace(low, low + turn, 1 + int(np.ceil(turn / (0.25 * FULL_TURN) - 1e-9)))

    def points(t: Reals) -> Reals:
        return center + np.cos(t)[:, None] * major + np.sin(t)[:, None] * minor

    ends = points(cuts)
    if turn == FULL_TURN:
        ends[-1] = ends[0]
    if abs(float(entity.dxf.ratio)) > 1.0 - ROUND:
        bulge = float(np.tan((cuts[1] - cuts[0]) / 4.0)) * float(np.sign(major[0] * minor[1] - major[1] * minor[0]))
        return [Curve(np.array(pair), "arc", bulge=bulge) for pair in pairwise(ends)]
    curves = []
    for (a, b), (start, stop) in zip(pairwise(cuts), pairwise(ends)):
        inner, knots = fitted_spline(points, float(a), float(b), source)
        curves.append(Curve(np.array([start, *inner[1:-1], stop]), "spline", knots=knots, ends=SMOOTH))
    return curves


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


def _spline(entity: Any, source: str) -> list[Curve]:
    """The edges of a SPLINE: exact where an edge can be it."""
    points = _plane(entity.fit_points)
    if len(points) < 3:
        exact = _exact(entity)
        if exact:
            return exact
        return _fitted(entity, source)
    if np.hypot(*(points[0] - points[-1])) > 1e-9 * np.ptp(points):
        return [Curve(points, "spline")]
    # A closed spline becomes two edges, since an edge has two ends.
    half = len(points) // 2
    return [Curve(points[: half + 1], "spline"), Curve(points[half:], "spline")]


def _fitted(entity: Any, source: str) -> list[Curve]:
    """The edges that stand for a SPLINE by control points; two of a closed one, since an edge has two ends."""
    tool = entity.construction_tool()

    def points(t: Reals) -> Reals:
        return _plane(tool.points(t.tolist()))

    low, high = float(tool.knots()[tool.order - 1]), float(tool.knots()[tool.count])
    ends = points(np.array([low, high]))
    cuts = (
        [low, high]
        if np.hypot(*(ends[0] - ends[1])) > 1e-9 * np.ptp(_plane(tool.control_points))
        else [low, 0.5 * (low + high), high]
    )
    found = [fitted_spline(points, a, b, source) for a, b in pairwise(cuts)]
    return [Curve(own, "spline", knots=knots, ends=SMOOTH) for own, knots in found]


def _exact(entity: Any) -> list[Curve]:
    """The edges that are a cubic SPLINE by control points; none where no edge can be it."""
    weights = np.array(entity.weights)
    if entity.dxf.degree != 3 or (len(weights) and np.ptp(weights) > 0.0):
        return []
    found = edges_of_cubic(np.array(entity.knots, dtype=float), _plane(entity.control_points))
    return [Curve(points, "spline", knots=knots, ends=ends) for points, knots, ends in found]
