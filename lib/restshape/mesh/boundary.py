"""Where the nodes on an outline stand: exact parameters on its edges, as dense as the sizing asks for."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from restshape.mesh.sizing import GRADING, Sizing
from restshape.shape.outline import Outline

LARGEST_TURN = np.pi / 4
"""A mesh edge spans at most this angle of a bend."""

CORNER = np.radians(15.0)
"""A corner of a polyline that turns by more than this becomes a node."""

ACROSS = 1.2
"""In a narrow place of width w, edges are no longer than this times w."""

FOLD = 6.0
"""Two points of adjacent edges face each other across a narrow place if the way along the edges is so much longer."""

FINEST = 0.1
"""Bends and narrow places shorten edges to this share of the size at most."""

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
    """

    s: np.ndarray
    points: np.ndarray
    arc: np.ndarray
    size: np.ndarray


def discretise(outline: Outline, sizing: Sizing) -> Boundary:
    """Nodes on all edges of an outline, at equal steps of length over local size."""
    samples = [_sample(outline, i, sizing) for i in range(len(outline.edges))]
    _grade(samples, _narrow(outline, samples, sizing.size), sizing.size)
    count = len(outline.vertex_names)
    edge, param = np.full(count, -1, dtype=np.int32), np.zeros(count)
    points, edges, params, chains = [outline.points[:count]], [edge], [param], []
    for i, (found, sample) in enumerate(zip(outline.edges, samples)):
        for vertex, s in ((found.start, 0.0), (found.end, 1.0)):
            if edge[vertex] < 0:
                edge[vertex], param[vertex] = i, s
        s = _parameters(outline, i, sample)
        chains.append(np.concatenate([[found.start], np.arange(count, count + len(s)), [found.end]]).astype(np.int32))
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
    count = int(np.clip(np.ceil(2.0 * length / finest), fewest, MOST_SAMPLES))
    s = np.linspace(0.0, 1.0, count + 1)
    if edge.kind == "polyline":
        s = np.union1d(s, edge.knots)
    points = outline.point(index, s)
    steps = np.hypot(*np.diff(points, axis=0).T)
    arc = np.concatenate([[0.0], np.cumsum(steps)])
    arc *= length / arc[-1] if arc[-1] > 0.0 else 1.0
    size = sizing.at(points) if sizing.attractors else np.full(len(s), sizing.size)
    if edge.kind in ("arc", "spline"):
        tangent = outline.tangent(index, s)
        turn = np.abs(_angle(tangent[:-1], tangent[1:]))
        radius = np.diff(arc) / np.maximum(turn, 1e-12)
        bend = np.maximum(LARGEST_TURN * radius, FINEST * sizing.size)
        # An edge within one bend is cut in pieces by its angle alone, however small it is.
        np.minimum(size[:-1], bend, out=size[:-1])
        np.minimum(size[1:], bend, out=size[1:])
    return Samples(s, points, arc, size)


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


def _narrow(outline: Outline, samples: list[Samples], reach: float) -> np.ndarray:
    """For each sample of all edges the width (m,) of the material there [m], infinite where wider than `reach`."""
    owner = np.repeat(np.arange(len(samples)), [len(sample.s) for sample in samples])
    points = np.concatenate([sample.points for sample in samples])
    width = np.full(len(points), np.inf)
    pairs = cKDTree(points).query_pairs(reach, output_type="ndarray")
    # Neighbours on one straight edge never face each other.
    bent = np.array([edge.kind != "line" for edge in outline.edges])
    pairs = pairs[(owner[pairs[:, 0]] != owner[pairs[:, 1]]) | bent[owner[pairs[:, 0]]]]
    if not len(pairs):
        return width
    tangents = np.concatenate([np.gradient(sample.points, axis=0) for sample in samples])
    spacing = np.hypot(*tangents.T)
    tangents /= np.maximum(spacing, 1e-300)[:, None]
    side = _sides(outline)[owner]
    i, j = np.concatenate([pairs, pairs[:, ::-1]]).T
    across = points[j] - points[i]
    apart = np.hypot(*across.T)
    inward = tangents[i, 0] * across[:, 1] - tangents[i, 1] * across[:, 0]
    faces = (side[i] == 0.0) | (side[i] * inward > 0.0)
    faces &= np.concatenate([faces[len(pairs) :], faces[: len(pairs)]])
    faces &= _way(outline, samples, owner, i, j) > FOLD * apart
    i, j, across = i[faces], j[faces], across[faces]
    along = np.abs(np.sum(across * tangents[j], axis=1))
    away = np.abs(across[:, 0] * tangents[j, 1] - across[:, 1] * tangents[j, 0])
    np.minimum.at(width, i, np.hypot(away, np.maximum(along - 0.5 * spacing[j], 0.0)))
    return width


