"""Nodes on edges along which a velocity slides: it has no component across them, at whatever angle they lie."""

import numpy as np

CORNER = np.radians(20.0)
"""Lines that meet at a larger angle make a corner, at which nothing slides."""

TINY = 1e-300
"""In place of no length, at the tip of a spike, which is a corner."""


class Sliding:
    """What a vector field (its first two columns) keeps at nodes of edges along which it slides.

    The normal of a node is the sum of those of its facets, by their lengths: no volume passes such edges. At a corner
    of two edges the vector is 0.

    Args:
        facets: (k, 2) nodes of the parts of these edges, the material on their left.
        curves: (k,) which curve each is on: chords of one curve make no corner.
        given: nodes (m,) at which the vector is prescribed already.

    Attributes:
        nodes: (s,) int32 that slide.
        kept: (s, 3) components xx, xy and yy of the projection of each: I - n n^T, and 0 at a corner.

    Source: M. S. Engelman, R. L. Sani and P. M. Gresho, Int. J. Numer. Methods Fluids 2 (1982) 225: normals of nodes.
    """

    def __init__(self, facets: np.ndarray, curves: np.ndarray, given: np.ndarray) -> None:
        self._facets, self._curves = facets, curves
        self.nodes = np.setdiff1d(facets, given).astype(np.int32)
        self.kept = np.zeros((len(self.nodes), 3))
        # Of each node, the facet that ends there and the one that begins there: where there is one, it twice.
        before, after = np.full(facets.max(initial=-1) + 1, -1), np.full(facets.max(initial=-1) + 1, -1)
        before[facets[:, 1]] = after[facets[:, 0]] = np.arange(len(facets))
        self._before = np.where(before < 0, after, before)[self.nodes]
        self._after = np.where(after < 0, before, after)[self.nodes]
        self._normals, self._lengths = np.zeros((len(self.nodes), 2)), np.ones(len(self.nodes))
        self._places: np.ndarray | None = None
        self._columns, self._end = np.zeros((3, len(self.nodes))), self.nodes.max(initial=-1)

    def update(self, X: np.ndarray) -> None:
        """Set `kept` for nodes at X (n, 2) [m]; there is nothing to do where none of these has moved."""
        places = X[self._facets]
        if self._places is not None and np.array_equal(places, self._places):
            return
        self._places = places
        first, last = self._sides(X)
        dot, cross = (first * last).sum(axis=1), first[:, 0] * last[:, 1] - first[:, 1] * last[:, 0]
        sum_of_both = first + last
        self._lengths = np.maximum(np.linalg.norm(sum_of_both, axis=1), TINY)
        n = self._normals = sum_of_both / self._lengths[:, None]
        other = self._curves[self._before] != self._curves[self._after]
        corner = other & (np.abs(np.arctan2(cross, dot)) > CORNER)
        self.kept = np.column_stack([1.0 - n[:, 0] ** 2, -n[:, 0] * n[:, 1], 1.0 - n[:, 1] ** 2])
        self.kept[corner] = 0.0
        self._columns = np.ascontiguousarray(self.kept.T)

    def project(self, out: np.ndarray, first: int = 0) -> None:
        """Take from the first two columns of `out` (k, f), of nodes from a first one on, what these do not keep."""
        nodes, kept = self.nodes, self._columns
        if first or len(out) <= self._end:
            own = (nodes >= first) & (nodes < first + len(out))
            nodes, kept = nodes[own] - first, kept[:, own]
        xx, xy, yy = kept
        x, y = out[nodes, 0], out[nodes, 1]
        out[nodes, 0], out[nodes, 1] = xx * x + xy * y, xy * x + yy * y

    def turned(self, x: np.ndarray, dX: np.ndarray) -> np.ndarray:
        """The rate (n, f) that turning normals give a projected residual x (n, f), when nodes move with dX (n, 2).

        It is -dn (n . x), of the normals' rates dn: what was a reaction gets a part along the edge.
        """
        out = np.zeros_like(x)
        n, slides = self._normals, np.any(self.kept, axis=1)
        out[self.nodes, :2] = -self._turns(dX) * ((n * x[self.nodes, :2]).sum(axis=1) * slides)[:, None]
        return out

    def across(self, x: np.ndarray, dX: np.ndarray) -> np.ndarray:
        """The rates (n, f), across edges, of a field x (n, f) that slides, when nodes move with dX (n, 2)."""
        out = np.zeros_like(x)
        turns = (self._turns(dX) * x[self.nodes, :2]).sum(axis=1) * np.any(self.kept, axis=1)
        out[self.nodes, :2] = -self._normals * turns[:, None]
        return out

    def _sides(self, X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Outward normals (s, 2) of the facets before and after each node, as long as they are."""
        along = X[self._facets[:, 1]] - X[self._facets[:, 0]]
        normals = np.column_stack([along[:, 1], -along[:, 0]])
        return normals[self._before], normals[self._after]

    def _turns(self, dX: np.ndarray) -> np.ndarray:
        """Rates (s, 2) of the normals."""
        first, last = self._sides(dX)
        rates, n = (first + last) / self._lengths[:, None], self._normals
        return rates - n * (n * rates).sum(axis=1)[:, None]
