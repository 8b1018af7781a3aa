"""Means over edges by their length, and over regions by their area, however the nodes lie."""

from collections.abc import Callable

import numpy as np

from restshape.fem.space import PlaneSpace

SIMPSON = np.array([1.0, 1.0, 4.0]) / 6.0
"""Weights of a side's ends and middle."""


def mean_over(space: PlaneSpace, at: str | None, nodes: np.ndarray | slice) -> Callable[[np.ndarray], float]:
    """The function that takes the mean of values at nodes over an entity, on the mesh at rest as it then lies.

    Arguments as in `node_weights`.
    """
    weights = node_weights(space, at, nodes)
    if weights is None:
        return plain_mean

    def mean(values: np.ndarray) -> float:
        w = weights()
        # As numpy's average does it, without its checks, which take as long as all else here.
        return (values * w).sum() / w.sum()

    return mean


def node_weights(space: PlaneSpace, at: str | None, nodes: np.ndarray | slice) -> Callable[[], np.ndarray] | None:
    """The function of the weights (k,) of nodes in a mean over an entity; None where they are equal.

    Args:
        space: whose nodes they are.
        at: an entity: a region or all (None) counts by area, edges by length, vertices one like the other.
        nodes: of the values, in their order; each of them on the entity.
    """
    weights_of: Callable[[np.ndarray, np.ndarray], np.ndarray]
    if at is None:
        places, weights_of = space.cells, cell_weights
    elif len(cells := space.cells_of(at)):
        places, weights_of = space.cells[cells], cell_weights
    elif len(facets := space.facets_of(at)):
        places, weights_of = space.facets[facets], facet_weights
    else:
        return None
    return lambda: np.bincount(places.ravel(), weights_of(space.X, places).ravel(), len(space.X))[nodes]


def plain_mean(values: np.ndarray) -> float:
    """The mean of values (m,); numpy's own takes five times as long for so few."""
    return values.sum() / len(values)


def facet_weights(X: np.ndarray, facets: np.ndarray) -> np.ndarray:
    """Lengths [m] that stand for the nodes of facets (m, 2) or (m, 3: both ends, middle)."""
    P = X[facets]
    chord = P[:, 1] - P[:, 0]
    if facets.shape[1] == 2:
        return np.repeat(0.5 * np.hypot(*chord.T)[:, None], 2, axis=1)
    bend = 2.0 * (P[:, 0] + P[:, 1] - 2.0 * P[:, 2])
    tangents = np.stack([chord - bend, chord + bend, chord], axis=1)
    return SIMPSON * np.hypot(tangents[..., 0], tangents[..., 1])


def cell_weights(X: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Areas [m^2] that stand for the nodes of triangles (m, 3), or (m, 6), whose corners count nothing."""
    P = X[cells]
    if cells.shape[1] == 3:
        thirds = _cross(P[:, 1] - P[:, 0], P[:, 2] - P[:, 0]) / 6.0
        return np.broadcast_to(thirds[:, None], cells.shape)
    sides = np.roll(P[:, :3], -1, axis=1) - P[:, :3]
    weights = np.zeros(cells.shape)
    for k in range(3):
        # At the middle of a side: the tangents along it and towards the corner beyond.
        first, second, beyond = k, (k + 1) % 3, (k + 2) % 3
        across = 2.0 * (P[:, 3 + second] + P[:, 3 + beyond] - P[:, 3 + k]) - P[:, beyond]
        across -= 0.5 * (P[:, first] + P[:, second])
        weights[:, 3 + k] = _cross(sides[:, k], across) / 6.0
    return weights


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
