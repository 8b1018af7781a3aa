"""The shadow of a drape from above: its area, and the folds around it.

G. E. Cusick, The Measurement of Fabric Drape, Journal of the Textile Institute 59 (6), 1968: a round cloth on a smaller
disc casts a shadow, and the drape coefficient is the shadow's area over the cloth's, each less the disc's.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from restshape.mesh.mesh import Mesh

DIRECTIONS = 1440
"""Directions in which a shadow is measured."""
ROUNDING = 1e-9
"""Steps between directions by which one counts as that of a node."""
GRAZING = 0.02
"""Sine of the angle between a direction and an edge below which the place moves along the edge."""
FOLD = 0.02
"""Share of the mean radius by which a shadow rises and falls where there is a fold."""


@dataclass(frozen=True, eq=False)
class ShadowEdge:
    """The edge of a shadow as it is seen from a point: a place in each direction, on an edge of the mesh.

    Args:
        middle: (2,) the point [m].
        radii: (`DIRECTIONS`,) from there [m].
        nodes: (`DIRECTIONS`, 2) of the edge of the mesh; shares: (`DIRECTIONS`,) of the second one.
        normals: (`DIRECTIONS`, 2) of the edge of the mesh from above, outwards.
    """

    middle: np.ndarray
    radii: np.ndarray
    nodes: np.ndarray
    shares: np.ndarray
    normals: np.ndarray

    def points(self) -> np.ndarray:
        """Places (`DIRECTIONS`, 2) [m], counter-clockwise."""
        return self.middle + self.radii[:, None] * directions()

    def radius_rates(self, s: np.ndarray) -> np.ndarray:
        """Rates (`DIRECTIONS`,) of the radii as nodes move with s (n, 2 or 3); where the edge goes along the direction,
        those of its place."""
        a, b = s[self.nodes[:, 0], :2], s[self.nodes[:, 1], :2]
        way, moved = directions(), a + self.shares[:, None] * (b - a)
        across = np.einsum("ka,ka->k", self.normals, way)
        slanted = across > GRAZING
        by_normal = np.einsum("ka,ka->k", self.normals, moved) / np.where(slanted, across, 1.0)
        return np.where(slanted, by_normal, np.einsum("ka,ka->k", way, moved))


class DrapeShadow:
    """Measures the shadow of one mesh.

    Args:
        cells: (m, 3) triangles; border: (k, 2) facets around it, without those of holes.
    """

    def __init__(self, cells: np.ndarray, border: np.ndarray) -> None:
        sides = np.sort(np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]]), axis=1)
        self._edges = np.unique(sides, axis=0)
        self._around = border

    @classmethod
    def of(cls, mesh: Mesh) -> DrapeShadow:
        """The shadow of a mesh, whose border is the outlines of its pieces, without holes."""
        around = {edge for loop in mesh.outline.loops if loop.kind == "outline" for edge, _ in loop.edges}
        return cls(mesh.cells, mesh.facets[np.isin(mesh.facet_edge, list(around))])

    def middle(self, places: np.ndarray) -> np.ndarray:
        """The middle (2,) [m] of the cloth's border, of nodes at places (n, 3) [m]."""
        ends = places[self._around]
        lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        return np.average(ends[:, :, :2].mean(axis=1), axis=0, weights=lengths)

    def radii(self, places: np.ndarray) -> np.ndarray:
        """How far the cloth reaches (`DIRECTIONS`,) [m] from the middle of its border, 0 where it does not reach.

        Args:
            places: (n, 3) of the nodes [m].
        """
        flat = places[:, :2] - self.middle(places)
        return reach(flat[self._edges[:, 0]], flat[self._edges[:, 1]])

    def edge(self, places: np.ndarray, middle: np.ndarray) -> ShadowEdge:
        """The edge of the shadow as it is seen from a point (2,) [m] below the cloth, of nodes at places (n, 3) [m]."""
        flat = places[:, :2] - middle
        hits = _hits(flat[self._edges[:, 0]], flat[self._edges[:, 1]])
        order = np.lexsort([hits.far, hits.number])
        last = np.searchsorted(hits.number[order], np.arange(DIRECTIONS), side="right") - 1
        best = order[last]
        nodes, radii = self._edges[hits.row[best]], hits.far[best]
        # Directions in which there is no cloth have radius 0.
        radii = np.where(hits.number[best] == np.arange(DIRECTIONS), radii, 0.0)
        a, b = flat[nodes[:, 0]], flat[nodes[:, 1]]
        along, way = b - a, directions()
        length = np.maximum(np.einsum("ka,ka->k", along, along), np.finfo(float).tiny)
        shares = np.clip(np.einsum("ka,ka->k", radii[:, None] * way - a, along) / length, 0.0, 1.0)
        normals = np.stack([along[:, 1], -along[:, 0]], axis=1) / np.sqrt(length)[:, None]
        inwards = np.einsum("ka,ka->k", normals, way) < 0.0
        return ShadowEdge(middle, radii, nodes, shares, np.where(inwards[:, None], -normals, normals))

    def area(self, places: np.ndarray) -> float:
        """Area [m^2] of the shadow, as far as it is seen from its middle: gaps between that and the cloth are in it."""
        return float(0.5 * (self.radii(places) ** 2).sum() * 2.0 * np.pi / DIRECTIONS)

    def folds(self, places: np.ndarray) -> int:
        """Number of the folds that reach out of the shadow."""
        return count_folds(self.radii(places))


