"""The stiffness operator: rigid motions, symmetry, and the elimination of supports."""

import numpy as np
import pytest
from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.factors.gathering import gather_matrix
from restshape.algebra.operator import Operator

X = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0.4, 0.45]], dtype=float)
CELLS = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]], dtype=np.int32)
PARAMS = np.array([1.0, 2.0, 0.5, 0.0, 0.0])


def assembled(backend, mask, prescribed):
    """Matrix and right side of four triangles."""
    operator = Operator(PETSc.COMM_SELF, 2, np.array([0, 5], dtype=np.int32), backend)
    operator.set_topology([CELLS], mask)
    rhs = np.zeros((5, 2))
    element = _kernels.Element("linear_elastic_tri3")
    mat = operator.assemble([(0, element, X, prescribed, PARAMS, 1.0)], rhs.ravel())
    return gather_matrix(mat, PETSc.COMM_SELF).toarray(), rhs.ravel()


@pytest.mark.parametrize("backend", ["csr", "bcsr"])
def test_rigid_motions_cost_nothing(backend):
    K, _ = assembled(backend, np.zeros((5, 2)), np.zeros((5, 2)))
    turn = np.column_stack([-X[:, 1], X[:, 0]])
    for motion in (np.tile([1.0, 0.0], (5, 1)), np.tile([0.0, 1.0], (5, 1)), turn):
        np.testing.assert_allclose(K @ motion.ravel(), 0.0, atol=1e-14)
    np.testing.assert_allclose(K, K.T, atol=1e-15)
    assert np.sum(np.linalg.eigvalsh(K) > 1e-12) == 7


@pytest.mark.parametrize("backend", ["csr", "bcsr"])
def test_a_uniform_strain_has_its_energy(backend):
    K, _ = assembled(backend, np.zeros((5, 2)), np.zeros((5, 2)))
    u = np.column_stack([0.01 * X[:, 0], 0.02 * X[:, 0]]).ravel()
    # lambda/2 tr(e)^2 + mu e:e, e = [0.01, 0.01; 0.01, 0], times the thickness and the unit area.
    assert 0.5 * u @ K @ u == pytest.approx(0.5 * (0.5 * 0.01**2 + 2.0 * 3 * 0.01**2), rel=1e-12)


@pytest.mark.parametrize("backend", ["csr", "bcsr"])
def test_supports_are_eliminated_without_loss_of_symmetry(backend):
    whole, _ = assembled(backend, np.zeros((5, 2)), np.zeros((5, 2)))
    mask = np.ones((5, 2))
    mask[4] = 0
    prescribed = np.column_stack([0.1 * X[:, 0] + 0.2 * X[:, 1], -0.3 * X[:, 0]])
    prescribed[4] = 0
    K, rhs = assembled(backend, mask, prescribed)
    fixed = mask.ravel().astype(bool)
    assert np.all(K[np.ix_(~fixed, fixed)] == 0) and np.all(K[np.ix_(fixed, ~fixed)] == 0)
    np.testing.assert_allclose(K[np.ix_(~fixed, ~fixed)], whole[np.ix_(~fixed, ~fixed)], rtol=1e-15)
    np.testing.assert_allclose(rhs[~fixed], -(whole @ prescribed.ravel())[~fixed], rtol=1e-13)
    np.testing.assert_array_equal(rhs[fixed], 0.0)
    assert np.linalg.eigvalsh(K).min() > 0
    # A linear displacement of the rim is that of the node inside as well.
    np.testing.assert_allclose(np.linalg.solve(K, rhs)[8:], [0.1 * 0.4 + 0.2 * 0.45, -0.3 * 0.4], rtol=1e-13)
