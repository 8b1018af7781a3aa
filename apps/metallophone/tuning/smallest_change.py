"""The smallest change within bounds that linear equations ask for, or the one that comes nearest to them."""

import numpy as np
from scipy.optimize import lsq_linear

WEIGHT = 1e4
"""Of the equations beside the size of the change: they are met but for its square."""
DEPENDENT = 1e-10
"""Added to the metric, whose diagonal is 1: freedoms that move the same share the change."""


def smallest_change(
    metric: np.ndarray, J: np.ndarray, wanted: np.ndarray, low: np.ndarray, high: np.ndarray
) -> np.ndarray:
    """The change q (k,) with J q = wanted, low <= q <= high and the least q^T metric q.

    Where bounds do not allow the equations, that with the least sum of squares of what is missing. All is one bounded
    least-squares problem, in which the equations weigh more.

    Args:
        metric: (k, k) positive semidefinite, with a positive diagonal.
        J: (m, k); wanted: (m,).
        low, high: (k,), with low < high.

    Source: C. L. Lawson and R. J. Hanson, Solving least squares problems, chapter 22 (weighting).
    """
    scale = 1.0 / np.sqrt(np.diag(metric))
    unit = metric * np.outer(scale, scale) + DEPENDENT * np.eye(len(scale))
    root = np.linalg.cholesky(unit).T
    rows = J * scale
    size = float(np.linalg.norm(np.linalg.solve(root.T, rows.T), axis=0).max())
    if size == 0.0:
        return np.clip(np.zeros(len(scale)), low, high)
    A = np.vstack([root, WEIGHT / size * rows])
    b = np.concatenate([np.zeros(len(scale)), WEIGHT / size * wanted])
    # Numbers of the order of 1: the largest change that the equations ask for.
    unit_of_b = float(np.abs(b).max()) / WEIGHT or 1.0
    found = lsq_linear(A, b / unit_of_b, (low / scale / unit_of_b, high / scale / unit_of_b), "bvls", tol=1e-14)
    return np.clip(found.x * scale * unit_of_b, low, high)
