"""The line along which a piece is cut: the line of its seams, moved out by an allowance, by OpenCASCADE."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from restshape.arrays import Reals
from restshape.errors import UserError
from restshape.mesh.regions import signed_area
from restshape.shape.drawings.geo_model import gmsh_model
from restshape.shape.outline import Loop, Outline
from restshape.shape.patterns.pattern import Pattern
from restshape.shape.patterns.pattern_pieces import is_in
from restshape.shape.patterns.seam_parts import SeamPart, seam_parts

MM = 1e3
CHORD = 1e-5
"""Most distance of the line from what it stands for [m]."""
NEAR = 1e-6
"""Distance [mm] at which ends of curves are one."""
SHORT = 1e-3
"""Length [mm] of a part of the line below which it is left out: the arc around a corner that is none."""
FINE = 0.05
"""Of an allowance: spacing of places along a hole, from which its depth is found."""
MOST = 0.5
"""Allowance over the smaller side of a piece, above which it is none."""


def cut_lines(outline: Outline, allowance: float, name: str) -> list[Reals]:
    """Closed lines (m, 2) [m], without their first point again: the outer one first, then those of bays that it closes.

    Corners that point out are round; the distance from the line of the seam is the allowance everywhere.

    Args:
        outline: of a piece; allowance: [m], above 0; name: of the piece, for messages.

    Raises:
        UserError: OpenCASCADE cannot make it.
    """
    low, high = outline.bounds()
    if allowance > MOST * float(min(high - low)):
        what = f"an allowance of {MM * allowance:g} mm is more than half the width of the piece {name}"
        raise UserError(what, "--allowance", "give less")
    border = MM * _border(outline)
    area = signed_area(border)
    with gmsh_model(Path("allowance")) as gmsh:
        try:
            found = _moved(gmsh.model, border, MM * allowance)
        # gmsh reports every failure as a bare Exception, so nothing narrower can be caught.
        except Exception as error:
            what = f"OpenCASCADE cannot move the line of the piece {name} out by {MM * allowance:g} mm: {error}"
            raise UserError(what, "--allowance", "give less, or leave it out") from error
    found.sort(key=lambda line: -abs(signed_area(line)))
    if not found or abs(signed_area(found[0])) <= abs(area):
        what = f"OpenCASCADE cannot move the line of the piece {name} out by {MM * allowance:g} mm"
        raise UserError(what, "--allowance", "give less, or leave it out")
    return [line / MM for line in found]


def hole_cut_lines(outline: Outline, loop: Loop, allowance: float, name: str) -> list[Reals]:
    """Closed lines (m, 2) [m] inside of a hole, at the allowance from the line of its seam; none where it has no room.

    Args:
        outline: of a piece; loop: one of its holes; allowance: [m], above 0; name: of the piece, for messages.

    Raises:
        UserError: OpenCASCADE cannot make it.
    """
    border = MM * _border(outline, loop)
    area, inside = signed_area(border), MM * allowance
    # OpenCASCADE has no empty result.
    if _depth(border, inside) <= (1.0 + FINE) * inside:
        return []
    with gmsh_model(Path("allowance")) as gmsh:
        try:
            found = _moved(gmsh.model, border, -inside)
        # As above.
        except Exception as error:
            what = f"OpenCASCADE cannot move the line of the hole {name}.{loop.name} in by {inside:g} mm: {error}"
            raise UserError(what, "--allowance", "give less, or leave it out") from error
    return [line / MM for line in found if abs(signed_area(line)) < abs(area)]


def sewn_holes(outline: Outline, name: str, parts: Mapping[str, Sequence[SeamPart]]) -> list[Loop]:
    """The holes of a piece of this name that seams are on, by the parts of all edges ``PIECE.EDGE`` that are sewn."""
    return [
        loop
        for loop in outline.loops
        if loop.kind == "hole" and any(f"{name}.{outline.edges[e].name}" in parts for e, _ in loop.edges)
    ]


def holes_noted(pattern: Pattern, allowance: float) -> list[str]:
    """A note of sewn holes that are too narrow for an allowance [m]; none without such holes."""
    parts = seam_parts(pattern)
    found = [
        f"{piece.name}.{loop.name}"
        for piece in pattern.pieces
        for outline in [piece.outline()]
        for loop in sewn_holes(outline, piece.name, parts)
        if not hole_cut_lines(outline, loop, allowance, piece.name)
    ]
    return [f"no cut line in sewn holes narrower than two allowances: {', '.join(found)}"] if found else []


def _depth(border: Reals, distance: float) -> float:
    """How far the deepest place inside a closed line (m, 2) is from it, to some parts in a hundred of a distance.

    Such places are vertices of the Voronoi diagram of places along the line.
    """
    from scipy.spatial import Voronoi, cKDTree

    closed = np.vstack([border, border[:1]])
    counts = np.ceil(np.hypot(*np.diff(closed, axis=0).T) / (FINE * distance)).astype(int)
    ways = zip(pairwise(closed), counts)
    places = np.concatenate([a + np.linspace(0.0, 1.0, n, endpoint=False)[:, None] * (b - a) for (a, b), n in ways])
    inside = np.array([one for one in Voronoi(places).vertices if is_in(one, [closed])]).reshape(-1, 2)
    return float(cKDTree(places).query(inside)[0].max()) if len(inside) else 0.0


def _border(outline: Outline, loop: Loop | None = None) -> Reals:
    """Corners (m, 2) [m] of the border of a piece, or of another loop of it, counter-clockwise."""
    parts = []
    for e, forward in (loop or outline.loops[0]).edges:
        points = outline.polyline(e, CHORD)
        parts.append((points if forward else points[::-1])[:-1])
    border = np.concatenate(parts)
    return border if signed_area(border) > 0.0 else border[::-1]


def _moved(model: Any, border: Reals, distance: float) -> list[Reals]:
    """Closed lines at a distance outside of a border (m, 2), both in mm."""
    occ = model.occ
    points = [occ.addPoint(x, y, 0.0) for x, y in border]
    loop = occ.addCurveLoop([occ.addLine(a, b) for a, b in pairwise([*points, points[0]])])
    made = occ.offsetCurve(loop, distance)
    occ.synchronize()
    return [_thinned(line) for line in _closed([_points(model, tag) for dimension, tag in made if dimension == 1])]


def _thinned(line: Reals) -> Reals:
    """A closed line (m, 2) [mm] without points that lie at the one before."""
    return line[np.hypot(*(line - np.roll(line, 1, axis=0)).T) >= SHORT]


def _points(model: Any, tag: int) -> Reals:
    """Points (m, 2) of a curve, chords of which stay within `CHORD` of it."""
    low, high = (float(bound[0]) for bound in model.getParametrizationBounds(1, tag))
    count = 2
    if model.getType(1, tag) != "Line":
        # Curves that are no lines are arcs by angle.
        radius = 1.0 / max(float(model.getCurvature(1, tag, [0.5 * (low + high)])[0]), NEAR)
        step = 2.0 * np.arccos(max(1.0 - MM * CHORD / radius, 0.5))
        count = 2 + int(np.ceil((high - low) / step))
    places = model.getValue(1, tag, np.linspace(low, high, count).tolist())
    return np.asarray(places).reshape(-1, 3)[:, :2]


def _closed(chains: list[Reals]) -> list[Reals]:
    """Closed lines of chains whose ends meet, each without its first point again."""
    ends = np.array([chain[[0, -1]] for chain in chains])
    left = np.ones(len(chains), bool)
    found = []
    while left.any():
        number = int(left.argmax())
        line, left[number] = [chains[number]], False
        while len(line) < 2 or np.hypot(*(line[-1][-1] - line[0][0])) > NEAR:
            gaps = np.where(left[:, None], np.linalg.norm(ends - line[-1][-1], axis=2), np.inf)
            number, end = divmod(int(gaps.argmin()), 2)
            if gaps[number, end] > NEAR:
                raise ValueError("the line is open")
            left[number] = False
            line.append(chains[number][:: 1 - 2 * end])
        found.append(np.concatenate([chain[:-1] for chain in line]))
    return found
