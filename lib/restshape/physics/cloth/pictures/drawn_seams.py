"""Seams in pictures of cloth: along the edges of the pattern, and where these lie in space."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from restshape.report.outlines import border, sides
from restshape.scene.model import Scene
from restshape.scene.seam_keys import Seam
from restshape.shape.outline import Outline
from restshape.shape.outward import outward_of, text_angle
from restshape.shape.patterns.seam_parts import seam_colours

NEAR = 0.3
"""Distance from an edge over the length of a side of the mesh up to which that lies on the edge."""
CLOSE = 0.1
"""The same of a side's ends and middle, where the cloth goes on beyond the edge."""
SHARP = 0.5
"""Cosine of the angle of a tip above which two edges are a dart."""
SAMPLES = 33
"""Points of an edge that sides are compared with, at least, for each of its pieces."""


@dataclass(frozen=True)
class NamePlace:
    """Where a name stands.

    Args:
        place: (2,) on the seam [m]; outward: (2,) direction to its outer side; angle: of the text [rad].
    """

    place: np.ndarray
    outward: np.ndarray
    angle: float


@dataclass(frozen=True)
class DrawnSeam:
    """One seam.

    Args:
        name: of it; colour: of both of its sides.
        sides: nodes (m, 2) of the mesh's sides along all of its edges.
        edges: points (k, 2) [m] along each of its edges in the pattern.
        names: where its name stands in the pattern.
    """

    name: str
    colour: str
    sides: np.ndarray
    edges: tuple[np.ndarray, ...]
    names: tuple[NamePlace, ...]


def drawn_seams(scene: Scene, outline: Outline, X: np.ndarray, cells: np.ndarray) -> list[DrawnSeam]:
    """The seams of a scene on a mesh of its pattern.

    Args:
        scene: of cloth; outline: of it; X: (n, 2) nodes in the pattern [m]; cells: (ne, 3) or (ne, 6).
    """
    seams: dict[str, Seam] = getattr(scene, "seams", {}) or {}
    if not seams:
        return []
    around = border(cells)[:, :2]
    lines = [_fine(outline, e) for e in range(len(outline.edges))]
    middles, long = X[around].mean(axis=1), np.linalg.norm(X[around[:, 1]] - X[around[:, 0]], axis=1)
    even = [_even(line, NEAR * float(long.min())) for line in lines]
    owner = np.repeat(np.arange(len(even)), [len(line) for line in even])
    off, nearest = cKDTree(np.concatenate(even)).query(middles)
    own = np.where(off <= NEAR * long, owner[nearest], -1)
    inside = _inside(outline)
    colours, found = seam_colours(tuple(seams)), []
    for name, seam in seams.items():
        edges = [e for side in seam.sides for edge in side for e in outline.entity(edge).edges]
        places = tuple(_name_places(outline, edges, lines))
        within = [_sides_along(lines[e], X, cells) for e in edges if e in inside]
        on_seam, own_lines = np.concatenate([around[np.isin(own, edges)], *within]), tuple(lines[e] for e in edges)
        found.append(DrawnSeam(name, colours[name], on_seam, own_lines, places))
    return found


def _inside(outline: Outline) -> set[int]:
    """Edges with cloth on both sides, which regions alone have."""
    of_regions, of_borders = (
        {e for loop in outline.loops if (loop.kind == "region") is region for e, _ in loop.edges}
        for region in (True, False)
    )
    return of_regions - of_borders


def _sides_along(line: np.ndarray, X: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """The sides (k, 2) of the mesh that lie on a line (p, 2) [m] within the cloth."""
    ends = sides(cells)[:, :2]
    low, high = X[ends].min(axis=1), X[ends].max(axis=1)
    long = np.linalg.norm(high - low, axis=1)
    reach = CLOSE * long[:, None]
    ends = ends[((high >= line.min(axis=0) - reach) & (low <= line.max(axis=0) + reach)).all(axis=1)]
    long = np.linalg.norm(X[ends[:, 1]] - X[ends[:, 0]], axis=1)
    if not len(ends):
        return ends
    tree = cKDTree(_even(line, CLOSE * float(long.min())))
    off = np.array([tree.query(places)[0] for places in (X[ends[:, 0]], X[ends[:, 1]], X[ends].mean(axis=1))])
    return ends[(off <= CLOSE * long).all(axis=0)]


def _even(line: np.ndarray, step: float) -> np.ndarray:
    """Points (m, 2) along a line (p, 2) [m], no further from each other than a step [m]."""
    at = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1)))
    s = np.linspace(0.0, at[-1], int(at[-1] / step) + 2)
    return np.column_stack([np.interp(s, at, line[:, k]) for k in range(2)])


def _name_places(outline: Outline, edges: Sequence[int], lines: Sequence[np.ndarray]) -> Iterator[NamePlace]:
    """The places of a seam's name: at the tip of a dart, at the longest of the edges that meet elsewhere."""
    ends = {e: {outline.edges[e].start, outline.edges[e].end} for e in edges}
    left = dict.fromkeys(edges)
    while left:
        chain = [next(iter(left))]
        for e in chain:
            left.pop(e, None)
            chain += [other for other in left if ends[other] & ends[e] and other not in chain]
        if len(chain) == 2 and len(tips := ends[chain[0]] & ends[chain[1]]) == 1:
            tip = outline.points[next(iter(tips))]
            ways = [_unit(lines[e][[0, -1]].sum(axis=0) - 2.0 * tip) for e in chain]
            if ways[0] @ ways[1] > SHARP:
                yield NamePlace(tip, -_unit(ways[0] + ways[1]), 0.0)
                continue
        yield _beside(outline, max(chain, key=outline.length))


def _beside(outline: Outline, edge: int) -> NamePlace:
    """A name along the middle of an edge, on its outer side; on that of its region where the cloth goes on."""
    loops = sorted(outline.loops, key=lambda loop: loop.kind == "region")
    forward = next(f for loop in loops for e, f in loop.edges if e == edge)
    outward = outward_of(outline, edge, forward, 0.5)
    return NamePlace(outline.point(edge, 0.5)[0], outward, text_angle(outward))


def _unit(way: np.ndarray) -> np.ndarray:
    return way / (float(np.hypot(*way)) or 1.0)


def _fine(outline: Outline, edge: int) -> np.ndarray:
    """Points (m, 2) along an edge."""
    knots = outline.pieces(edge, 1e-3 * outline.size)
    s = np.interp(np.linspace(0.0, len(knots) - 1.0, SAMPLES * (len(knots) - 1)), np.arange(len(knots)), knots)
    return np.asarray(outline.point(edge, s))