def _way(outline: Outline, samples: list[Samples], owner: np.ndarray, i: np.ndarray, j: np.ndarray) -> np.ndarray:
    """Length of the way from sample i to sample j along their edges; infinite if these share no vertex."""
    arc = np.concatenate([sample.arc for sample in samples])
    rest = np.concatenate([sample.arc[-1] - sample.arc for sample in samples])
    start = np.array([edge.start for edge in outline.edges])[owner]
    end = np.array([edge.end for edge in outline.edges])[owner]
    way = np.where(owner[i] == owner[j], np.abs(arc[i] - arc[j]), np.inf)
    for from_i, at_i in ((arc, start), (rest, end)):
        for from_j, at_j in ((arc, start), (rest, end)):
            meets = (at_i[i] == at_j[j]) & (owner[i] != owner[j])
            np.minimum(way, np.where(meets, from_i[i] + from_j[j], np.inf), out=way)
    return way


def _grade(samples: list[Samples], width: np.ndarray, coarsest: float) -> None:
    """Shorten the sizes in narrow places, and around all places with short sizes by the grading."""
    size = np.concatenate([sample.size for sample in samples])
    np.minimum(size, np.maximum(ACROSS * width, FINEST * coarsest), out=size)
    points = np.concatenate([sample.points for sample in samples])
    short = np.flatnonzero(size < (1.0 - 1e-9) * coarsest)
    for i in short[np.argsort(size[short], kind="stable")]:
        # A place that a shorter one has already reached adds nothing.
        distance = np.hypot(points[:, 0] - points[i, 0], points[:, 1] - points[i, 1])
        np.minimum(size, size[i] + GRADING * distance, out=size)
    for sample, own in zip(samples, np.split(size, np.cumsum([len(sample.s) for sample in samples])[:-1])):
        sample.size[:] = own


def _parameters(outline: Outline, index: int, sample: Samples) -> np.ndarray:
    """Parameters of the nodes inside an edge."""
    edge = outline.edges[index]
    fewest = 1 if edge.kind in ("line", "polyline") else 2
    stops = [0.0, *_corners(outline, index), 1.0]
    steps = np.diff(sample.arc) * 0.5 * (1.0 / sample.size[1:] + 1.0 / sample.size[:-1])
    total = np.concatenate([[0.0], np.cumsum(steps)])
    found = []
    for a, b in itertools.pairwise(stops):
        low, high = np.interp([a, b], sample.s, total)
        count = max(round(float(high - low)), fewest)
        inner = np.interp(np.linspace(low, high, count + 1)[1:-1], total, sample.s)
        found += [inner, [b]]
    return np.concatenate(found)[:-1]


def _corners(outline: Outline, index: int) -> list[float]:
    """Parameters of the corners inside a polyline that become nodes."""
    edge = outline.edges[index]
    if edge.kind != "polyline" or not edge.inner:
        return []
    sides = np.diff(outline.points[outline.layout.controls[index]], axis=0)
    turn = np.abs(_angle(sides[:-1], sides[1:]))
    return [knot for knot, angle in zip(edge.knots[1:-1], turn) if angle > CORNER]
