"""Errors of a piecewise linear or quadratic displacement against an exact one, by quadrature on triangles."""

from collections.abc import Callable

import numpy as np

from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.mesh.mesh import Mesh
from restshape.mesh.quadratic_basis import quadratic_basis
from restshape.mesh.quadrature import DEGREE_4, collapsed

Field = Callable[[np.ndarray], np.ndarray]
POINTS, WEIGHTS = DEGREE_4
FINE = 5
"""Points in each direction of the rule for second order, whose error is not small at few points."""


def errors(mesh: Mesh | LagrangeSpace, x: np.ndarray, exact: Field, gradient: Field) -> tuple[float, float]:
    """The L2 error [m^2] and the H1 seminorm error [m] of nodal displacements x (n, 2) [m].

    Args:
        mesh: triangles of either order.
        x: (n, 2) displacement.
        exact: places (k, 2) to displacements (k, 2).
        gradient: places (k, 2) to displacement gradients (k, 2, 2), [i, j] = d u_i / d X_j.
    """
    second = mesh.cells.shape[1] == 6
    points, weights = collapsed(FINE) if second else DEGREE_4
    basis, slopes = quadratic_basis(points[:, 1:]) if second else _linear_basis(points)
    nodes, values = mesh.X[mesh.cells], x[mesh.cells]
    l2 = h1 = 0.0
    for shape, rise, weight in zip(basis, slopes, weights):
        places = np.einsum("i,eij->ej", shape, nodes)
        jacobian = np.einsum("ik,eij->ekj", rise, nodes)
        area = 0.5 * weight * np.linalg.det(jacobian)
        slope = np.linalg.solve(jacobian, np.einsum("ik,eij->ekj", rise, values)).transpose(0, 2, 1)
        l2 += (area * ((np.einsum("i,eij->ej", shape, values) - exact(places)) ** 2).sum(axis=1)).sum()
        h1 += (area * ((slope - gradient(places)) ** 2).sum(axis=(1, 2))).sum()
    return float(np.sqrt(l2)), float(np.sqrt(h1))


def _linear_basis(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Values (m, 3) and slopes (m, 3, 2) of the basis of a first-order triangle at barycentric coordinates (m, 3)."""
    slopes = np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]])
    return points, np.broadcast_to(slopes, (len(points), 3, 2))
