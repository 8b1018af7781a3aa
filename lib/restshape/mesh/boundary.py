"""Where the nodes on an outline stand: exact parameters on its edges, as dense as the sizing asks for."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np

from restshape import _kernels
from restshape.mesh.sizing import EQUILATERAL, FEWEST_PER_CIRCLE, GRADING, Sizing
from restshape.shape.outline import Edge, Layout, Outline

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

ENOUGH_ROOM = 0.999
"""Share of the triangles that bends may add below which they are not counted exactly."""

BOTH_ENDS = np.array([0.0, 1.0])
"""Parameters of the ends of an edge."""


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
    """Points along all edges, edge after edge, and the size wanted there.

    Args:
        first: (n_edges + 1,) where the samples of each edge start, the last one m.
        s: (m,) parameters; points: (m, 2) [m]; arc: (m,) length from the start of the edge [m]; size: (m,) [m].
        radii: of bent edges, by their numbers: radius of the curve [m], (k,) or one for all samples.
    """

    first: np.ndarray
    s: np.ndarray
    points: np.ndarray
    arc: np.ndarray
    size: np.ndarray
    radii: dict[int, np.ndarray | float]

    def part(self, edge: int) -> slice:
        """The samples of an edge."""
        return slice(self.first[edge], self.first[edge + 1])


def discretise(outline: Outline, sizing: Sizing) -> Boundary:
    """Nodes on all edges of an outline, at equal steps of length over local size."""
    samples = _sampled(outline, sizing)
    turn, finest = _turn_in_bends(outline, samples, sizing), FINEST_IN_BENDS * sizing.size
    for i, radius in samples.radii.items():
        size = samples.size[samples.part(i)]
        np.minimum(size, np.maximum(turn * radius, finest), out=size)
    _grade(outline, samples, sizing.size)
    inner = [
        _kernels.edge_parameters(
            samples.s[part],
            samples.arc[part],
            samples.size[part],
            _stops(outline, i),
            _fewest(outline, samples, i, turn, finest),
        )
        for i, part in enumerate(map(samples.part, range(len(outline.edges))))
    ]
    return _boundary_of(outline, inner)


def _boundary_of(outline: Outline, inner: list[np.ndarray]) -> Boundary:
    """The boundary whose nodes inside the edges have these parameters (k,), an array for each edge."""
    count = len(outline.vertex_names)
    edge, param = np.full(count, -1, dtype=np.int32), np.zeros(count)
    for i, found in enumerate(outline.edges):
        for vertex, s in ((found.start, 0.0), (found.end, 1.0)):
            if edge[vertex] < 0:
                edge[vertex], param[vertex] = i, s
    counts = [len(s) for s in inner]
    first, chains = np.cumsum([0, *counts]), []
    for found, low, high in zip(outline.edges, (count + first[:-1]).tolist(), (count + first[1:]).tolist()):
        chain = np.arange(low - 1, high + 1, dtype=np.int32)
        chain[0], chain[-1] = found.start, found.end
        chains.append(chain)
    s = np.concatenate(inner)
    return Boundary(
        np.concatenate([outline.points[:count], outline.points_on_all(first, s)]),
        np.concatenate([edge, np.repeat(np.arange(len(inner), dtype=np.int32), counts)]),
        np.concatenate([param, s]),
        tuple(chains),
    )


def _fewest(outline: Outline, samples: Samples, edge: int, turn: float, finest: float) -> int:
    """Mesh edges between the stops of an edge at least; of an arc as many as span its angle."""
    kind = outline.edges[edge].kind
    if kind != "arc":
        return 1 if kind in ("line", "polyline") else 2
    bend = max(turn * float(samples.radii.get(edge, np.inf)), finest)
    return max(2, math.ceil(samples.arc[samples.first[edge + 1] - 1] / bend - ROUNDING))


def _stops(outline: Outline, edge: int) -> np.ndarray:
    """Parameters of the ends of an edge, and of the corners inside it that become nodes."""
    return np.array([0.0, *_corners(outline, edge), 1.0]) if outline.edges[edge].kind == "polyline" else BOTH_ENDS


def _sampled(outline: Outline, sizing: Sizing) -> Samples:
    """Points along the edges, close enough to see their bends, with the size that attractors ask for."""
    lengths = outline.lengths()
    finest = min([sizing.size, *(attractor.size for attractor in sizing.attractors)])
    parts = [_sample_parameters(edge, length, finest) for edge, length in zip(outline.edges, lengths.tolist())]
    first, s = np.cumsum([0, *(len(part) for part in parts)], dtype=np.int32), np.concatenate(parts)
    points = outline.points_on_all(first, s)
    size = sizing.at(points) if sizing.attractors else np.full(len(s), sizing.size)
    samples = Samples(first, s, points, s * np.repeat(lengths, np.diff(first)), size, {})
    for i in np.flatnonzero(outline.bulges).tolist():
        samples.radii[i] = float(lengths[i]) / (4.0 * abs(math.atan(outline.bulges[i])))
    for i in outline.layout.curved:
        _see_curve(outline, samples, i, float(lengths[i]))
    return samples


def _sample_parameters(edge: Edge, length: float, finest: float) -> np.ndarray:
    """Parameters of samples of an edge of a length [m], at least two in the finest size [m]."""
    fewest = {"line": 2, "arc": 16, "spline": 24 * len(edge.knots)}.get(edge.kind, 2)
    s = _equal_steps(max(fewest, min(math.ceil(2.0 * length / finest), MOST_SAMPLES)))
    return np.union1d(s, edge.knots) if edge.kind == "polyline" else s


def _see_curve(outline: Outline, samples: Samples, index: int, length: float) -> None:
    """Take in how far the samples of a spline or a polyline are from its start, and how a spline bends."""
    part = samples.part(index)
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(samples.points[part], axis=0).T))])
    arc *= length / arc[-1] if arc[-1] > 0.0 else 1.0
    samples.arc[part] = arc
    samples.radii.pop(index, None)
    if outline.edges[index].kind == "spline":
        tangent = outline.tangent(index, samples.s[part])
        turns = np.abs(_angle(tangent[:-1], tangent[1:]))
        bend, radius = np.diff(arc) / np.maximum(turns, 1e-12), np.full(len(arc), np.inf)
        np.minimum(radius[:-1], bend, out=radius[:-1])
        np.minimum(radius[1:], bend, out=radius[1:])
        samples.radii[index] = radius


def _turn_in_bends(outline: Outline, samples: Samples, sizing: Sizing) -> float:
    """The angle of a bend that a mesh edge spans.

    It is a circle over the sizing's edges per circle, unless the triangles that bends add would then be more than those
    that the shape has without bends, and more than AFFORDABLE: it is as much larger as they would be more, up to
    FEWEST_PER_CIRCLE. Edges that a scene asks for by number are left as they are.
    """
    turn = 2.0 * math.pi / sizing.per_circle
    if sizing.per_circle_fixed or not samples.radii:
        return turn
    finest, most = FINEST_IN_BENDS * sizing.size, 2.0 * math.pi / FEWEST_PER_CIRCLE
    room = max(outline.area() / (EQUILATERAL * sizing.size**2), AFFORDABLE)
    if sum(_most_added(samples, i, turn, finest, sizing.size) for i in samples.radii) < ENOUGH_ROOM * room:
        return min(turn, most)
    added = 0.0
    for i, radius in samples.radii.items():
        part = samples.part(i)
        added += _triangles_added(samples.arc[part], samples.size[part], np.maximum(turn * radius, finest))
    return min(max(turn, turn * added / room), most)


def _most_added(samples: Samples, edge: int, turn: float, finest: float, size: float) -> float:
    """No fewer triangles than an edge's bends add where the size is at most `size` [m], at hardly any cost."""
    radius = samples.radii[edge]
    h = min(max(turn * (radius if isinstance(radius, float) else float(radius.min())), finest), size)
    return float(samples.arc[samples.first[edge + 1] - 1]) / h * (1.0 - h / size) ** 2 / (EQUILATERAL * GRADING)


