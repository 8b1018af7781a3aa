"""The block factor as PETSc's preconditioner, against factors of dense matrices, and CG's answers."""

import numpy as np
import pytest
from petsc4py import PETSc

from restshape import _kernels as k

CHAIN = 12


class Sample:
    """A positive definite matrix of 3 by 3 blocks on a graph of nodes, in PETSc's format."""

    def __init__(self, cells: list[tuple[int, ...]], nodes: int, weight: float, seed: int = 0) -> None:
        rng = np.random.default_rng(seed)
        self.dense = np.zeros((3 * nodes, 3 * nodes))
        present = np.eye(nodes, dtype=bool)
        for cell in map(np.array, cells):
            B = rng.uniform(-1, 1, (3, 3 * len(cell)))
            rows = (3 * cell[:, None] + np.arange(3)).ravel()
            self.dense[np.ix_(rows, rows)] += B.T @ B
            present[np.ix_(cell, cell)] = True
        self.dense += weight * np.eye(3 * nodes)
        i, j = np.nonzero(np.kron(present, np.ones((3, 3), dtype=bool)))
        row = np.searchsorted(i, np.arange(3 * nodes + 1)).astype(np.int32)
        self.mat = PETSc.Mat().createAIJ(self.dense.shape, csr=(row, j.astype(np.int32), self.dense[i, j]))
        self.b = rng.uniform(-1, 1, 3 * nodes)

    def preconditioner(self, shift: float) -> PETSc.PC:
        pc = PETSc.PC().create(PETSc.COMM_SELF)
        pc.setOperators(self.mat)
        k.set_block_factor(pc.handle, shift)
        pc.setUp()
        return pc


def applied(pc: PETSc.PC, size: int) -> np.ndarray:
    """The preconditioner as a dense matrix."""
    result, out = np.empty((size, size)), PETSc.Vec().createSeq(size)
    for column in range(size):
        pc.apply(PETSc.Vec().createWithArray(np.eye(size)[column].copy()), out)
        result[:, column] = out.getArray()
    return result


def chain() -> Sample:
    return Sample([(i, i + 1) for i in range(CHAIN - 1)], CHAIN, 0.5)


def grid(weight: float, seed: int = 0) -> Sample:
    """A grid of 6 by 6 nodes, two triangles in each square."""
    corners = [6 * i + j for i in range(5) for j in range(5)]
    cells = [(a, a + b, a + 7) for a in corners for b in (1, 6)]
    return Sample(cells, 36, weight, seed)


def test_without_fill_to_leave_out_it_is_the_inverse():
    sample = chain()
    inverse = np.linalg.inv(sample.dense)
    np.testing.assert_allclose(applied(sample.preconditioner(0.0), 3 * CHAIN), inverse, atol=1e-5 * inverse.max())


def test_shift_is_of_the_diagonal():
    sample = chain()
    inverse = np.linalg.inv(sample.dense + 0.3 * np.diag(np.diag(sample.dense)))
    np.testing.assert_allclose(applied(sample.preconditioner(0.3), 3 * CHAIN), inverse, atol=1e-5 * inverse.max())


def test_its_inverse_has_the_entries_of_the_matrix():
    """What defines an incomplete factor: the product agrees with the matrix wherever the matrix has entries."""
    sample = grid(2.0)
    pc = sample.preconditioner(0.0)
    assert k.block_factor_kept_pivots(pc.handle) == 0
    product = np.linalg.inv(applied(pc, len(sample.dense)))
    entries = np.kron(np.abs(sample.dense).reshape(36, 3, 36, 3).max(axis=(1, 3)) > 0, np.ones((3, 3))) > 0
    np.testing.assert_allclose(product[entries], sample.dense[entries], atol=1e-4)
    assert np.abs(product - sample.dense)[~entries].max() > 1e-3


@pytest.mark.parametrize("weight", [1e-2, 1e-6])
def test_it_is_positive_definite_where_updates_are_not(weight):
    kept = 0
    for seed in range(10):
        pc = grid(weight, seed).preconditioner(0.0)
        kept += k.block_factor_kept_pivots(pc.handle)
        inverse = applied(pc, 108)
        np.testing.assert_allclose(inverse, inverse.T, atol=1e-4 * np.abs(inverse).max())
        assert np.linalg.eigvalsh((inverse + inverse.T) / 2)[0] > 0
    assert kept > 0


def test_conjugate_gradients_find_the_answer_and_new_values():
    sample = grid(0.1)
    ksp = PETSc.KSP().create(PETSc.COMM_SELF)
    ksp.setType("cg")
    ksp.setTolerances(rtol=1e-8)
    k.set_block_factor(ksp.getPC().handle, 0.01)
    x = PETSc.Vec().createSeq(len(sample.b))
    for factor in (1.0, 2.0):
        sample.mat.scale(factor)
        ksp.setOperators(sample.mat)
        ksp.solve(PETSc.Vec().createWithArray(sample.b.copy()), x)
        sample.dense *= factor
        np.testing.assert_allclose(x.getArray(), np.linalg.solve(sample.dense, sample.b), rtol=1e-5, atol=1e-6)
    # Of the new values: the factor of the old ones would need as many iterations, but gives half of the new inverse.
    scaled = applied(ksp.getPC(), len(sample.b))
    ksp.getPC().setReusePreconditioner(True)
    sample.mat.scale(4.0)
    ksp.setOperators(sample.mat)
    ksp.setUp()
    np.testing.assert_array_equal(applied(ksp.getPC(), len(sample.b)), scaled)


def test_other_matrices_are_refused():
    mat = PETSc.Mat().createAIJ((4, 4), csr=(np.arange(5, dtype=np.int32), np.arange(4, dtype=np.int32), np.ones(4)))
    pc = PETSc.PC().create(PETSc.COMM_SELF)
    pc.setOperators(mat)
    k.set_block_factor(pc.handle)
    with pytest.raises(PETSc.Error):
        pc.setUp()
