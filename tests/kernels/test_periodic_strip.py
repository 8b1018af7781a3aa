"""Dofs apart from geometry: a strip whose right side is its left one, against a column in closed form."""

import numpy as np
import pytest
from petsc4py import PETSc

from restshape import _kernels as k

LAMBDA, MU, HEIGHT = 1.3, 0.7, 0.8
FORCE = np.array([0.3, -0.9])


def strip(columns: int, rows: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Nodes, triangles, their dofs, and for each node whose dofs it has; the strip is periodic along x."""
    i, j = np.meshgrid(np.arange(columns + 1), np.arange(rows + 1), indexing="ij")
    X = np.column_stack([i.ravel() / columns, HEIGHT * j.ravel() / rows])
    node = np.arange(len(X)).reshape(columns + 1, rows + 1)
    a, b, c, d = node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]
    cells = np.vstack([np.column_stack([q.ravel() for q in t]) for t in ((a, b, c), (a, c, d))]).astype(np.int32)
    owner = node.copy()
    owner[-1] = owner[0]
    return X, cells, np.ascontiguousarray(owner.ravel()[cells], dtype=np.int32), owner.ravel()


@pytest.mark.parametrize("backend", ["csr", "bcsr"])
@pytest.mark.parametrize("columns", [1, 2, 5])
def test_strip_under_body_force(backend, columns):
    """u = b (H y - y^2/2)/modulus with mu along x and lambda + 2 mu along y: linear triangles have it at nodes."""
    X, cells, dofs, owner = strip(columns, 6)
    n = int(owner.max()) + 1
    element, params = k.Element("linear_elastic_tri3"), np.array([LAMBDA, MU, 1.0, *FORCE])
    op = k.Operator(False, 2, np.array([0, n], dtype=np.int32), 0, backend)
    op.set_topology([(cells, dofs)])
    op.set_constraints(np.repeat(X[:n, 1] == 0.0, 2).astype(np.uint8))
    rhs, u = np.zeros(2 * n), np.zeros((n, 2))
    op.begin()
    op.add(0, X, [(element, u, params, 1.0)], rhs)
    op.end()
    ksp = PETSc.KSP().create(PETSc.COMM_SELF)
    ksp.setOperators(op.mat)
    ksp.setType("preonly")
    ksp.getPC().setType("lu")
    change = op.mat.createVecRight()
    ksp.solve(PETSc.Vec().createWithArray(rhs, comm=PETSc.COMM_SELF), change)
    u += change.array.reshape(-1, 2)
    y = X[:, 1:]
    expected = FORCE / np.array([MU, LAMBDA + 2 * MU]) * (HEIGHT * y - y**2 / 2)
    np.testing.assert_allclose(u[owner], expected, atol=1e-13)
    out = np.zeros((n, 2))
    element.residual(X, u, cells, params, out, dofs=dofs)
    np.testing.assert_allclose(out[X[:n, 1] > 0], 0.0, atol=1e-13)


def test_geometry_and_dofs_need_a_row_each():
    _, cells, dofs, _ = strip(2, 2)
    op = k.Operator(False, 2, np.array([0, 9], dtype=np.int32))
    with pytest.raises(ValueError, match="a row for each element"):
        op.set_topology([(cells, dofs[1:].copy())])


def test_geometry_beyond_X_is_refused():
    X, cells, dofs, owner = strip(2, 2)
    op = k.Operator(False, 2, np.array([0, int(owner.max()) + 1], dtype=np.int32))
    op.set_topology([(cells, dofs)])
    op.begin()
    with pytest.raises(ValueError, match=r"needs X of shape \(9, 2\)"):
        op.add(0, X[:7], [(k.Element("linear_elastic_tri3"), np.zeros((6, 2)), np.ones(5), 1.0)])
