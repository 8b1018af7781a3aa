"""An outline as a STEP file by gmsh's OpenCASCADE kernel: a face, or a solid of one thickness."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from restshape.errors import UserError
from restshape.outputs.atomic_files import replacing, write_whole
from restshape.outputs.kinds import EXPORT_MARK
from restshape.shape.drawings.bsplines import cubic_of
from restshape.shape.drawings.geo_model import gmsh_model
from restshape.shape.drawings.step_names import with_names
from restshape.shape.outline import Loop, Outline

MM = 1e3
FLAT = 1e-4
"""Arcs of smaller bulge are rational B-splines, which keep their digits."""
BEGINNING = "ISO-10303-21;\n"


def write_step(outline: Outline, thickness: float | None, path: Path) -> None:
    """Writes a shape in mm, its material alone: regions are not distinguished.

    Args:
        outline: the shape, in z = 0.
        thickness: of the solid over it, up from z = 0 [m]; None: the face.
        path: of the file.

    Raises:
        UserError: OpenCASCADE cannot make it.
        OSError: it cannot be written.
    """
    with gmsh_model(path) as gmsh, replacing(path) as part:
        try:
            names = build(gmsh.model.occ, outline, thickness)
            gmsh.model.occ.synchronize()
            with _quiet():
                gmsh.write(str(part))
        # gmsh reports every failure as a bare Exception, so nothing narrower can be caught.
        except Exception as error:
            raise UserError(f"OpenCASCADE cannot make this shape: {error}", str(path), "use --as dxf") from error
        text = with_names(gmsh.model, names, part.read_text(encoding="utf-8"))
        write_whole(part, text.replace(BEGINNING, f"{BEGINNING}/* {EXPORT_MARK} */\n", 1))


@contextmanager
def _quiet() -> Iterator[None]:
    """Sends nowhere what OpenCASCADE prints of a transfer, whatever gmsh's options say, to standard output."""
    sys.stdout.flush()
    kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)


def build(occ: Any, outline: Outline, thickness: float | None) -> dict[int, str]:
    """Hands a shape to gmsh's OpenCASCADE kernel; names of its curves in z = 0: of edges, and of holes."""
    border = [loop for loop in outline.loops if loop.kind != "region"]
    ends = {v for loop in border for e, _ in loop.edges for v in (outline.edges[e].start, outline.edges[e].end)}
    points = {v: occ.addPoint(*(MM * outline.points[v]), 0.0) for v in sorted(ends)}
    names: dict[int, str] = {}
    loops = [occ.addCurveLoop(_curves(occ, outline, loop, points, names)) for loop in border]
    face = occ.addPlaneSurface(loops)
    if thickness is not None:
        occ.extrude([(2, face)], 0.0, 0.0, MM * thickness)
    return names


def _curves(occ: Any, outline: Outline, loop: Loop, points: dict[int, int], names: dict[int, str]) -> list[int]:
    """The curves of a loop, negative where they are passed backwards; their names are added to `names`."""
    found = []
    for e, forward in loop.edges:
        own = _edge(occ, outline, e, points)
        names |= dict.fromkeys(own, outline.edges[e].name if loop.kind == "outline" else loop.name)
        found += own if forward else [-curve for curve in reversed(own)]
    return found


def _edge(occ: Any, outline: Outline, index: int, points: dict[int, int]) -> list[int]:
    """The curves that an edge is, from its start to its end."""
    edge, bulge = outline.edges[index], float(outline.bulges[index])
    own = MM * outline.points[outline.layout.controls[index]]
    start, end = points[edge.start], points[edge.end]

    def inner(more: np.ndarray) -> list[int]:
        return [occ.addPoint(x, y, 0.0) for x, y in more]

    if edge.kind == "polyline":
        corners = [start, *inner(own[1:-1]), end]
        return [occ.addLine(a, b) for a, b in pairwise(corners)]
    if edge.kind == "spline":
        curve = cubic_of(own, edge.knots, edge.ends)
        counts = [4, *[1] * (len(edge.knots) - 2), 4]
        return [occ.addBSpline([start, *inner(curve.c[1:-1]), end], -1, 3, [], list(edge.knots), counts)]
    if bulge == 0.0:
        return [occ.addLine(start, end)]
    middle, across = 0.5 * (own[0] + own[1]), 0.5 * (own[1] - own[0])[::-1] * (1.0, -1.0)
    if abs(bulge) >= FLAT:
        return [occ.addCircleArc(start, *inner([middle + bulge * across]), end, center=False)]
    half = 2.0 * np.arctan(bulge)
    control = inner([middle + np.tan(half) * across])
    return [occ.addBSpline([start, *control, end], -1, 2, [1.0, float(np.cos(half)), 1.0], [0.0, 1.0], [3, 3])]
