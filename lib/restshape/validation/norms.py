"""Errors of a piecewise linear displacement against an exact one, by quadrature on triangles."""

from collections.abc import Callable

import numpy as np

from restshape.mesh.mesh import Mesh

Field = Callable[[np.ndarray], np.ndarray]
# Six points of degree 4 (Dunavant 1985): barycentric coordinates of two orbits, and their weights.
_A, _B = 0.445948490915965, 0.091576213509771
POINTS = np.array([[1 - 2 * a, a, a] for a in (_A, _B)])[:, [[0, 1, 2], [1, 0, 2], [1, 2, 0]]].reshape(-1, 3)
WEIGHTS = np.repeat([0.223381589678011, 0.109951743655322], 3)


def errors(mesh: Mesh, x: np.ndarray, exact: Field, gradient: Field) -> tuple[float, float]:
    """The L2 error [m^2] and the H1 seminorm error [m] of nodal displacements x (n, 2) [m].

    Args:
        mesh: triangles.
        x: (n, 2) displacement.
        exact: places (k, 2) to displacements (k, 2).
        gradient: places (k, 2) to displacement gradients (k, 2, 2), [i, j] = d u_i / d X_j.
    """
    corners, values = mesh.X[mesh.cells], x[mesh.cells]
    edges = corners[:, 1:] - corners[:, :1]
    area = 0.5 * np.linalg.det(edges)
    slope = np.linalg.solve(edges, values[:, 1:] - values[:, :1]).transpose(0, 2, 1)
    l2 = h1 = 0.0
    for point, weight in zip(POINTS, WEIGHTS):
        places = np.einsum("i,eij->ej", point, corners)
        l2 += weight * (area * ((np.einsum("i,eij->ej", point, values) - exact(places)) ** 2).sum(axis=1)).sum()
        h1 += weight * (area * ((slope - gradient(places)) ** 2).sum(axis=(1, 2))).sum()
    return float(np.sqrt(l2)), float(np.sqrt(h1))
