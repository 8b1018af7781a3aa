"""How the barrier between parts of cloth follows the flat pattern at constant positions, which its library has not."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.sparse import csr_matrix


def barrier_by_pattern(
    library: Any, collisions: Any, mesh: Any, places: np.ndarray, potential: Any, thickness: float, stiffness: float
) -> csr_matrix:
    """Derivatives (3 n, 3 n) [N/m] of the barrier's forces by the places of nodes in the flat pattern.

    Each collision's force is proportional to its weight, an area of the pattern. Edges that are nearly parallel have a
    part of it that depends on their lengths in the pattern too.

    Args:
        library: the module.
        collisions: near, built to be differentiable; mesh: of the pattern.
        places: (n, 3) positions [m].
        potential: of the collisions; thickness: at which they begin [m]; stiffness: pressure [Pa].

    Source: IPC Toolkit's `edge_edge_mollifier`; Li and others, ACM TOG 39(4), 2020, 49, section 5.3.
    """
    rows, cols, values = [], [], []
    rest, edges, cells = mesh.rest_positions, mesh.edges, mesh.faces
    for k in range(len(collisions)):
        one = collisions[k]
        nodes = np.array([node for node in one.vertex_ids(edges, cells) if node >= 0])
        own = (3 * nodes[:, None] + np.arange(3)).ravel()
        y = places[nodes].ravel()
        by_area = one.weight_gradient.tocoo()
        at = by_area.row if by_area.shape[1] == 1 else by_area.col
        # The force by weight, also of a pair whose weights cancel each other.
        weight, one.weight = one.weight, 1.0
        force = potential.gradient(one, y)
        rows.append(np.repeat(own, len(at)))
        cols.append(np.tile(at, len(own)))
        values.append(np.outer(force, by_area.data).ravel())
        cross = library.edge_edge_cross_squarednorm(*y.reshape(-1, 3)) if one.is_mollified() else np.inf
        if one.is_mollified() and cross < one.eps_x:
            change = weight * _by_threshold(library, one, y, cross, thickness, stiffness)
            rows.append(np.repeat(own, 12))
            cols.append(np.tile(own, 12))
            values.append(np.outer(change, library.edge_edge_mollifier_threshold_gradient(*rest[nodes])).ravel())
    size = places.size
    if not rows:
        return csr_matrix((size, size))
    joined = np.concatenate(values), (np.concatenate(rows), np.concatenate(cols))
    return csr_matrix(joined, shape=(size, size))


def _by_threshold(
    library: Any, pair: Any, y: np.ndarray, cross: float, thickness: float, stiffness: float
) -> np.ndarray:
    """The derivative (12,) of the force of a pair of edges, of weight 1, by where its mollifier ends.

    Args:
        pair: of edges at y (12,) [m]; cross: square of the product of both.
    """
    share = pair.compute_distance(y) / thickness**2
    log = np.log(share)
    value = -stiffness * thickness * (share - 1.0) ** 2 * log
    slope = -stiffness / thickness * (2.0 * (share - 1.0) * log + (share - 1.0) ** 2 / share)
    by_eps = library.edge_edge_mollifier_derivative_wrt_eps_x(cross, pair.eps_x)
    slope_by_eps = library.edge_edge_mollifier_gradient_derivative_wrt_eps_x(cross, pair.eps_x)
    turned = library.edge_edge_cross_squarednorm_gradient(*y.reshape(-1, 3))
    return by_eps * slope * pair.compute_distance_gradient(y) + slope_by_eps * value * turned
