"""Where the nodes on an outline stand: exact parameters on its edges, as dense as the sizing asks for."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np

from restshape import _kernels
from restshape.mesh.sizing import EQUILATERAL, FEWEST_PER_CIRCLE, GRADING, Sizing
from restshape.shape.outline import Outline

CORNER = np.radians(15.0)
"""A corner of a polyline that turns by more than this becomes a node."""

ACROSS = 1.2
"""In a narrow place of width w, edges are no longer than this times w."""

FOLD = 6.0
"""Two points of adjacent edges face each other across a narrow place if the way along the edges is so much longer."""

FINEST = 0.1
"""Narrow places shorten edges to this share of the size at most."""

AFFORDABLE = 500
"""Triangles that bends may add to any mesh."""

FINEST_IN_BENDS = 0.01
"""Bends shorten edges to this share of the size at most."""

ROUNDING = 1e-9
"""Part of a mesh edge by which an arc may be longer than a whole number of them."""

MOST_SAMPLES = 2000
"""Samples on one edge at most."""


@dataclass(frozen=True)
class Boundary:
    """Nodes on the edges of an outline, and embedded points.

    Args:
        points: (nb, 2) positions [m]: the outline's vertices first, then the nodes inside edges.
        edge: (nb,) outline edge that a node lies on, or -1 (embedded); param: (nb,) parameter on it.
        chains: for each outline edge its nodes from start to end.
    """

    points: np.ndarray
    edge: np.ndarray
    param: np.ndarray
    chains: tuple[np.ndarray, ...]


@dataclass(frozen=True)
class Samples:
    """Points along one edge and the size wanted there.

    Args:
        s: (m,) parameters; points: (m, 2) [m]; arc: (m,) length from the start [m]; size: (m,) [m].
        radius: (m,) of the curve [m], infinite where it is straight.
        straight: whether it is infinite everywhere.
    """

    s: np.ndarray
    points: np.ndarray
    arc: np.ndarray
    size: np.ndarray
    radius: np.ndarray
    straight: bool = False

    def bend(self, turn: float, finest: float) -> np.ndarray:
        """Lengths (m,) [m] of mesh edges that span the angle `turn` of the bend, and are no shorter than `finest`."""
        return np.maximum(turn * self.radius, finest)


def discretise(outline: Outline, sizing: Sizing) -> Boundary:
    """Nodes on all edges of an outline, at equal steps of length over local size."""
    samples = [_sample(outline, i, sizing) for i in range(len(outline.edges))]
    turn, finest = turn_in_bends(outline, samples, sizing), FINEST_IN_BENDS * sizing.size
    for sample in samples:
        if not sample.straight:
            np.minimum(sample.size, sample.bend(turn, finest), out=sample.size)
    _grade(outline, samples, sizing.size)
    count = len(outline.vertex_names)
    edge, param = np.full(count, -1, dtype=np.int32), np.zeros(count)
    points, edges, params, chains = [outline.points[:count]], [edge], [param], []
    for i, (found, sample) in enumerate(zip(outline.edges, samples)):
        for vertex, s in ((found.start, 0.0), (found.end, 1.0)):
            if edge[vertex] < 0:
                edge[vertex], param[vertex] = i, s
        fewest = 1 if found.kind in ("line", "polyline") else 2
        if found.kind == "arc":
            fewest = max(fewest, math.ceil(sample.arc[-1] / sample.bend(turn, finest)[0] - ROUNDING))
        stops = np.array([0.0, *_corners(outline, i), 1.0])
        s = _kernels.edge_parameters(sample.s, sample.arc, sample.size, stops, fewest)
        chain = np.arange(count - 1, count + len(s) + 1, dtype=np.int32)
        chain[0], chain[-1] = found.start, found.end
        chains.append(chain)
        points.append(outline.point(i, s))
        edges.append(np.full(len(s), i, dtype=np.int32))
        params.append(s)
        count += len(s)
    return Boundary(np.concatenate(points), np.concatenate(edges), np.concatenate(params), tuple(chains))


def _sample(outline: Outline, index: int, sizing: Sizing) -> Samples:
    """Points along an edge, close enough to see its bends, with the size that attractors and bends ask for."""
    edge, length = outline.edges[index], outline.length(index)
    finest = min([sizing.size, *(attractor.size for attractor in sizing.attractors)])
    fewest = {"line": 2, "arc": 16, "spline": 24 * len(edge.knots)}.get(edge.kind, 2)
    s = _equal_steps(max(fewest, min(math.ceil(2.0 * length / finest), MOST_SAMPLES)))
    if edge.kind == "polyline":
        s = np.union1d(s, edge.knots)
    points = outline.point(index, s)
    size = sizing.at(points) if sizing.attractors else np.full(len(s), sizing.size)
    radius = np.full(len(s), np.inf)
    if edge.kind in ("line", "arc"):
        turn = 4.0 * abs(math.atan(outline.bulges[index]))
        if turn > 0.0:
            radius[:] = length / turn
        return Samples(s, points, s * length, size, radius, turn == 0.0)
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    arc *= length / arc[-1] if arc[-1] > 0.0 else 1.0
    if edge.kind == "spline":
        tangent = outline.tangent(index, s)
        turns = np.abs(_angle(tangent[:-1], tangent[1:]))
        bend = np.diff(arc) / np.maximum(turns, 1e-12)
        np.minimum(radius[:-1], bend, out=radius[:-1])
        np.minimum(radius[1:], bend, out=radius[1:])
    return Samples(s, points, arc, size, radius)


def turn_in_bends(outline: Outline, samples: list[Samples], sizing: Sizing) -> float:
    """The angle of a bend that a mesh edge spans.

    It is a circle over the sizing's edges per circle, unless the triangles that bends add would then be more than those
    that the shape has without bends, and more than AFFORDABLE: it is as much larger as they would be more, up to
    FEWEST_PER_CIRCLE. Edges that a scene asks for by number are left as they are.
    """
    turn = 2.0 * math.pi / sizing.per_circle
    if sizing.per_circle_fixed:
        return turn
    finest = FINEST_IN_BENDS * sizing.size
    added = sum(_triangles_added(sample, sample.bend(turn, finest)) for sample in samples if not sample.straight)
    room = max(outline.area() / (EQUILATERAL * sizing.size**2), AFFORDABLE)
    return min(max(turn, turn * added / room), 2.0 * math.pi / FEWEST_PER_CIRCLE)


def _triangles_added(sample: Samples, bend: np.ndarray) -> float:
    """Number of triangles that edges of lengths `bend` (m,) [m] add on one side, where the size grows by GRADING.

    It is the integral of 1 / h^2 - 1 / size^2 over the strip in which the size h is less than elsewhere.
    """
    size, h = sample.size, np.minimum(bend, sample.size)
    density = (1.0 / h - 1.0 / size - (size - h) / size**2) / (EQUILATERAL * GRADING)
    return float(np.sum(np.diff(sample.arc) * 0.5 * (density[1:] + density[:-1])))


@functools.lru_cache(maxsize=256)
def _equal_steps(count: int) -> np.ndarray:
    """Parameters of the ends of equal steps; not to be written to."""
    s = np.linspace(0.0, 1.0, count + 1)
    s.setflags(write=False)
    return s


def _angle(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Angle (m,) from u to v."""
    return np.arctan2(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0], np.sum(u * v, axis=1))