def _triangles_added(arc: np.ndarray, size: np.ndarray, bend: np.ndarray) -> float:
    """Number of triangles that edges of lengths `bend` [m] add on one side, where the size grows by GRADING.

    It is the integral of 1 / h^2 - 1 / size^2 over the strip in which the size h is less than elsewhere.

    Args:
        arc, size: (m,) lengths from the start and sizes wanted [m] of the samples of an edge.
        bend: (m,), or one for all.
    """
    h = np.minimum(bend, size)
    density = (1.0 / h - 1.0 / size - (size - h) / size**2) / (EQUILATERAL * GRADING)
    return float(np.sum(np.diff(arc) * 0.5 * (density[1:] + density[:-1])))


@functools.lru_cache(maxsize=256)
def _equal_steps(count: int) -> np.ndarray:
    """Parameters of the ends of equal steps; not to be written to."""
    s = np.linspace(0.0, 1.0, count + 1)
    s.setflags(write=False)
    return s


def _angle(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Angle (m,) from u to v."""
    return np.arctan2(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0], np.sum(u * v, axis=1))


@functools.lru_cache(maxsize=8)
def _sides(layout: Layout) -> tuple[np.ndarray, np.ndarray]:
    """For each edge whether it is a line, and 1 or -1 if the material is only left or right of it, 0 if on both sides.

    They are of a layout, which never changes; not to be written to.
    """
    side = np.zeros(len(layout.edges))
    for loop in layout.loops:
        if loop.kind != "region":
            for edge, forward in loop.edges:
                side[edge] = 1.0 if forward else -1.0
    return np.array([edge.kind == "line" for edge in layout.edges], dtype=np.uint8), side


def _grade(outline: Outline, samples: Samples, coarsest: float) -> None:
    """Shorten the sizes in narrow places, and around all places with short sizes by the grading."""
    size, layout = samples.size, outline.layout
    width = _kernels.narrow_widths(
        samples.points, samples.arc, samples.first, layout.ends, *_sides(layout), coarsest, FOLD
    )
    np.minimum(size, np.maximum(ACROSS * width, FINEST * coarsest), out=size)
    _kernels.grade_sizes(samples.points, size, GRADING, coarsest)


def _corners(outline: Outline, index: int) -> list[float]:
    """Parameters of the corners inside a polyline that become nodes."""
    edge = outline.edges[index]
    if not edge.inner:
        return []
    sides = np.diff(outline.points[outline.layout.controls[index]], axis=0)
    turn = np.abs(_angle(sides[:-1], sides[1:]))
    return [knot for knot, angle in zip(edge.knots[1:-1], turn) if angle > CORNER]
