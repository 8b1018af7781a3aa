"""The complete factor in blocks of three against dense linear algebra."""

import numpy as np
import pytest
from petsc4py import PETSc

from restshape.algebra.block_cholesky import BLOCK, BlockCholesky

N = 40


def matrix(seed: int, share: float) -> np.ndarray:
    """A symmetric positive definite matrix (3 N, 3 N) of a random graph of nodes."""
    random = np.random.default_rng(seed)
    joined = np.triu(random.uniform(size=(N, N)) < share, 1)
    dense = np.kron(joined, np.ones((BLOCK, BLOCK))) * random.normal(size=(BLOCK * N, BLOCK * N))
    dense = dense + dense.T
    own = random.normal(size=(N, BLOCK, BLOCK))
    for k in range(N):
        rows = slice(BLOCK * k, BLOCK * (k + 1))
        dense[rows, rows] = own[k] @ own[k].T
    return dense + np.diag(1.0 + abs(dense).sum(axis=1))


def petsc(dense: np.ndarray) -> PETSc.Mat:
    """The matrix with whole blocks in its pattern."""
    nodes = abs(dense).reshape(N, BLOCK, N, BLOCK).sum(axis=(1, 3)) > 0.0
    rows, columns = np.nonzero(np.kron(nodes, np.ones((BLOCK, BLOCK))))
    starts = np.searchsorted(rows, np.arange(BLOCK * N + 1)).astype(np.int32)
    csr = starts, columns.astype(np.int32), dense[rows, columns]
    return PETSc.Mat().createAIJ(dense.shape, csr=csr, comm=PETSc.COMM_SELF)


@pytest.fixture
def ksp():
    solver = PETSc.KSP().create(PETSc.COMM_SELF)
    solver.setType("preonly")
    BlockCholesky(solver.getPC())
    yield solver
    solver.destroy()


def error(ksp: PETSc.KSP, dense: np.ndarray, mat: PETSc.Mat) -> float:
    """How far a solution is from that of dense linear algebra, relative."""
    ksp.setOperators(mat)
    right, way = mat.createVecs()
    right.setArray(np.random.default_rng(9).normal(size=len(dense)))
    ksp.solve(right, way)
    exact = np.linalg.solve(dense, right.getArray())
    return float(np.linalg.norm(way.getArray() - exact) / np.linalg.norm(exact))


def test_solves_as_dense_algebra_does(ksp):
    dense = matrix(0, 0.1)
    assert error(ksp, dense, petsc(dense)) < 1e-12


def test_follows_values_and_patterns(ksp):
    dense = matrix(1, 0.1)
    mat = petsc(dense)
    assert error(ksp, dense, mat) < 1e-12
    # Other values on the same pattern, then another pattern.
    mat.scale(2.0)
    mat.shift(3.0)
    changed = 2.0 * dense + 3.0 * np.eye(len(dense))
    assert error(ksp, changed, mat) < 1e-12
    other = matrix(2, 0.2)
    assert error(ksp, other, petsc(other)) < 1e-12
