"""The path of a cutting tool: an outline moved away from the material by half the width of the cut."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from restshape import _kernels
from restshape.arrays import Reals
from restshape.errors import UserError
from restshape.export.moved_out import STRAIGHT, crossing, moved_out, turn_between
from restshape.scene.model import ShapeSpec
from restshape.scene.plain_values import Table
from restshape.shape.build import unchecked_outline
from restshape.shape.drawings.loose_curve import Curve
from restshape.shape.drawings.unordered_curves import shape_data
from restshape.shape.outline import Loop, Outline

MM = 1e3
CHORD = 1e-2
"""Distance of straight pieces from a curve over that of the path, where the two are compared."""
CLOSE = 0.98
"""Share of its distance that a path keeps everywhere."""
LEAST, MOST = 8, 2000
"""Places between two knots of a path that are looked at."""


def tool_path(outline: Outline, kerf: float) -> Outline:
    """The border and the holes of a shape as a tool goes along them whose cut is `kerf` [m] wide.

    Lines stay lines and arcs arcs; splines become splines within 1e-6 of their size of the true path. Around corners
    that point out the path is an arc, so that the cut leaves them sharp; corners that point in become round, as no
    cut of this width can do better. Regions and points are left out: nothing is cut there.

    Raises:
        UserError: the cut does not fit into a hole, a bay or a corner; or there are several pieces.
    """
    if len(outline.piece_names) > 1:
        what = "the shape has several pieces, and a cut goes around one"
        raise UserError(what, "--kerf", "restshape pattern lays them out, with an --allowance")
    distance = 0.5 * kerf
    curves = [curve for loop in outline.loops if loop.kind != "region" for curve in _path(outline, loop, distance)]
    tables, _ = shape_data(curves, "the path of the tool")
    del tables["points"]
    spec: Table = {key: table for key, table in tables.items() if table}
    found = unchecked_outline(ShapeSpec.model_validate(spec))
    _refuse_closed(outline, found, distance)
    return found


def _path(outline: Outline, loop: Loop, distance: float) -> list[Curve]:
    """The curves of a loop at a distance [m] from it."""
    pieces = moved_out(outline, loop, distance)
    arcs: dict[int, Curve] = {}
    starts, ends = [piece.at(0.0)[0] for piece in pieces], [piece.at(1.0)[0] for piece in pieces]
    for k, before in enumerate(pieces):
        after = (k + 1) % len(pieces)
        turn = turn_between(before, pieces[after])
        if turn > STRAIGHT:
            bulge = float(np.tan(0.25 * turn))
            arcs[k] = Curve(np.array([ends[k], starts[after]]), "arc", bulge=bulge, source=f"the end of {before.name}")
        elif turn < -STRAIGHT:
            s, u, place = crossing(before, pieces[after], outline.size)
            pieces[k], pieces[after] = replace(before, high=s), replace(pieces[after], low=u)
            starts[after] = ends[k] = place
        else:
            starts[after] = ends[k] = 0.5 * (starts[after] + ends[k])
    found: list[Curve] = []
    for k, piece in enumerate(pieces):
        found.append(piece.curve(starts[k], ends[k]))
        found += [arcs[k]] if k in arcs else []
    return [replace(curve, label=loop.name if loop.kind == "hole" else "") for curve in found]


def _refuse_closed(outline: Outline, path: Outline, distance: float) -> None:
    """Refuses a path that comes nearer to the border than its distance, as in a bay that the cut would fill.

    Raises:
        UserError: it does, with the place.
    """
    chains = [
        outline.polyline(e, CHORD * distance) for loop in outline.loops if loop.kind != "region" for e, _ in loop.edges
    ]
    starts, ends = (np.concatenate([chain[part] for chain in chains]) for part in (slice(-1), slice(1, None)))
    places: Reals = np.concatenate([_along(path, e, distance) for e in range(len(path.edges))])
    away = _kernels.distances(np.ascontiguousarray(places), starts, ends)
    worst = int(away.argmin())
    if away[worst] < CLOSE * distance:
        x, y = MM * places[worst]
        what = f"the cut is wider than the bay or the hole at ({x:.4g}, {y:.4g}) mm"
        raise UserError(what, "--kerf", "give less, or open the shape there")


def _along(path: Outline, edge: int, step: float) -> Reals:
    """Places (n, 2) [m] of an edge, some steps [m] apart at most as long as that makes no more than `MOST` of them."""
    knots = path.edges[edge].knots
    between = int(np.clip(path.length(edge) / (step * (len(knots) - 1)), LEAST, MOST)) + 1
    return path.point(edge, np.unique(np.concatenate([np.linspace(a, b, between) for a, b in pairwise(knots)])))
