"""Fields near a place as quadratic polynomials, fitted to the nodes around it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

RINGS = 2
"""Rings of triangles around a segment whose nodes are fitted."""
TERMS = 6
"""Of a quadratic polynomial of two variables."""


@dataclass(frozen=True, eq=False)
class QuadraticPatch:
    """Polynomials of fields (k,) of the distance from a place.

    Args:
        place: (2,) [m].
        reach: [m] of the nodes that are fitted.
        terms: (6, k) of 1, x, y, x^2/2, x y, y^2/2.
    """

    place: np.ndarray
    reach: float
    terms: np.ndarray

    def values(self, place: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Fields (k,), gradients (2, k) and second derivatives (2, 2, k) at a place (2,)."""
        x, y = place - self.place
        constant, fx, fy, fxx, fxy, fyy = self.terms
        gradient = np.stack([fx + x * fxx + y * fxy, fy + x * fxy + y * fyy])
        second = np.stack([np.stack([fxx, fxy]), np.stack([fxy, fyy])])
        value = constant + x * fx + y * fy + 0.5 * x * x * fxx + x * y * fxy + 0.5 * y * y * fyy
        return value, gradient, second


def quadratic_patch(
    X: np.ndarray, triangles: np.ndarray, fields: np.ndarray, place: np.ndarray, start: np.ndarray
) -> QuadraticPatch | None:
    """Fits fields (n, k) of the nodes X (n, 2) around a place (2,); None where too few nodes are near.

    Args:
        X, fields: of the nodes; triangles: (m, 3) of them.
        place: in or on a triangle.
        start: nodes (s,) of that triangle, from which rings of neighbours are counted, so that no gap is bridged.
    """
    near = np.zeros(len(X), dtype=bool)
    near[start] = True
    for _ in range(RINGS):
        near[triangles[near[triangles].any(axis=1)]] = True
    nodes = np.flatnonzero(near)
    away = X[nodes] - place
    reach = float(np.hypot(*away.T).max())
    x, y = away.T / reach
    rows = np.stack([np.ones(len(x)), x, y, 0.5 * x * x, x * y, 0.5 * y * y], axis=1)
    found, _, rank, _ = np.linalg.lstsq(rows, fields[nodes], rcond=1e-10)
    if rank < TERMS:
        return None
    return QuadraticPatch(place, reach, found / reach ** np.array([0, 1, 1, 2, 2, 2])[:, None])
