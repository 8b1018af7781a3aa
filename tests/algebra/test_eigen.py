"""Eigensolvers: against dense ones of LAPACK, with shifts, rigid motions, old factors and missed modes."""

import numpy as np
import pytest
from modal import solved
from petsc4py import PETSc
from scipy.linalg import eigh

from restshape.algebra.eigenproblems import eigen
from restshape.algebra.eigenproblems.davidson import SearchSpace, davidson
from restshape.algebra.eigenproblems.eigen import EigenSolver
from restshape.algebra.eigenproblems.inverse_iteration import inverse_iteration
from restshape.algebra.eigenproblems.krylov_schur import krylov_schur
from restshape.algebra.eigenproblems.pencil import Deflation, Pencil
from restshape.algebra.eigenproblems.spectrum import gap
from restshape.algebra.factors import lone_factor
from restshape.algebra.factors.interior_factor import has_mumps
from restshape.algebra.stages import Stages
from restshape.calibration import Calibration
from restshape.errors import ReplayProblem


def spring_chain(n: int, stiffer: float = 1.0) -> tuple[PETSc.Mat, PETSc.Mat, np.ndarray]:
    """K, M and the rigid motion of n unit masses in a row, joined by springs, some of them stiffer."""
    k = np.ones(n - 1)
    k[: n // 2] = stiffer
    K = np.diag(np.r_[0, k] + np.r_[k, 0]) - np.diag(k, 1) - np.diag(k, -1)
    return matrix(K), matrix(np.eye(n)), np.ones((1, n))


def matrix(dense: np.ndarray) -> PETSc.Mat:
    """A PETSc matrix on a full pattern, so that all of them have the same one."""
    n = len(dense)
    indptr, indices = np.arange(0, n * n + 1, n, dtype=np.int32), np.tile(np.arange(n, dtype=np.int32), n)
    return PETSc.Mat().createAIJ((n, n), csr=(indptr, indices, dense.ravel()), comm=PETSc.COMM_SELF)


def test_pivots_of_little_things_are_no_zeros():
    # Sheets of micrometres have stiffnesses of 1e-15 N m, below what PETSc takes for a zero whatever the unit.
    stiffness, mass, _ = spring_chain(12)
    stiffness.scale(1e-16)
    mass.scale(1e-16)
    pencil = Pencil(Stages())
    pencil.set_matrices(stiffness, mass, True)
    assert pencil.factor(float(chain_values(12, 2).mean())) == 2


def chain_values(n: int, count: int) -> np.ndarray:
    """Eigenvalues of a free chain of unit springs, that of the rigid motion left out (closed form)."""
    return 4.0 * np.sin(np.arange(1, count + 1) * np.pi / (2 * n)) ** 2


def pencil_of(K: PETSc.Mat, M: PETSc.Mat) -> Pencil:
    pencil = Pencil(Stages())
    pencil.set_matrices(K, M, True)
    return pencil


def solver(method: str, tolerance: float = 1e-10) -> EigenSolver:
    return EigenSolver(method, tolerance, Calibration.load(), Stages())


@pytest.mark.parametrize("method", ["direct", "auto", "ilu"])
def test_chain_of_springs_has_its_closed_form(method):
    K, M, rigid = spring_chain(40)
    found, _ = solver(method).solve(K, M, rigid, 4, True)
    assert found.values[:4] == pytest.approx(chain_values(40, 4), rel=1e-12)


def test_inertia_counts_eigenvalues_below_a_shift():
    K, M, _ = spring_chain(40)
    values = chain_values(40, 6)
    pencil = pencil_of(K, M)
    for k in range(1, 5):
        assert pencil.below(0.5 * (values[k - 1] + values[k])) == k + 1


@pytest.mark.slow
@pytest.mark.parametrize("model", ["plane", "tet4", "tet10", "plate"])
def test_modes_are_those_of_a_dense_solver(model):
    analysis = solved(model)
    K, M = (m.toarray() for m in analysis.state.matrices.gather())
    free = analysis.state.body.boundary.mask.ravel() == 0
    values = eigh(K[np.ix_(free, free)], M[np.ix_(free, free)], eigvals_only=True)
    rigid = len(analysis.state.body.free_rigid_motions())
    assert np.abs(values[:rigid]).max(initial=0.0) < 1e-6 * values[rigid]
    # LAPACK's own error is rounding of the largest eigenvalue.
    expected, rounding = values[rigid : rigid + analysis.state.count], 1e-15 * values[-1]
    assert np.all(np.abs(analysis.state.modes.values[: analysis.state.count] - expected) < 1e-9 * expected + rounding)


@pytest.mark.parametrize("model", ["plane", "tet4", "tet10", "plate"])
def test_modes_have_unit_mass_and_no_rigid_part(model):
    analysis = solved(model)
    K, M = analysis.state.matrices.gather()
    modes, rigid = analysis.state.modes.vectors, analysis.state.body.free_rigid_motions()
    assert modes @ (M @ modes.T) == pytest.approx(np.eye(len(modes)), abs=1e-9)
    if len(rigid):
        parts = modes @ (M @ rigid.T) / np.sqrt(np.einsum("in,ni->i", rigid, M @ rigid.T))
        assert np.abs(parts).max() < 1e-9
        assert np.abs(K @ rigid.T).max() < 1e-9 * abs(K).max()


@pytest.mark.skipif(not has_mumps(), reason="PETSc has no MUMPS, which counts pivots of large pencils")
@pytest.mark.parametrize("model", ["plane", "tet4", "tet10", "plate"])
def test_large_pencils_have_the_counts_and_modes_of_small_ones(model, monkeypatch):
    expected = solved(model)
    monkeypatch.setattr(lone_factor, "LARGE", 0)
    found = solved(model)
    count = expected.state.count
    assert found.state.modes.values[:count] == pytest.approx(expected.state.modes.values[:count], rel=1e-8)
    stiffness, mass = (operator.mat for operator in expected.state.matrices.operators)
    counts = []
    for counted in (False, True):
        pencil = Pencil(Stages(), counted=counted)
        pencil.set_matrices(stiffness, mass, True)
        counts.append([pencil.factor(c * expected.state.modes.values[0]) for c in (-0.01, 0.5, 1.5, 40.0, 3000.0)])
        assert type(pencil._kept) is (lone_factor.CountedFactor if counted else lone_factor.LoneFactor)
    assert counts[0] == counts[1]
    assert counts[1][-1] > count


def test_old_factor_still_finds_the_new_modes():
    K, M, rigid = spring_chain(40)
    auto = solver("auto")
    auto.solve(K, M, rigid, 3, True)
    made = auto.pencil.factorisations
    stiffer, _, _ = spring_chain(40, 1.3)
    found, report = auto.solve(stiffer, M, rigid, 3, False)
    dense = eigh(stiffer[:, :], eigvals_only=True)
    assert found.values[:3] == pytest.approx(dense[1:4], rel=1e-10)
    assert report.method == "davidson" and auto.pencil.factorisations == made


def test_a_search_begins_with_the_modes_that_its_shift_is_chosen_by(monkeypatch):
    """They are multiplied once: with K and with M, for the shift, the search and the distances from eigenvalues."""
    K, M, rigid = spring_chain(40)
    auto = solver("auto")
    auto.solve(K, M, rigid, 3, True)
    stiffer, _, _ = spring_chain(40, 1.3)
    appended, append, start = [], SearchSpace.append, auto.history[0].copy()
    monkeypatch.setattr(SearchSpace, "append", lambda self, rows: (appended.append(rows.copy()), append(self, rows))[1])
    products = auto.pencil.products
    found, report = auto.solve(stiffer, M, rigid, 3, False, verify=True)
    assert report.inertia_checked
    assert sum(rows.shape == start.shape and np.array_equal(rows, start) for rows in appended) == 1
    assert auto.pencil.products - products <= len(rigid) + 2 * sum(map(len, appended))
    assert found.values[:3] == pytest.approx(eigh(stiffer[:, :], eigvals_only=True)[1:4], rel=1e-10)
    difference = stiffer[:, :] @ found.modes.T - found.modes.T * found.values
    np.testing.assert_allclose(found.forces, difference.T, atol=1e-12)


def test_more_modes_of_the_same_matrices_are_sought_and_counted_with_the_same_factor():
    K, M, rigid = spring_chain(40)
    auto = solver("auto")
    auto.solve(K, M, rigid, 3, True)
    stiffer, _, _ = spring_chain(40, 1.3)
    auto.solve(stiffer, M, rigid, 3, False, verify=True)
    made = auto.pencil.factorisations
    found, report = auto.solve(stiffer, M, rigid, 3, False, verify=True, again=True)
    assert report.inertia_checked and auto.pencil.factorisations == made
    found, report = auto.solve(stiffer, M, rigid, 8, False, verify=True, again=True)
    assert report.inertia_checked
    assert found.values[:8] == pytest.approx(eigh(stiffer[:, :], eigvals_only=True)[1:9], rel=1e-10)


def test_what_has_not_converged_below_a_count_is_sought_in_the_space_there_is(monkeypatch):
    K, M, rigid = spring_chain(40)
    auto = solver("auto")
    auto.solve(K, M, rigid, 3, True)
    stiffer, _, _ = spring_chain(40, 1.3)
    auto.solve(stiffer, M, rigid, 3, False, verify=True)
    first = auto.space.found
    auto.pencil.factor(1.001 * first.values[4])
    monkeypatch.setattr(eigen, "SearchSpace", lambda *_: pytest.fail("there is a space already"))
    found = auto._sought(first, 3, 0, 0)
    assert first.residuals[3:5].max() > 1e-10 >= found.residuals[:5].max()
    assert found.values[:5] == pytest.approx(eigh(stiffer[:, :], eigvals_only=True)[1:6], rel=1e-10)


def test_mode_that_the_start_knows_nothing_of_is_counted_and_found():
    K, M, rigid = spring_chain(40)
    auto = solver("auto")
    first, _ = auto.solve(K, M, rigid, 2, True)
    # The lowest mode is taken out of all that is remembered, and a symmetric matrix never mixes it in again.
    auto.history = [first.modes[1:].copy()]
    auto.unchecked = 10**6
    found, report = auto.solve(K, M, rigid, 2, False)
    assert report.missed_modes == 1
    assert found.values[:2] == pytest.approx(chain_values(40, 2), rel=1e-10)


@pytest.mark.parametrize(("n", "count", "copies"), [(40, 2, 4), (40, 1, 5), (60, 4, 3), (30, 3, 2), (25, 6, 8)])
def test_first_frame_of_equal_bodies_has_each_eigenvalue_as_often_as_there_are_bodies(n, count, copies):
    """A Krylov space grown from one vector knows one of them."""
    chain = 2.0 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
    size = n * copies
    auto = solver("auto", 1e-8)
    found, report = auto.solve(
        matrix(np.kron(np.eye(copies), chain)), matrix(np.eye(size)), np.empty((0, size)), count, True
    )
    exact = np.repeat(4.0 * np.sin(np.arange(1, n + 1) * np.pi / (2 * (n + 1))) ** 2, copies)
    assert found.values[:count] == pytest.approx(exact[:count], rel=1e-10)
    assert report.inertia_checked and np.all(found.residuals[:count] <= 1e-8)


@pytest.mark.parametrize("method", ["auto", "direct"])
def test_body_whose_mode_comes_down_is_found_where_a_count_is_asked_for(method):
    """Two chains that do not couple; the second one loses its stiffness while the modes of the first are followed."""
    n = 40
    chain = 2.0 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
    mass, rigid, own, still = matrix(np.eye(2 * n)), np.empty((0, 2 * n)), solver(method, 1e-6), np.zeros((n, n))
    lowest = 4.0 * np.sin(np.arange(1, 3) * np.pi / (2 * (n + 1))) ** 2
    for frame in range(9):
        softer = 60.0 * 0.5**frame
        K = matrix(np.block([[chain, still], [still, softer * chain]]))
        found, report = own.solve(K, mass, rigid, 2, frame == 0, verify=frame == 8)
    assert report.inertia_checked
    assert found.values[:2] == pytest.approx(softer * lowest, rel=1e-9)


def test_davidson_gives_up_at_its_limit():
    K, M, rigid = spring_chain(60)
    pencil = pencil_of(K, M)
    pencil.factor(-1.0)
    start = np.random.default_rng(0).standard_normal((3, 60))
    found = davidson(SearchSpace(pencil, 40), Deflation(rigid, pencil), [start], 2, 1, 1e-12, 2)
    assert not found.converged and found.iterations == 2


def test_davidson_goes_on_when_its_space_is_full():
    K, M, rigid = spring_chain(60)
    pencil = pencil_of(K, M)
    pencil.factor(-1.0)
    start = np.random.default_rng(0).standard_normal((4, 60))
    found = davidson(SearchSpace(pencil, 12), Deflation(rigid, pencil), [start], 2, 2, 1e-10, 400)
    assert found.converged
    assert found.values[:2] == pytest.approx(chain_values(60, 2), rel=1e-9)


def test_krylov_schur_and_inverse_iteration_agree_with_the_closed_form_of_a_chain():
    K, M, rigid = spring_chain(50)
    pencil = pencil_of(K, M)
    pencil.factor(-1e-3)
    deflation = Deflation(rigid, pencil)
    found = krylov_schur(pencil, deflation, None, 5, 1e-11)
    assert found.values[:5] == pytest.approx(chain_values(50, 5), rel=1e-10)
    starts = np.random.default_rng(1).standard_normal((3, 50))
    assert inverse_iteration(pencil, deflation, starts, 3, 1e-8).values == pytest.approx(chain_values(50, 3), rel=1e-9)


def test_gap_is_the_widest_one_behind_the_wanted():
    shift, below = gap(np.array([1.0, 2.0, 2.001, 6.0]), 2)
    assert below == 3 and 2.001 < shift < 6.0


def test_gap_is_no_trap_of_values_that_have_not_converged():
    """A value far above the others may stand for any mode: the shift stays near those that are known."""
    shift, below = gap(np.array([1.0, 2.0, 2.5, 900.0]), 2)
    assert below == 3 and 2.5 < shift < 3.1
    shift, below = gap(np.array([1.0, 2.0, 400.0, 900.0]), 2)
    assert below == 2 and 2.0 < shift < 2.5


def test_search_that_rounding_holds_up_ends_after_a_bounded_number_of_iterations(monkeypatch):
    """Springs 10^13 times as stiff as the rest leave residuals of 10^-2 in double precision, whatever is done."""
    iterations = []

    def counted(*arguments):
        found = davidson(*arguments)
        iterations.append(found.iterations)
        return found

    monkeypatch.setattr(eigen, "davidson", counted)
    K, M, rigid = spring_chain(40, 1e13)
    with pytest.raises(ReplayProblem, match="rounding leaves a residual of") as raised:
        solver("auto", 1e-8).solve(K, M, rigid, 4, True)
    assert "times as stiff as the body" in str(raised.value)
    assert 0 < sum(iterations) <= eigen.MOST_ITERATIONS
