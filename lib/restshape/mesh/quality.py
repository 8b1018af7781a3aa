"""What triangles are measured by: their areas, and the thresholds of the two criteria."""

import numpy as np

EQUILATERAL_RATIO = 2.0 * np.sqrt(3.0)
"""Longest edge over inscribed radius of an equilateral triangle."""

AUTHOR_RATIO = 15.0
"""The author's limit for longest edge x half perimeter / area: beyond it a triangle is of low quality."""

AUTHOR_AREA = 1e-5
"""The author's limit for area over the mean edge squared: below it a triangle is inverted."""


def areas(X: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Signed areas (ne,) [m^2], positive counterclockwise.

    Args:
        X: (n, 2) node positions [m].
        cells: (ne, 3) nodes of the triangles.
    """
    a, b, c = X[cells[:, 0]], X[cells[:, 1]], X[cells[:, 2]]
    u, v = b - a, c - a
    return 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])


def thresholds(criterion: str, min_quality: float, X: np.ndarray, edge_nodes: np.ndarray) -> tuple[float, float]:
    """Quality below which a triangle is of low quality, and area [m^2] up to which it is inverted.

    Args:
        criterion: "quality" (min_quality, area 0) or "author" (the thresholds of the author's released code).
        min_quality: between 0 and 1; used by "quality".
        X: (n, 2) node positions of a fresh mesh [m].
        edge_nodes: (n_edges, 2) its edges.
    """
    if criterion == "quality":
        return min_quality, 0.0
    mean_edge = np.linalg.norm(X[edge_nodes[:, 1]] - X[edge_nodes[:, 0]], axis=1).mean()
    return EQUILATERAL_RATIO / AUTHOR_RATIO, AUTHOR_AREA * mean_edge**2
