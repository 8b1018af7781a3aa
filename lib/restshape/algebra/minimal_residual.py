"""The method of generalised minimal residuals for operators that are functions, all directions kept."""

from collections.abc import Callable

import numpy as np


def minimal_residual(
    product: Callable[[np.ndarray], np.ndarray], b: np.ndarray, tolerance: float, most: int
) -> np.ndarray:
    """The x (n,) for which |b - A x| is least over the Krylov space of A and b, once it is below `tolerance` |b|.

    Args:
        product: A x of any x (n,).
        b: (n,).
        tolerance: relative to b.
        most: directions; beyond them the last x is given as it is.

    Source: Y. Saad and M. H. Schultz, SIAM J. Sci. Stat. Comput. 7 (1986) 856.
    """
    norm = float(np.linalg.norm(b))
    if norm == 0.0:
        return np.zeros_like(b)
    basis = np.empty((most + 1, b.size))
    basis[0] = b / norm
    hessenberg, right = np.zeros((most + 1, most)), np.zeros(most + 1)
    right[0] = norm
    for k in range(most):
        w = product(basis[k])
        for _ in range(2):
            parts = basis[: k + 1] @ w
            hessenberg[: k + 1, k] += parts
            w = w - parts @ basis[: k + 1]
        hessenberg[k + 1, k] = np.linalg.norm(w)
        y, *_ = np.linalg.lstsq(hessenberg[: k + 2, : k + 1], right[: k + 2], rcond=None)
        error = np.linalg.norm(right[: k + 2] - hessenberg[: k + 2, : k + 1] @ y)
        if error <= tolerance * norm or hessenberg[k + 1, k] == 0.0:
            break
        basis[k + 1] = w / hessenberg[k + 1, k]
    return y @ basis[: k + 1]
