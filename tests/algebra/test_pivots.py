"""Pivots of complete factors show how many eigenvalues are negative: against eigenvalues and determinants."""

import numpy as np
import pytest
from petsc4py import PETSc

from restshape.algebra.factors.pivots import negative_pivots, zero_pivots
from restshape.algebra.linear import LinearSolver
from restshape.algebra.reuse.traits import Traits
from restshape.algebra.stages import Stages
from restshape.calibration import Calibration

SIZE = 40


def grid_matrix(negative, skew, seed):
    """A sparse matrix (SIZE, SIZE) with so many negative eigenvalues, and `skew` times a part that is not symmetric."""
    rng = np.random.default_rng(seed)
    K = 2.2 * np.eye(SIZE) - np.eye(SIZE, k=1) - np.eye(SIZE, k=-1) + 0.3 * (np.eye(SIZE, k=7) + np.eye(SIZE, k=-7))
    values = np.linalg.eigvalsh(K)
    K -= (0.5 * (values[negative - 1] + values[negative]) if negative else values[0] - 0.05) * np.eye(SIZE)
    S = np.diag(rng.standard_normal(SIZE - 1), 1) + np.diag(rng.standard_normal(SIZE - 7), 7)
    return K + skew * (S - S.T)


def solver(symmetric):
    return LinearSolver(
        PETSc.COMM_SELF, "pivots_", "stale", 1e-8, Calibration.load(), Stages(), traits=Traits(symmetric)
    )


def petsc(A):
    rows, columns = np.nonzero(A)
    starts = np.searchsorted(rows, np.arange(len(A) + 1))
    csr = (starts.astype(PETSc.IntType), columns.astype(PETSc.IntType), A[rows, columns])
    mat = PETSc.Mat().createAIJ(A.shape, csr=csr, comm=PETSc.COMM_SELF)
    if np.allclose(A, A.T):
        mat.setOption(PETSc.Mat.Option.SYMMETRIC, True)
    return mat


@pytest.mark.parametrize("negative", [0, 1, 2, 5])
@pytest.mark.parametrize("symmetric", [True, False])
def test_a_symmetric_matrix_has_as_many_negative_pivots_as_eigenvalues(negative, symmetric):
    A = grid_matrix(negative, 0.0, 1)
    assert np.sum(np.linalg.eigvalsh(A) < 0) == negative
    made = solver(symmetric)
    assert made.definite(petsc(A), None) == (negative == 0)
    assert made.kind == ("cholesky" if symmetric else "lu")
    assert made.negative_pivots() == negative


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("negative", [0, 1, 2, 3])
def test_little_that_is_not_symmetric_changes_no_sign(negative, seed):
    A = grid_matrix(negative, 0.005, seed)
    made = solver(False)
    made.definite(petsc(A), None)
    assert made.negative_pivots() == np.sum(np.linalg.eigvals(A).real < 0) == negative


@pytest.mark.parametrize("seed", range(20))
def test_the_sign_of_the_determinant_is_that_of_the_pivots(seed):
    # Where an eigenvalue of a body under a following pressure goes through 0, so does the determinant.
    A = grid_matrix(seed % 4, 0.5, seed)
    made = solver(False)
    made.definite(petsc(A), None)
    assert (-1.0) ** made.negative_pivots() == np.linalg.slogdet(A)[0]


@pytest.mark.parametrize("seed", range(5))
def test_a_matrix_whose_symmetric_part_is_definite_has_positive_pivots(seed):
    # x^T A x > 0 holds for all of its leading blocks, in any order of the unknowns.
    assert solver(False).definite(petsc(grid_matrix(0, 3.0, seed)), None)


def test_a_factor_without_pivots_is_not_asked():
    options = PETSc.Options("pivots_")
    options.setValue("pc_factor_mat_solver_type", "mumps")
    try:
        made = solver(False)
        assert made.definite(petsc(grid_matrix(2, 0.1, 0)), None)
        assert made.negative_pivots() == 0
    finally:
        options.delValue("pc_factor_mat_solver_type")


@pytest.mark.parametrize("library", ["cholmod", "mumps"])
def test_factors_of_other_libraries_show_no_pivots_and_solve(library):
    """They have no inertia to ask for, or none without options of theirs."""
    mat = PETSc.Mat().createAIJ((2, 2), csr=([0, 1, 2], [0, 1], [2.0, 3.0]), comm=PETSc.COMM_SELF)
    mat.setOption(PETSc.Mat.Option.SPD, True)
    pc = PETSc.PC().create(PETSc.COMM_SELF)
    pc.setType("cholesky")
    pc.setFactorSolverType(library)
    pc.setOperators(mat)
    pc.setUp()
    assert negative_pivots(pc.getFactorMatrix(), "cholesky") == zero_pivots(pc.getFactorMatrix(), "cholesky") == 0
