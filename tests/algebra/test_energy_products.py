"""Scalar products in the energy of a sparse matrix, and guesses that are moved by them, beside numpy's."""

import numpy as np
import pytest
from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.projection import Projection


def spring_chain(n):
    """A chain of springs between walls, dense and as PETSc's."""
    dense = 2.5 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
    mat = PETSc.Mat().createAIJ((n, n), nnz=3, comm=PETSc.COMM_SELF)
    for i in range(n):
        for j in range(max(0, i - 1), min(n, i + 2)):
            mat.setValue(i, j, dense[i, j])
    mat.assemble()
    return dense, mat


@pytest.mark.parametrize("count", [1, 5, 7])
def test_products(count):
    rng, (dense, mat) = np.random.default_rng(count), spring_chain(40)
    x, b, steps = rng.normal(size=40), rng.normal(size=40), rng.normal(size=(count, 40))
    gram, right = np.empty((count, count)), np.empty(count)
    assert _kernels.energy_products(mat.handle, x, b, steps, gram, right)
    np.testing.assert_allclose(gram, steps @ dense @ steps.T, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(right, steps @ (b - dense @ x), rtol=1e-12, atol=1e-12)


def test_what_does_not_fit_is_left_or_refused():
    _, mat = spring_chain(10)
    x, gram = np.zeros(10), np.empty((8, 8))
    assert not _kernels.energy_products(mat.handle, x, x, np.zeros((8, 10)), gram, np.empty(8))
    with pytest.raises(ValueError, match=r"steps \(m, n\)"):
        _kernels.energy_products(mat.handle, x, x, np.zeros((2, 9)), np.empty((2, 2)), np.empty(2))
    dense = PETSc.Mat().createDense((10, 10), comm=PETSc.COMM_SELF)
    dense.setUp()
    dense.assemble()
    assert not _kernels.energy_products(dense.handle, x, x, np.zeros((2, 10)), np.empty((2, 2)), np.empty(2))


@pytest.mark.parametrize("directions", [2, 9])
def test_a_guess_is_moved_to_the_nearest_point_along_the_increments(directions):
    """In energy: what is left of its error is orthogonal to them, by the kernel and by PETSc's products."""
    rng, (dense, mat) = np.random.default_rng(3), spring_chain(30)
    b, x = mat.createVecs()
    projection = Projection(PETSc.COMM_SELF, directions)
    solutions = rng.normal(size=(directions + 1, 30))
    for solution in solutions:
        x.getArray()[:] = solution
        x.stateIncrease()
        projection.keep(x)
    b.getArray()[:] = right = rng.normal(size=30)
    b.stateIncrease()
    projection(mat, b, x)
    left = np.diff(solutions, axis=0) @ (right - dense @ x.getArray())
    assert np.abs(left).max() < 1e-8 * np.abs(right).max()
