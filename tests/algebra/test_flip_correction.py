"""Old factors corrected around flipped edges: beside the formula in dense matrices, and in a replay."""

import numpy as np
import pytest
import scipy.sparse as sp
from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.preconditioner import order_factor

NODES, FIELDS = 30, 2
NONE = np.empty(0, dtype=np.int32)


def springs(pairs, rng):
    """Positive definite (n f, n f), with a spring of random stiffness, in all directions, between nodes of pairs."""
    found = np.zeros((NODES * FIELDS, NODES * FIELDS))
    for i, j in pairs:
        half = rng.normal(size=(FIELDS, FIELDS))
        stiffness = half @ half.T + np.eye(FIELDS)
        for a, b, sign in ((i, i, 1.0), (j, j, 1.0), (i, j, -1.0), (j, i, -1.0)):
            found[FIELDS * a : FIELDS * a + FIELDS, FIELDS * b : FIELDS * b + FIELDS] += sign * stiffness
    return found + 0.1 * np.eye(NODES * FIELDS)


def matrix(dense):
    found = sp.csr_matrix(dense)
    mat = PETSc.Mat().createAIJ(found.shape, csr=(found.indptr, found.indices, found.data), comm=PETSc.COMM_SELF)
    mat.setBlockSize(FIELDS)
    return mat


@pytest.fixture
def factored():
    """A factor of a chain of springs, and the matrix of the chain with three springs more."""
    rng = np.random.default_rng(3)
    chain = [(k, k + 1) for k in range(NODES - 1)]
    before = springs(chain, rng)
    after = before + springs([(4, 6), (5, 7), (20, 22)], rng)
    pc = PETSc.PC().create(PETSc.COMM_SELF)
    pc.setType("cholesky")
    order_factor(pc)
    pc.setOperators(matrix(before))
    pc.setUp()
    return pc, before, after


def applied(pc, b):
    right, x = (PETSc.Vec().createWithArray(array, comm=PETSc.COMM_SELF) for array in (b.copy(), np.zeros_like(b)))
    pc.apply(right, x)
    return x.getArray().copy()


def test_it_solves_around_flips_before_and_after_the_factor(factored):
    pc, before, after = factored
    b = np.random.default_rng(4).normal(size=len(before))
    nodes = np.array([4, 5, 6, 7, 20, 22], dtype=np.int32)
    mat = matrix(after)
    assert _kernels.correct_around(pc.getFactorMatrix().handle, mat.handle, nodes, FIELDS)
    chosen = (FIELDS * nodes[:, None] + np.arange(FIELDS)).ravel()

    def local(r):
        out = np.zeros_like(r)
        out[chosen] = np.linalg.solve(after[np.ix_(chosen, chosen)], r[chosen])
        return out

    x = local(b)
    x += np.linalg.solve(before, b - after @ x)
    x += local(b - after @ x)
    np.testing.assert_allclose(applied(pc, b), x, rtol=1e-10, atol=1e-12)
    np.testing.assert_allclose(applied(pc, b), x, rtol=1e-10, atol=1e-12)


def test_it_ends_where_there_are_no_nodes(factored):
    pc, before, after = factored
    b, mat, handle = np.ones(len(before)), matrix(after), pc.getFactorMatrix().handle
    assert not _kernels.correct_around(handle, mat.handle, NONE, FIELDS)
    assert _kernels.correct_around(handle, mat.handle, np.array([4, 5], dtype=np.int32), FIELDS)
    assert not _kernels.correct_around(handle, mat.handle, NONE, FIELDS)
    np.testing.assert_allclose(applied(pc, b), np.linalg.solve(before, b), rtol=1e-10)


def test_a_block_without_a_factor_leaves_the_old_one_as_it_is(factored):
    pc, before, after = factored
    after[8:10] = after[:, 8:10] = 0.0
    nodes, mat, b = np.array([4], dtype=np.int32), matrix(-after), np.ones(len(before))
    assert not _kernels.correct_around(pc.getFactorMatrix().handle, mat.handle, nodes, FIELDS)
    np.testing.assert_allclose(applied(pc, b), np.linalg.solve(before, b), rtol=1e-10)


@pytest.mark.parametrize("nodes", [[NODES], [-1], [3, 3], [5, 4]])
def test_nodes_that_are_none_of_the_factor_are_refused(factored, nodes):
    pc, _, after = factored
    mat = matrix(after)
    with pytest.raises(ValueError, match="nodes must ascend"):
        _kernels.correct_around(pc.getFactorMatrix().handle, mat.handle, np.array(nodes, dtype=np.int32), FIELDS)
