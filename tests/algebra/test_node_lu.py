"""LU factors in blocks of a node beside dense solves, and what they say where there is none."""

import numpy as np
import pytest
from petsc4py import PETSc

from restshape import _kernels

TYPES = (_kernels.node_lu, _kernels.node_lu_single)


def grid(side: int, size: int, seed: int = 0) -> tuple[np.ndarray, PETSc.Mat]:
    """A matrix (n, n) on a square grid of nodes with diagonals in one direction, not symmetric, dense and in blocks."""
    rng, nodes = np.random.default_rng(seed), side * side
    i, j = (index.ravel() for index in np.meshgrid(range(side), range(side), indexing="ij"))
    near = (np.abs(i - i[:, None]) <= 1) & (np.abs(j - j[:, None]) <= 1) & (i + j != i[:, None] + j[:, None] + 2)
    near = near & near.T
    blocks = rng.uniform(-1, 1, (nodes, nodes, size, size)) * near[..., None, None]
    blocks[range(nodes), range(nodes)] += 9.0 * np.eye(size)
    start = np.concatenate([[0], np.cumsum(near.sum(1))]).astype(PETSc.IntType)
    columns, values = np.nonzero(near)[1].astype(PETSc.IntType), blocks[near]
    n = nodes * size
    mat = PETSc.Mat().createBAIJ(n, size, csr=(start, columns, values.ravel()), comm=PETSc.COMM_SELF)
    full = mat.convert("dense", out=PETSc.Mat()).getDenseArray().copy()
    return full, mat


def factor(mat: PETSc.Mat, kind: str) -> PETSc.PC:
    _kernels.register_node_lu()
    pc = PETSc.PC().create(PETSc.COMM_SELF)
    pc.setType("lu")
    pc.setFactorSolverType(kind)
    pc.setOperators(mat)
    pc.setUp()
    return pc


def solution(pc: PETSc.PC, b: np.ndarray) -> np.ndarray:
    right, x = (PETSc.Vec().createWithArray(values.copy(), comm=PETSc.COMM_SELF) for values in (b, 0.0 * b))
    pc.apply(right, x)
    return x.getArray().copy()


@pytest.mark.parametrize("size", [3, 4])
@pytest.mark.parametrize("kind", TYPES)
@pytest.mark.parametrize("side", [1, 2, 9])
def test_it_solves_as_a_dense_one_does_with_new_values_too(side, kind, size):
    full, mat = grid(side, size)
    pc, b = factor(mat, kind), np.arange(len(full)) % 5 - 2.0
    error = 1e-12 if kind == _kernels.node_lu else 1e-5
    np.testing.assert_allclose(solution(pc, b), np.linalg.solve(full, b), atol=error)
    other, values = grid(side, size, 1)
    values.copy(mat)
    pc.setUp()
    np.testing.assert_allclose(solution(pc, b), np.linalg.solve(other, b), atol=error)


def test_its_nonzeros_are_those_of_petscs_own():
    _, mat = grid(9, 3)
    own = PETSc.PC().create(PETSc.COMM_SELF)
    own.setType("lu")
    own.setFactorOrdering("amd")
    own.setOperators(mat)
    own.setUp()
    counted = [one.getFactorMatrix().getInfo()["nz_used"] for one in (own, factor(mat, _kernels.node_lu))]
    assert counted[0] == counted[1] > mat.getInfo()["nz_used"]


@pytest.mark.parametrize("kind", TYPES)
def test_a_block_without_an_inverse_is_a_zero_pivot(kind):
    _, mat = grid(1, 3)
    mat.zeroEntries()
    mat.assemble()
    assert _kernels.ended_at_zero(factor(mat, kind).getFactorMatrix().handle)
