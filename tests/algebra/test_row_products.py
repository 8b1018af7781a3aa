"""Products of rows with rows and with matrices, beside numpy's and PETSc's."""

import numpy as np
import pytest
import scipy.sparse as sp
from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.row_products import add_combined, combined, row_products


@pytest.mark.parametrize("n", [1, 7, 8, 513, 1300])
@pytest.mark.parametrize(("k", "m"), [(1, 1), (3, 5), (4, 8), (9, 17)])
def test_products_and_sums_of_rows_are_those_of_numpy(k, m, n):
    rng = np.random.default_rng(n)
    a, b, weights = rng.normal(size=(k, n)), rng.normal(size=(m, n)), rng.normal(size=(m, k))
    np.testing.assert_allclose(row_products(a, b), a @ b.T, atol=1e-13 * n)
    np.testing.assert_allclose(combined(weights, a), weights @ a, atol=1e-13 * n)
    sums = b.copy()
    add_combined(weights, a, sums)
    np.testing.assert_allclose(sums, b + weights @ a, atol=1e-13 * n)


def test_of_no_rows_there_is_nothing():
    rows = np.ones((2, 9))
    assert row_products(rows, rows[:0]).shape == (2, 0)
    np.testing.assert_array_equal(combined(np.empty((2, 0)), rows[:0]), np.zeros((2, 9)))


def test_what_does_not_fit_is_refused():
    rows, out = np.ones((2, 9)), np.empty((2, 3))
    with pytest.raises(ValueError, match="out"):
        _kernels.row_products(rows, rows, out)
    with pytest.raises(ValueError, match="weights"):
        combined(np.ones((2, 3)), rows)
    with pytest.raises(ValueError, match="must not be rows"):
        _kernels.combine_rows(np.ones((2, 2)), rows, rows, False)


def petsc(found):
    return PETSc.Mat().createAIJ(found.shape, csr=(found.indptr, found.indices, found.data), comm=PETSc.COMM_SELF)


@pytest.mark.parametrize("count", [1, 5, 8, 11])
@pytest.mark.parametrize("fields", [1, 2, 3])
def test_products_of_a_matrix_are_those_of_scipy(fields, count):
    """With three unknowns a node its rows are alike; a row more than whole nodes, and one that is empty, are not."""
    rng = np.random.default_rng(fields)
    nodes = sp.random(20, 20, 0.2, random_state=1) + sp.eye(20)
    one = sp.block_diag([sp.kron(nodes, rng.normal(size=(fields, fields))), sp.csr_matrix((1, 1)), [[3.0]]]).tocsr()
    one.sort_indices()
    rows = rng.normal(size=(count, one.shape[0]))
    out = np.full_like(rows, np.nan)
    assert _kernels.matrix_products(petsc(one).handle, rows, out)
    np.testing.assert_allclose(out, (one @ rows.T).T, atol=1e-12)


def test_of_other_matrices_nothing_is_written():
    dense = PETSc.Mat().createDense((3, 3), array=np.eye(3), comm=PETSc.COMM_SELF)
    out = np.full((2, 3), 7.0)
    assert not _kernels.matrix_products(dense.handle, np.ones((2, 3)), out)
    assert (out == 7.0).all()
