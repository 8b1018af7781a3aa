"""Quadrature on triangles."""

import numpy as np

_A, _B = 0.445948490915965, 0.091576213509771

DEGREE_4 = (
    np.array([[1 - 2 * a, a, a] for a in (_A, _B)])[:, [[0, 1, 2], [1, 0, 2], [1, 2, 0]]].reshape(-1, 3),
    np.repeat([0.223381589678011, 0.109951743655322], 3),
)
"""Barycentric coordinates (6, 3) and weights (6,), which sum to 1; exact for degree 4 (Dunavant 1985)."""


def collapsed(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Barycentric coordinates (n^2, 3) and weights of Gauss's rule on a square with one side shrunk to a point.

    Args:
        n: points in each direction; exact for degree 2 n - 2.
    """
    s, w = np.polynomial.legendre.leggauss(n)
    s, w = 0.5 * (s + 1.0), 0.5 * w
    x, t = np.meshgrid(s, s, indexing="ij")
    y = t * (1.0 - x)
    weights = 2.0 * np.outer(w * (1.0 - s), w)
    return np.stack([1.0 - x - y, x, y], axis=-1).reshape(-1, 3), weights.ravel()


SAMPLES = collapsed(4)
"""For fields of another mesh, which are smooth in parts of a cell only: with fewer points of second order, waves as
short as the cells grow from mesh to mesh."""
