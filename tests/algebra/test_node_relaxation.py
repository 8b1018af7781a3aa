"""Conjugate gradients with over-relaxation in blocks against the same method in dense linear algebra."""

import numpy as np
import pytest
from petsc4py import PETSc

from restshape import _kernels

N, OMEGA = 40, 1.2


def matrix(seed: int) -> np.ndarray:
    """A symmetric positive definite matrix (3 N, 3 N) of a random graph of nodes, of numbers of single precision."""
    random = np.random.default_rng(seed)
    joined = np.triu(random.uniform(size=(N, N)) < 0.15, 1)
    dense = np.kron(joined, np.ones((3, 3))) * random.normal(size=(3 * N, 3 * N))
    dense += dense.T
    own = random.normal(size=(N, 3, 3))
    for k in range(N):
        rows = slice(3 * k, 3 * k + 3)
        dense[rows, rows] = 3.0 * own[k] @ own[k].T
    return (dense + np.diag(0.7 * abs(dense).sum(axis=1))).astype(np.float32).astype(float)


def petsc(dense: np.ndarray) -> PETSc.Mat:
    """The matrix in blocks of nodes."""
    mat = PETSc.Mat().createBAIJ(dense.shape, bsize=3, nnz=N, comm=PETSc.COMM_SELF)
    for i, j in zip(*np.nonzero(abs(dense).reshape(N, 3, N, 3).sum(axis=(1, 3)))):
        mat.setValuesBlocked([i], [j], dense[3 * i : 3 * i + 3, 3 * j : 3 * j + 3])
    mat.assemble()
    return mat


@pytest.fixture
def ksp():
    _kernels.register_node_relaxation()
    solver = PETSc.KSP().create(PETSc.COMM_SELF)
    solver.setType(_kernels.node_ssor)
    solver.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
    solver.getPC().setType("none")
    yield solver
    solver.destroy()


def reference(dense: np.ndarray, b: np.ndarray, x: np.ndarray, steps: int) -> np.ndarray:
    """Iterate of conjugate gradients, preconditioned by the product of both halves with the relaxed diagonal."""
    own = np.kron(np.eye(N), np.ones((3, 3))) * dense / OMEGA
    block = np.arange(3 * N) // 3
    lower = np.where(block[:, None] > block, dense, 0.0) + own
    preconditioner = lower @ np.linalg.inv(own) @ lower.T
    r = b - dense @ x
    z = np.linalg.solve(preconditioner, r)
    p, rho = z, r @ z
    for _ in range(steps):
        q = dense @ p
        x = x + rho / (p @ q) * p
        r = r - rho / (p @ q) * q
        z = np.linalg.solve(preconditioner, r)
        p, rho = z + r @ z / rho * p, r @ z
    return x


@pytest.mark.parametrize("guessed", [False, True])
@pytest.mark.parametrize("steps", [1, 2, 7])
def test_iterates_are_those_of_the_method(ksp, steps, guessed):
    dense, random = matrix(0), np.random.default_rng(1)
    mat = petsc(dense)
    right, way = mat.createVecs()
    b, x = random.normal(size=(2, 3 * N))
    right.setArray(b)
    way.setArray(x)
    ksp.setInitialGuessNonzero(guessed)
    ksp.setTolerances(rtol=1e-30, max_it=steps)
    ksp.setOperators(mat)
    norms = []
    ksp.setMonitor(lambda ksp, it, norm: norms.append(norm))
    ksp.solve(right, way)
    expected = reference(dense, b, x if guessed else 0.0 * x, steps)
    np.testing.assert_allclose(way.getArray(), expected, atol=1e-12 * abs(expected).max())
    assert ksp.getIterationNumber() == steps and len(norms) == steps + 1
    assert norms[-1] == pytest.approx(np.linalg.norm(b - dense @ expected), rel=1e-9)


def test_it_takes_in_new_values_and_ends_at_its_tolerance(ksp):
    mat, b = petsc(matrix(0)), np.random.default_rng(2).normal(size=3 * N)
    right, way = mat.createVecs()
    right.setArray(b)
    ksp.setTolerances(rtol=1e-8)
    for scale in (1.0, 7.0):
        mat.scale(scale)
        ksp.setOperators(mat)
        ksp.solve(right, way)
        residual = b - scale * matrix(0) @ way.getArray()
        assert np.linalg.norm(residual) <= 1e-8 * np.linalg.norm(b) * (1 + 1e-6)


@pytest.mark.parametrize("spoiled", ["a node's own block", "the whole"])
def test_what_is_not_definite_has_no_solution(ksp, spoiled):
    dense = matrix(0)
    if spoiled == "the whole":
        # Each block is positive definite, and the constant vector is not.
        dense = np.kron(np.eye(N) - 2.0 / N, np.eye(3)) + 2.0 / N * np.eye(3 * N)
    else:
        dense[3:6, 3:6] *= -1.0
    mat = petsc(dense)
    right, way = mat.createVecs()
    right.set(1.0)
    ksp.setOperators(mat)
    ksp.solve(right, way)
    reasons = PETSc.KSP.ConvergedReason
    assert ksp.getConvergedReason() in (reasons.DIVERGED_INDEFINITE_MAT, reasons.DIVERGED_INDEFINITE_PC)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-6, 1e-10])
@pytest.mark.parametrize("held", [1.0, 1e-4])
def test_residuals_are_those_of_the_matrix_itself(ksp, held, tolerance):
    """Of a sheet that hardly anything holds, whose rows cancel: rounded to single precision they are another matrix."""
    dense = matrix(2) * np.pi
    springs = np.where(np.eye(3 * N, dtype=bool), 0.0, -abs(dense))
    dense = springs - np.diag(springs.sum(axis=1)) + held * np.eye(3 * N)
    mat = petsc(dense)
    right, way = mat.createVecs()
    b = np.random.default_rng(3).normal(size=3 * N)
    right.setArray(b)
    ksp.setTolerances(rtol=tolerance, max_it=500)
    ksp.setOperators(mat)
    ksp.solve(right, way)
    assert ksp.getConvergedReason() > 0
    left = np.linalg.norm(b - dense @ way.getArray())
    assert left <= (1.0 + 1e-3) * tolerance * np.linalg.norm(b)
    assert ksp.getResidualNorm() == pytest.approx(left, rel=0.2)
