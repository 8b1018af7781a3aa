"""Linear solves of steps against dense linear algebra."""

import numpy as np
import pytest
from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.nodal import NodalVectors
from restshape.algebra.nonlinear.step_solver import StepSolver

NODES, FIELDS = 60, 3
N = NODES * FIELDS
KINDS = ("sor", "ilu", "cholesky")


def stretched(seed: int, inertia: float) -> np.ndarray:
    """A matrix (N, N) of stiff bars between nodes in a row and across, with masses times an inertia."""
    random = np.random.default_rng(seed)
    dense = inertia * np.eye(N)
    for i in range(NODES):
        for j in (i + 1, i + 2, i + 7):
            if j < NODES:
                axis = random.normal(size=FIELDS)
                bar = np.kron([[1.0, -1.0], [-1.0, 1.0]], np.outer(axis, axis))
                both = [*range(FIELDS * i, FIELDS * (i + 1)), *range(FIELDS * j, FIELDS * (j + 1))]
                dense[np.ix_(both, both)] += bar
    return dense


def petsc(dense: np.ndarray) -> PETSc.Mat:
    nodes = abs(dense).reshape(NODES, FIELDS, NODES, FIELDS).sum(axis=(1, 3)) > 0.0
    rows, columns = np.nonzero(np.kron(nodes, np.ones((FIELDS, FIELDS))))
    starts = np.searchsorted(rows, np.arange(N + 1)).astype(np.int32)
    csr = starts, columns.astype(np.int32), dense[rows, columns]
    return PETSc.Mat().createAIJ(dense.shape, csr=csr, comm=PETSc.COMM_SELF)


def solver(kind: str, tolerance: float) -> StepSolver:
    nodal = NodalVectors(PETSc.COMM_SELF, (NODES, FIELDS), slice(0, N))
    return StepSolver(PETSc.COMM_SELF, "steps_test_", nodal, tolerance, kind)


