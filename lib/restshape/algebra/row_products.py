"""Products of few long rows with each other: the distribution's BLAS takes several times as long for them."""

import numpy as np

from restshape import _kernels
from restshape.arrays import Reals


def row_products(a: Reals, b: Reals) -> Reals:
    """The scalar products (k, m) of rows a (k, n) with rows b (m, n)."""
    out = np.empty((len(a), len(b)))
    _kernels.row_products(a, b, out)
    return out


def combined(weights: Reals, rows: Reals) -> Reals:
    """The sums (m, n) of rows (k, n) with weights (m, k)."""
    out = np.empty((len(weights), rows.shape[1]))
    _kernels.combine_rows(np.ascontiguousarray(weights), rows, out, False)
    return out


def add_combined(weights: Reals, rows: Reals, out: Reals) -> None:
    """Add the sums of rows (k, n) with weights (m, k) to `out` (m, n)."""
    _kernels.combine_rows(np.ascontiguousarray(weights), rows, out, True)
