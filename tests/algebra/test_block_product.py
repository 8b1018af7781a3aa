"""Products of matrices in blocks of a node beside dense ones."""

import numpy as np
import pytest
from petsc4py import PETSc

from restshape import _kernels


def in_blocks(size: int, nodes: int) -> tuple[PETSc.Mat, np.ndarray]:
    """A matrix in blocks, of which the first row is empty and the last one full, and its dense copy."""
    rng = np.random.default_rng(size)
    rows = [np.sort(rng.choice(nodes, 3, replace=False)) for _ in range(nodes)]
    rows[0], rows[-1] = np.empty(0, dtype=int), np.arange(nodes)
    start = np.cumsum([0, *map(len, rows)]).astype(np.int32)
    column = np.concatenate(rows).astype(np.int32)
    value = rng.standard_normal((len(column), size, size))
    mat = PETSc.Mat().createBAIJ(size * nodes, size, csr=(start, column, value.ravel()), comm=PETSc.COMM_SELF)
    return mat, mat.convert("dense", out=PETSc.Mat()).getDenseArray().copy()


@pytest.mark.parametrize("size", [2, 3, 4])
def test_product_is_that_of_the_dense_matrix(size: int) -> None:
    mat, dense = in_blocks(size, 20)
    x, y = mat.createVecs()
    x[:] = np.random.default_rng(0).standard_normal(x.getSize())
    _kernels.multiply_in_registers(mat.handle)
    before = mat.stateGet()
    mat.mult(x, y)
    np.testing.assert_allclose(y.getArray(), dense @ x.getArray(), atol=1e-14)
    assert mat.stateGet() == before, "a preconditioner would be made again"


def test_nothing_beyond_the_vector_is_written() -> None:
    mat, _ = in_blocks(3, 5)
    _kernels.multiply_in_registers(mat.handle)
    memory = np.full(18, 7.0)
    y = PETSc.Vec().createWithArray(memory[:15], comm=PETSc.COMM_SELF)
    mat.mult(mat.createVecRight(), y)
    assert (memory[:15] == 0.0).all() and (memory[15:] == 7.0).all()


def test_other_types_keep_their_own() -> None:
    mat = PETSc.Mat().createAIJ(6, bsize=3, nnz=1, comm=PETSc.COMM_SELF)
    mat.setDiagonal(mat.createVecLeft())
    _kernels.multiply_in_registers(mat.handle)
    x, y = mat.createVecs()
    mat.mult(x, y)
    assert y.norm() == 0.0