def steps(count: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Matrices and right sides that change little from one to the next."""
    first, last = stretched(0, 0.05), stretched(1, 0.05)
    random = np.random.default_rng(2)
    right, change = random.normal(size=N), random.normal(size=N)
    parts = np.linspace(0.0, 0.1, count)
    return [((1.0 - t) * first + t * last, right + t * change) for t in parts]


def error(dense: np.ndarray, right: np.ndarray, way: np.ndarray) -> float:
    """Residual of a solution over the right side."""
    return float(np.linalg.norm(right - dense @ way.ravel()) / np.linalg.norm(right))


@pytest.mark.parametrize("kind", KINDS)
def test_the_residual_is_that_asked_for_whatever_was_solved_before(kind):
    way = solver(kind, 1e-3)
    for dense, right in steps(6):
        assert error(dense, right, way.solve(petsc(dense), right.reshape(NODES, FIELDS))) <= 1e-3 * (1.0 + 1e-9)
    way.free()


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_kept_gives_what_a_new_solver_gives(kind):
    kept = solver(kind, 1e-9)
    for dense, right in steps(4):
        found = kept.solve(petsc(dense), right.reshape(NODES, FIELDS))
        fresh = solver(kind, 1e-9)
        np.testing.assert_allclose(found, fresh.solve(petsc(dense), right.reshape(NODES, FIELDS)), rtol=1e-6, atol=1e-9)
        fresh.free()
    kept.free()


def test_earlier_solutions_spare_iterations():
    kept, alone = solver("sor", 1e-2), 0
    for dense, right in steps(6):
        kept.solve(petsc(dense), right.reshape(NODES, FIELDS))
        fresh = solver("sor", 1e-2)
        fresh.solve(petsc(dense), right.reshape(NODES, FIELDS))
        alone += fresh.iterations
        fresh.free()
    assert kept.iterations < 0.6 * alone
    kept.free()


def test_the_guess_is_the_best_sum_of_the_last_two_solutions():
    way, pairs = solver("sor", 1e-3), steps(3)
    known = [way.solve(petsc(dense), right.reshape(NODES, FIELDS)).ravel() for dense, right in pairs[:2]]
    dense, right = pairs[2]
    # With so loose a tolerance the guess stands as it is.
    way.tolerance = 1e30
    guess = way.solve(petsc(dense), right.reshape(NODES, FIELDS)).ravel()
    both = np.stack(known, axis=1)
    best = both @ np.linalg.solve(both.T @ dense @ both, both.T @ right)
    np.testing.assert_allclose(guess, best, atol=1e-10 * np.abs(best).max())
    way.free()


def test_each_solution_goes_down_in_the_energy_of_its_step():
    way = solver("sor", 0.5)
    for dense, right in [*steps(3), (stretched(5, 0.05), -steps(1)[0][1])]:
        d = way.solve(petsc(dense), right.reshape(NODES, FIELDS)).ravel()
        assert 0.5 * d @ dense @ d - right @ d < 0.0
    way.free()


def test_a_row_of_solves_gives_the_same_bits_again():
    way, rows = solver("sor", 1e-2), []
    for _ in range(2):
        way.begin()
        rows.append([way.solve(petsc(dense), right.reshape(NODES, FIELDS)) for dense, right in steps(4)])
    assert np.array_equal(*rows)
    way.free()


@pytest.mark.parametrize("kind", KINDS)
def test_another_pattern_and_a_right_side_of_nothing(kind):
    way = solver(kind, 1e-6)
    for dense in (stretched(0, 0.05), np.kron(np.eye(NODES), np.full((FIELDS, FIELDS), 0.5)) + np.eye(N)):
        right = np.arange(N, dtype=float)
        assert error(dense, right, way.solve(petsc(dense), right.reshape(NODES, FIELDS))) < 1.1e-6
    assert not way.solve(petsc(dense), np.zeros((NODES, FIELDS))).any()
    way.free()


def test_a_matrix_of_no_numbers_has_no_solution():
    way, matrix = solver("sor", 1e-2), petsc(stretched(0, 0.05))
    matrix.scale(np.nan)
    assert way.solve(matrix, np.ones((NODES, FIELDS))) is None
    way.free()


def test_where_relaxation_takes_many_iterations_complete_factors_take_its_place():
    """Bars 1e3 times as stiff as masses: the first solve shows it, and the next ones have the same residuals."""
    way, taken = solver("sor", 1e-6), []
    dense = stretched(0, 1e-3)
    for t in np.linspace(0.0, 0.02, 5):
        now = (1.0 - t) * dense + t * stretched(1, 1e-3)
        right = np.random.default_rng(3).normal(size=(NODES, FIELDS))
        before = way.iterations
        matrix = petsc(now)
        matrix.setBlockSize(FIELDS)
        found = way.solve(matrix.convert("seqbaij", PETSc.Mat()) if way.blocks else matrix, right)
        taken.append(way.iterations - before)
        assert error(now, right.ravel(), found) <= 1e-6 * (1.0 + 1e-9)
        assert not way.blocks
    assert taken[0] > N**0.5 and max(taken[1:]) <= 7
    way.begin()
    assert way.blocks
    way.free()


def test_an_old_factor_that_serves_again_substitutes_by_panels():
    """Of single precision, whose solutions are as exact; a new factor solves once by PETSc's own substitution."""
    way, dense = solver("sor", 1e-6), stretched(0, 1e-3)
    right, matrix, taken, numbers = np.random.default_rng(3).normal(size=(NODES, FIELDS)), None, [], []
    for t in (0.0, 0.0, 1e-5, 2e-5):
        now = (1.0 - t) * dense + t * stretched(1, 1e-3)
        if matrix is None or way.blocks:
            matrix = petsc(now)
            matrix.setBlockSize(FIELDS)
        else:
            petsc(now).copy(matrix)
        before = way.iterations
        found = way.solve(matrix, right + t)
        taken.append(way.iterations - before)
        assert error(now, (right + t).ravel(), found) <= 1e-6 * (1.0 + 1e-9)
        if taken[1:]:
            numbers.append(_kernels.panel_value_bytes(way._complete.getPC().getFactorMatrix().handle))
    assert numbers[-1] == 4 and max(taken[1:]) <= 10, (numbers, taken)
    way.free()
