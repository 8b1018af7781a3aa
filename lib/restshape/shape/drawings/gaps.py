"""Ends of loose curves that meet, and ends that do not quite meet brought together within a tolerance."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from restshape.arrays import Reals
from restshape.outputs.si_numbers import si

JOIN = 1e-6
"""Ends closer than this share of the drawing's size are one vertex: drawings round their numbers."""
CANDIDATES = 8
"""Open ends that are looked at as partners of one."""


@dataclass(frozen=True)
class Gap:
    """Two open ends that were brought together.

    Args:
        at: (x, y) where they meet now, half-way [m].
        size: how far they were from each other [m].
        between: what the two curves are in the file.
    """

    at: tuple[float, float]
    size: float
    between: tuple[str, str]

    def __str__(self) -> str:
        first, second = self.between
        return f"{si(self.size, 'm')} at ({self.at[0]:.6g}, {self.at[1]:.6g}) m, between {first} and {second}"


@dataclass
class Joints:
    """Where curves end.

    Args:
        ends: of each curve the vertices at its start and end.
        corners: (n, 2) the vertices [m].
    """

    ends: list[tuple[int, int]]
    corners: Reals

    def open_ends(self) -> dict[int, int]:
        """The curve that ends at each vertex where nothing else does, by vertex."""
        touching: dict[int, list[int]] = defaultdict(list)
        for curve, pair in enumerate(self.ends):
            for vertex in pair:
                touching[vertex].append(curve)
        return {vertex: curves[0] for vertex, curves in touching.items() if len(curves) == 1}

    def nearest_open(self, vertex: int) -> tuple[float, int] | None:
        """How far the nearest open end of another curve is [m], and that curve; None where there is none."""
        loose = self.open_ends()
        others = [other for other, curve in loose.items() if curve != loose.get(vertex)]
        if not others:
            return None
        distances = np.hypot(*(self.corners[others] - self.corners[vertex]).T)
        nearest = int(distances.argmin())
        return float(distances[nearest]), loose[others[nearest]]


def joints(starts: Reals, stops: Reals, size: float) -> Joints:
    """Vertices at the ends of curves: those of one place are one.

    Args:
        starts, stops: (n, 2) where the curves begin and end [m].
        size: of the drawing [m]; ends closer than `JOIN` of it are one vertex.
    """
    reach = JOIN * size or 1.0
    lowest = np.minimum(starts.min(axis=0), stops.min(axis=0))
    cells: dict[tuple[int, int], list[int]] = defaultdict(list)
    corners: list[Reals] = []

    def vertex(p: Reals) -> int:
        i, j = (int(c) for c in (p - lowest) // reach)
        near = [v for di in (-1, 0, 1) for dj in (-1, 0, 1) for v in cells.get((i + di, j + dj), ())]
        apart = [float(np.hypot(*(corners[v] - p))) for v in near]
        if apart and min(apart) <= reach:
            return near[apart.index(min(apart))]
        cells[i, j].append(len(corners))
        corners.append(p)
        return len(corners) - 1

    return Joints([(vertex(a), vertex(b)) for a, b in zip(starts, stops)], np.array(corners))


def closed(found: Joints, tolerance: float, sources: Sequence[str]) -> tuple[Joints, list[Gap]]:
    """The same curves with gaps between open ends closed, the smallest first; both ends go half-way.

    Args:
        found: where the curves end.
        tolerance: the largest gap that is closed [m].
        sources: what each curve is in the file.

    Returns:
        Where the curves end now, and what was closed, the largest first.
    """
    from scipy.spatial import cKDTree

    loose = found.open_ends()
    vertices = list(loose)
    if len(vertices) < 2 or tolerance <= 0.0:
        return found, []
    places = found.corners[vertices]
    most = min(CANDIDATES + 1, len(vertices))
    apart, partners = cKDTree(places).query(places, k=most, distance_upper_bound=tolerance * (1.0 + 1e-12))
    pairs = sorted(
        (float(apart[i, k]), i, int(partners[i, k]))
        for i in range(len(vertices))
        for k in range(1, most)
        if partners[i, k] < len(vertices) and i != partners[i, k]
    )
    corners, gaps = found.corners.copy(), []
    instead: dict[int, int] = {}
    for size, i, j in pairs:
        first, second = vertices[i], vertices[j]
        taken = {first, second} & (instead.keys() | set(instead.values()))
        if taken or loose[first] == loose[second]:
            continue
        instead[second] = first
        corners[first] = 0.5 * (corners[first] + corners[second])
        at = (float(corners[first, 0]), float(corners[first, 1]))
        gaps.append(Gap(at, size, (sources[loose[first]], sources[loose[second]])))
    kept = sorted(set(range(len(corners))) - instead.keys())
    number = {vertex: place for place, vertex in enumerate(kept)}
    ends = [(number[instead.get(a, a)], number[instead.get(b, b)]) for a, b in found.ends]
    return Joints(ends, corners[kept]), gaps[::-1]
