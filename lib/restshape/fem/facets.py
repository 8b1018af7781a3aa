"""Functions along facets: their bases, values where loads are taken, lengths and centres."""

import functools

import numpy as np

from restshape.fem.nodal_values import Nodal, Product

SHAPES = {3: ("tri3", "edge2"), 6: ("tri6", "edge3")}
"""Shapes of cells and facets, by the nodes of a cell."""

# Places along a facet, 0 to 1, where a load is taken: its ends, or with three nodes Gauss's two points, for the line
# through the values there has the load's resultants up to a smaller error.
GAUSS = np.array([0.5 - np.sqrt(1 / 12), 0.5 + np.sqrt(1 / 12)])
ALONG = {2: np.array([0.0, 1.0]), 3: GAUSS}
LENGTH_RULE = np.array([0.5 - np.sqrt(0.15), 0.5, 0.5 + np.sqrt(0.15)]), np.array([5.0, 8.0, 5.0]) / 18.0


def facet_basis(nodes: int, s: np.ndarray) -> np.ndarray:
    """Values (m, nodes) of the basis functions of a facet, ends first, at places s (m,) from 0 to 1."""
    if nodes == 2:
        return np.stack([1.0 - s, s], axis=1)
    return np.stack([(1.0 - s) * (1.0 - 2.0 * s), s * (2.0 * s - 1.0), 4.0 * s * (1.0 - s)], axis=1)


def facet_slopes(nodes: int, s: np.ndarray) -> np.ndarray:
    """Derivatives (m, nodes) of `facet_basis` with respect to s."""
    if nodes == 2:
        return np.stack([-np.ones_like(s), np.ones_like(s)], axis=1)
    return np.stack([4.0 * s - 3.0, 4.0 * s - 1.0, 4.0 - 8.0 * s], axis=1)


@functools.cache
def _tables(nodes: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Of facets with so many nodes: values at the places of loads, from these to the ends, values and slopes at the
    points of `LENGTH_RULE`; not to be written to."""
    to_ends = np.linalg.inv(facet_basis(2, ALONG[nodes]))
    basis, slopes = (values(nodes, LENGTH_RULE[0]) for values in (facet_basis, facet_slopes))
    return facet_basis(nodes, ALONG[nodes]), to_ends, basis, slopes


class FacetSamples:
    """Samples fields along facets, where elements take a value that is linear between both ends.

    Args:
        facets: (nf, 2) or, of second order, (nf, 3) int32 nodes: ends, middle.
    """

    def __init__(self, facets: np.ndarray) -> None:
        self.facets = facets
        self._sampled, self._to_ends, self._basis, self._slopes = _tables(facets.shape[1])

    def at_samples(self, field: np.ndarray) -> np.ndarray:
        """A field (n, d) at the two places (2, nf, d) of each facet where values are taken."""
        if self.facets.shape[1] == 2:
            return field[self.facets.T]
        return np.einsum("qi,fik->qfk", self._sampled, field[self.facets])

    def at_ends(self, values: list[np.ndarray]) -> np.ndarray:
        """What values (nf, ...) at the two places are at the facets' ends (2, nf, ...), along a line."""
        if self.facets.shape[1] == 2:
            return np.stack(values)
        return np.einsum("eq,q...->e...", self._to_ends, np.stack(values))

    def ends_of(self, value: Nodal | Product, X: np.ndarray) -> np.ndarray:
        """A scalar value of the scene at the ends (2, nf) of the facets of nodes X (n, d) [m]."""
        return self.at_ends([value(at) for at in self.at_samples(X)])

    def end_rates_of(self, value: Nodal | Product, X: np.ndarray, dX: np.ndarray) -> np.ndarray:
        """Its rates (2, nf) there when nodes move with dX (n, d)."""
        return self.at_ends([value.rate(*place) for place in zip(self.at_samples(X), self.at_samples(dX))])

    def at_points(self, field: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """A field (n, d) and its derivatives along the facets, at the points (nf, 3, d) of `LENGTH_RULE`."""
        nodal = field[self.facets]
        return self._basis @ nodal, self._slopes @ nodal
