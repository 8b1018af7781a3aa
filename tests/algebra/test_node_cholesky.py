"""The complete factor in blocks of a node against dense linear algebra."""

import os
from pathlib import Path

import numpy as np
import pytest
from petsc4py import PETSc
from scipy.sparse import coo_matrix, diags, kron
from scipy.spatial import Delaunay

from restshape import _kernels
from restshape.algebra.preconditioner import order_factor, set_preconditioner, substitute_by_panels

N = 40


def matrix(seed: int, share: float, size: int) -> np.ndarray:
    """A symmetric positive definite matrix (size N, size N) of a random graph of nodes."""
    random = np.random.default_rng(seed)
    joined = np.triu(random.uniform(size=(N, N)) < share, 1)
    dense = np.kron(joined, np.ones((size, size))) * random.normal(size=(size * N, size * N))
    dense = dense + dense.T
    own = random.normal(size=(N, size, size))
    for k in range(N):
        rows = slice(size * k, size * (k + 1))
        dense[rows, rows] = own[k] @ own[k].T
    return dense + np.diag(1.0 + abs(dense).sum(axis=1))


def petsc(dense: np.ndarray, size: int) -> PETSc.Mat:
    """The matrix with whole blocks in its pattern."""
    nodes = abs(dense).reshape(N, size, N, size).sum(axis=(1, 3)) > 0.0
    rows, columns = np.nonzero(np.kron(nodes, np.ones((size, size))))
    starts = np.searchsorted(rows, np.arange(size * N + 1)).astype(PETSc.IntType)
    csr = starts, columns.astype(PETSc.IntType), dense[rows, columns]
    return PETSc.Mat().createAIJ(dense.shape, csr=csr, comm=PETSc.COMM_SELF)


@pytest.fixture
def ksp():
    solver = PETSc.KSP().create(PETSc.COMM_SELF)
    solver.setType("preonly")
    set_preconditioner(solver, "cholesky", 0)
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


@pytest.mark.parametrize("size", [1, 2, 3])
def test_solves_as_dense_algebra_does(ksp, size):
    dense = matrix(0, 0.1, size)
    assert error(ksp, dense, petsc(dense, size)) < 1e-12
    assert ksp.getPC().getFactorMatrix().getType() == "node_blocks"


@pytest.mark.parametrize("size", [1, 2, 3])
def test_follows_values_and_patterns(ksp, size):
    dense = matrix(1, 0.1, size)
    mat = petsc(dense, size)
    assert error(ksp, dense, mat) < 1e-12
    # Other values on the same pattern, then another pattern.
    mat.scale(2.0)
    mat.shift(3.0)
    changed = 2.0 * dense + 3.0 * np.eye(len(dense))
    assert error(ksp, changed, mat) < 1e-12
    other = matrix(2, 0.2, size)
    assert error(ksp, other, petsc(other, size)) < 1e-12


def factored(mat: PETSc.Mat) -> PETSc.PC:
    pc = PETSc.PC().create(PETSc.COMM_SELF)
    pc.setType("cholesky")
    order_factor(pc)
    pc.setOperators(mat)
    pc.setUp()
    return pc


@pytest.mark.parametrize("size", [1, 2, 3])
@pytest.mark.parametrize("share", [0.1, 0.5, 0.9])
def test_inertia_is_that_of_the_eigenvalues(size, share):
    dense = matrix(4, 0.1, size)
    values = np.linalg.eigvalsh(dense)
    shift = np.quantile(values, share) + 1e-6 * values[0]
    dense = dense - shift * np.eye(len(dense))
    below = int(np.count_nonzero(np.linalg.eigvalsh(dense) < 0.0))
    assert factored(petsc(dense, size)).getFactorMatrix().getInertia() == (below, 0, size * N - below)