@dataclass(frozen=True, eq=False)
class _Hits:
    """Where segments meet directions from the origin.

    Args:
        row: (k,) of segments; number: (k,) of directions; far: (k,) distances there.
    """

    row: np.ndarray
    number: np.ndarray
    far: np.ndarray


def directions() -> np.ndarray:
    """Unit vectors (`DIRECTIONS`, 2) in which a shadow is measured, counter-clockwise from x."""
    angles = 2.0 * np.pi / DIRECTIONS * np.arange(DIRECTIONS)
    return np.stack([np.cos(angles), np.sin(angles)], axis=1)


def reach(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The largest distance (`DIRECTIONS`,) from the origin to segments from a (m, 2) to b (m, 2), in each direction."""
    hits, found = _hits(a, b), np.zeros(DIRECTIONS)
    np.maximum.at(found, hits.number, hits.far)
    return found


def _hits(a: np.ndarray, b: np.ndarray) -> _Hits:
    """Where segments from a (m, 2) to b (m, 2) meet directions."""
    cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    # Each segment the way round in which its angle rises, by less than half a turn.
    a, b = np.where(cross[:, None] < 0.0, b, a), np.where(cross[:, None] < 0.0, a, b)
    step = 2.0 * np.pi / DIRECTIONS
    low = np.arctan2(a[:, 1], a[:, 0])
    span = np.arctan2(np.abs(cross), (a * b).sum(axis=1))
    first = np.ceil(low / step - ROUNDING).astype(int)
    count = np.maximum(np.floor((low + span) / step + ROUNDING).astype(int) - first + 1, 0)
    row = np.repeat(np.arange(len(a)), count)
    number = first[row] + np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
    way = np.stack([np.cos(step * number), np.sin(step * number)], axis=1)
    along = b[row] - a[row]
    across = way[:, 0] * along[:, 1] - way[:, 1] * along[:, 0]
    ends = np.maximum(np.hypot(*a[row].T), np.hypot(*b[row].T))
    # A segment along the direction reaches as far as its farther end.
    slanted = across > ROUNDING * np.hypot(*along.T)
    far = np.where(slanted, np.minimum(np.abs(cross[row]) / np.where(slanted, across, 1.0), ends), ends)
    return _Hits(row, number % DIRECTIONS, far)


def count_folds(radii: np.ndarray) -> int:
    """How often radii around a circle rise and fall again by more than `FOLD` of their mean."""
    ring = np.roll(radii, -int(radii.argmin()))
    least, folds, rising = FOLD * float(radii.mean()), 0, True
    low = high = float(ring[0])
    for radius in (*ring.tolist(), low):
        if rising:
            low, high = (min(low, radius), radius) if radius < low else (low, max(high, radius))
            if high - low > least and high - radius > least:
                folds, rising, low = folds + 1, False, radius
        else:
            low = min(low, radius)
            if radius - low > least:
                rising, high = True, radius
    return folds
