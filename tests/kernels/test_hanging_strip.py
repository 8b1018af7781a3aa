"""A strip of St. Venant-Kirchhoff material that hangs under its own weight, by Newton's method on small meshes.

Without lateral contraction its stretch l obeys l (l^2 - 1)/2 = (rho g / E)(L - X), a cubic at each place.
"""

import numpy as np
import pytest
from sample_meshes import second_order, unit_box

from restshape import _kernels as k

TIP = {0.1: 0.045797685, 0.5: 0.182257884, 1.0: 0.305359307}
"""Elongation of the tip over L by rho g L / E."""


def hanging(name: str, per_side: int, weight: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nodes, cells and displacements of a unit strip held at x = 0, E = 1, nu = 0, weight rho g along x."""
    dim = 3 if "tet" in name else 2
    X, cells, inner = unit_box(dim, per_side)
    if name.endswith(("6", "10")):
        X, cells, _ = second_order(X, cells, inner)
    element = k.Element(name)
    p = np.array([0, 0.5, 1.0, weight, 0] if dim == 2 else [0, 0.5, weight, 0, 0])
    free = np.flatnonzero(np.repeat(X[:, 0] > 1e-9, dim))
    dofs = (dim * cells[:, :, None] + np.arange(dim)).reshape(len(cells), -1)
    u = np.zeros_like(X)
    for _ in range(12):
        residual, K = np.zeros_like(X), np.zeros((X.size, X.size))
        element.residual(X, u, cells, p, residual)
        for cell, rows in zip(cells, dofs):
            K[np.ix_(rows, rows)] += element.tangent_block(X[cell], u[cell], p)
        step = np.linalg.solve(K[np.ix_(free, free)], -residual.ravel()[free])
        u.ravel()[free] += step
        if np.abs(step).max() < 1e-12:
            return X, cells, u
    raise AssertionError("Newton's method did not converge")


@pytest.mark.parametrize("weight", TIP)
@pytest.mark.parametrize(
    ("name", "per_side", "tolerance"),
    [("stvk_tri3", 12, 2e-3), ("stvk_tri6", 6, 1e-4), ("stvk_dilatation_tri6", 6, 1e-4), ("stvk_tet4", 5, 1e-2),
     ("stvk_tet10", 2, 2e-3)],
)  # fmt: skip
def test_tip_hangs_where_the_cubic_says(name, per_side, tolerance, weight):
    X, _, u = hanging(name, per_side, weight)
    tip = u[X[:, 0] > 1 - 1e-9, 0]
    np.testing.assert_allclose(tip.mean(), TIP[weight], rtol=tolerance)


def test_displacement_converges_at_the_order_of_the_element():
    """Errors at nodes against the integral of the cubic's root: order 2 for linear triangles, at least 3 above."""

    def error(name: str, per_side: int) -> float:
        X, _, u = hanging(name, per_side, 1.0)
        at, weights = np.polynomial.legendre.leggauss(20)
        s = X[:, :1] * (at + 1) / 2  # places between the support and each node
        c = 1.0 - s  # rho g (L - X) / E
        # The largest root of l^3 - l - 2 c = 0.
        root = np.array([max(np.roots([1, 0, -1, -2 * v]).real) for v in c.ravel()]).reshape(c.shape)
        exact = X[:, 0] / 2 * ((root - 1) @ weights)
        return float(np.sqrt(np.mean((u[:, 0] - exact) ** 2)))

    assert np.log2(error("stvk_tri3", 4) / error("stvk_tri3", 8)) > 1.8
    assert np.log2(error("stvk_tri6", 2) / error("stvk_tri6", 4)) > 2.8