@pytest.mark.parametrize("size", [2, 3])
@pytest.mark.parametrize("grade", [1e4, 1e8, 1e12])
def test_inertia_of_blocks_with_one_soft_direction(size, grade):
    """Each node by itself: eigenvalues 1, one soft and one stiff, of both signs."""
    random = np.random.default_rng(7)
    dense, below = np.zeros((size * N, size * N)), 0
    for k in range(N):
        turned, _ = np.linalg.qr(random.normal(size=(size, size)))
        values = np.array([1.0, grade, grade])[:size] * random.choice([-1.0, 1.0], size=size)
        rows = slice(size * k, size * (k + 1))
        dense[rows, rows] = turned @ np.diag(values) @ turned.T
        below += int((values < 0.0).sum())
    assert factored(petsc(dense, size)).getFactorMatrix().getInertia() == (below, 0, size * N - below)


def test_a_rank_without_rows_has_a_factor():
    mat = PETSc.Mat().createAIJ((0, 0), csr=([0], [], []), comm=PETSc.COMM_SELF)
    assert factored(mat).getFactorMatrix().getInertia() == (0, 0, 0)


@pytest.mark.parametrize("size", [1, 2, 3])
def test_a_singular_matrix_is_reported(ksp, size):
    """A chain's Laplacian in whole numbers, whose rows sum to 0: rigid motions have no stiffness."""
    ends = np.eye(N)[[0, -1]]
    dense = np.kron(np.diag(2.0 - ends.sum(axis=0)) - np.eye(N, k=1) - np.eye(N, k=-1), np.eye(size))
    mat = petsc(dense, size)
    assert factored(mat).getFactorMatrix().getInertia()[1] > 0
    ksp.setOperators(mat)
    right, way = mat.createVecs()
    right.set(1.0)
    ksp.solve(right, way)
    assert ksp.getConvergedReason() == PETSc.KSP.ConvergedReason.DIVERGED_PCSETUP_FAILED


def test_rows_without_whole_nodes_are_taken_by_single_numbers(ksp):
    dense = matrix(6, 0.1, 2)
    dense[0, 2:4] = dense[2:4, 0] = 0.0
    rows, columns = np.nonzero(dense)
    starts = np.searchsorted(rows, np.arange(2 * N + 1)).astype(PETSc.IntType)
    csr = starts, columns.astype(PETSc.IntType), dense[rows, columns]
    mat = PETSc.Mat().createAIJ(dense.shape, csr=csr, comm=PETSc.COMM_SELF)
    assert error(ksp, dense, mat) < 1e-12


def test_fill_is_that_of_blocks(ksp):
    """A chain of nodes fills nothing: its blocks and diagonal are all that is stored."""
    size = 2
    dense = np.kron(np.diag(np.full(N, 4.0)) - np.eye(N, k=1) - np.eye(N, k=-1), np.eye(size) + 0.1)
    error(ksp, dense, petsc(dense, size))
    assert ksp.getPC().getFactorMatrix().getInfo()["nz_used"] == pytest.approx((2 * N - 1) * size**2, abs=N)


@pytest.mark.parametrize("size", [2, 3])
def test_pivots_that_want_exchanges_of_rows(ksp, size):
    # Blocks with nothing on their diagonals have inverses all the same.
    dense = np.kron(np.eye(N), np.ones((size, size)) - np.eye(size))
    assert error(ksp, dense, petsc(dense, size)) < 1e-14