def _sides(outline: Outline) -> np.ndarray:
    """For each edge 1 or -1 if the material is only left or right of it, 0 if on both sides."""
    side = np.zeros(len(outline.edges))
    for loop in outline.loops:
        if loop.kind != "region":
            for edge, forward in loop.edges:
                side[edge] = 1.0 if forward else -1.0
    return side


def _grade(outline: Outline, samples: list[Samples], coarsest: float) -> None:
    """Shorten the sizes in narrow places, and around all places with short sizes by the grading."""
    first = np.cumsum([0, *(len(sample.s) for sample in samples)], dtype=np.int32)
    points = np.concatenate([sample.points for sample in samples])
    size = np.concatenate([sample.size for sample in samples])
    width = _kernels.narrow_widths(
        points,
        np.concatenate([sample.arc for sample in samples]),
        first,
        np.array([(edge.start, edge.end) for edge in outline.edges], dtype=np.int32),
        np.array([edge.kind == "line" for edge in outline.edges], dtype=np.uint8),
        _sides(outline),
        coarsest,
        FOLD,
    )
    np.minimum(size, np.maximum(ACROSS * width, FINEST * coarsest), out=size)
    _kernels.grade_sizes(points, size, GRADING, coarsest)
    for sample, low, high in zip(samples, first[:-1].tolist(), first[1:].tolist()):
        sample.size[:] = size[low:high]


def _corners(outline: Outline, index: int) -> list[float]:
    """Parameters of the corners inside a polyline that become nodes."""
    edge = outline.edges[index]
    if edge.kind != "polyline" or not edge.inner:
        return []
    sides = np.diff(outline.points[outline.layout.controls[index]], axis=0)
    turn = np.abs(_angle(sides[:-1], sides[1:]))
    return [knot for knot, angle in zip(edge.knots[1:-1], turn) if angle > CORNER]