def sheet(places: np.ndarray) -> PETSc.Mat:
    """A matrix of nodes at places (n, 2), three unknowns each, of which those within two sides of a mesh are joined."""
    sides = Delaunay(places).simplices[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    once = coo_matrix((np.ones(len(sides)), sides.T), (len(places),) * 2).tocsr()
    joined = ((once + once.T) @ (once + once.T)).sign()
    blocks = kron(
        diags(joined.sum(axis=1).A1 + 0.01) - joined, np.array([[2.0, 0.3, 0], [0.3, 1.0, 0.1], [0, 0.1, 1.5]])
    )
    found = blocks.tobsr((3, 3)).tocsr()
    csr = found.indptr.astype(PETSc.IntType), found.indices.astype(PETSc.IntType), found.data
    return PETSc.Mat().createAIJ(found.shape, csr=csr, comm=PETSc.COMM_SELF)


@pytest.mark.skipif("libcholmod" not in Path("/proc/self/maps").read_text(), reason="PETSc came without SuiteSparse")
def test_a_large_pattern_that_is_factored_again_and_again_gets_a_sparser_factor(ksp):
    mat = sheet(np.random.default_rng(2).uniform(size=(4200, 2)))
    right, way = mat.createVecs()
    right.setArray(np.random.default_rng(3).normal(size=right.getSize()))
    sizes, left = [], []
    for _ in range(4):
        mat.scale(1.5)
        ksp.setOperators(mat)
        ksp.solve(right, way)
        factor = ksp.getPC().getFactorMatrix()
        sizes.append(factor.getInfo()["nz_used"])
        left.append((mat * way - right).norm() / right.norm())
        # Panels of the order before are of no use to this one.
        substitute_by_panels(ksp, single=False)
        ksp.solve(right, way)
        assert _kernels.panel_value_bytes(factor.handle) == 8
        left.append((mat * way - right).norm() / right.norm())
    assert max(left) < 1e-11
    assert sizes[0] == sizes[1] and sizes[2] == sizes[3] < 0.97 * sizes[0]


@pytest.mark.skipif("libcholmod" not in Path("/proc/self/maps").read_text(), reason="PETSc came without SuiteSparse")
def test_a_very_large_pattern_is_dissected_at_once_and_its_factor_substituted_in_place(ksp):
    mat = sheet(np.random.default_rng(2).uniform(size=(25_000, 2)))
    right, way = mat.createVecs()
    right.setArray(np.random.default_rng(3).normal(size=right.getSize()))
    sizes, left = [], []
    for _ in range(3):
        ksp.setOperators(mat)
        mat.scale(1.5)
        ksp.solve(right, way)
        factor = ksp.getPC().getFactorMatrix()
        sizes.append(factor.getInfo()["nz_used"])
        left.append((mat * way - right).norm() / right.norm())
    # As many numbers as are not copied into panels.
    assert sizes[0] == sizes[1] == sizes[2] > 1 << 24
    assert max(left) < 1e-11
    substitute_by_panels(ksp, single=False)
    assert not _kernels.panel_value_bytes(factor.handle)
    # In single precision they are copied still, and substitutions go by them.
    substitute_by_panels(ksp, single=True)
    ksp.solve(right, way)
    assert _kernels.panel_value_bytes(factor.handle) == 4
    assert 1e-9 < (mat * way - right).norm() / right.norm() < 1e-3


@pytest.mark.skipif(not _kernels.give_back_memory(), reason="the system's library keeps what is freed")
def test_no_workspace_of_a_large_factor_stays():
    """It would be 16 numbers an unknown, 12 MB here, beside 40 MB of the factor, its pattern and order."""

    def resident() -> int:
        _kernels.give_back_memory()
        return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")

    side = 300
    chain = diags([-1.0, 2.0, -1.0], [-1, 0, 1], (side, side))
    whole = (kron(diags([1.0], [0], (side, side)), chain) + kron(chain, diags([1.0], [0], (side, side)))).tocsr()
    mat = PETSc.Mat().createAIJ(whole.shape, csr=(whole.indptr, whole.indices, whole.data), comm=PETSc.COMM_SELF)
    pc = PETSc.PC().create(PETSc.COMM_SELF)
    pc.setType("cholesky")
    order_factor(pc)
    pc.setOperators(mat)
    before = resident()
    pc.setUp()
    known = pc.getFactorMatrix().getInfo()["memory"]
    assert resident() - before - known < 0.8 * 16 * 8 * side**2
    pc.destroy()
    mat.destroy()
