"""The kept preconditioner: an independent conjugate gradient method, and the best schedule in hindsight."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from petsc4py import PETSc
from scipy.sparse.linalg import spilu, splu
from small_scenes import across, drag, make_replay, plate, write_scene, write_script

from restshape.algebra.factors.gathering import GatheredSystem
from restshape.algebra.linear import LinearSolver
from restshape.algebra.linear_report import true_residual
from restshape.algebra.reuse.traits import Traits
from restshape.algebra.stages import Stages
from restshape.calibration import Calibration
from restshape.errors import ReplayProblem

FRAMES, TOLERANCE = 40, 1e-6


def conjugate_gradients(A, b, inverse):
    """The iterations from 0 until the true residual falls below TOLERANCE, and the solution."""
    x, r = np.zeros_like(b), b.copy()
    z = inverse(r)
    p, rz, limit, k = z.copy(), r @ z, TOLERANCE * np.linalg.norm(b), 0
    while np.linalg.norm(r) > limit:
        Ap = A @ p
        step = rz / (p @ Ap)
        x += step * p
        r -= step * Ap
        z = inverse(r)
        rz, old = r @ z, rz
        p = z + rz / old * p
        k += 1
    return k, x


@pytest.fixture(scope="module")
def systems(tmp_path_factory):
    """Matrix and right side of each frame of a drag that goes one way, on one mesh."""
    folder = tmp_path_factory.mktemp("drag")
    script = write_script(folder, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.8, 0.5), FRAMES)))
    # Nothing counts as of low quality, so that the mesh stays the same.
    made = make_replay(write_scene(folder, plate()), script, "refactor", ["mesh.min_quality=0.01"])
    found = []
    for row in made.frames():
        if row["level"]:
            found.append(
                GatheredSystem(made.analysis.warm_system().matrix, made.analysis.state.system.right.ravel().copy())
            )
    assert len(found) == FRAMES + 1
    return found


@pytest.fixture(scope="module")
def table(systems):
    """Iterations of frame j with the factor of frame i: (FRAMES + 1, FRAMES + 1), i <= j."""
    count = np.zeros((len(systems), len(systems)), dtype=int)
    for i, old in enumerate(systems):
        inverse = splu(old.matrix.tocsc()).solve
        for j in range(i, len(systems)):
            count[i, j] = conjugate_gradients(systems[j].matrix, systems[j].solution, inverse)[0]
    return count


def petsc(system):
    """PETSc's matrix, right side and a zero guess of a system."""
    A = system.matrix
    mat = PETSc.Mat().createAIJ(A.shape, csr=(A.indptr, A.indices, A.data), comm=PETSc.COMM_SELF)
    mat.setOption(PETSc.Mat.Option.SPD, True)
    b = mat.createVecLeft()
    b.setArray(system.solution)
    return mat, b, mat.createVecRight()


def solver(method="stale", dearer=1.0):
    """A solver for which a refresh costs so many times what it does nominally."""
    nominal = Calibration.load()
    known = replace(
        nominal, numeric_nonzero=dearer * nominal.numeric_nonzero, numeric_work=dearer * nominal.numeric_work
    )
    return LinearSolver(PETSc.COMM_SELF, "test_", method, TOLERANCE, known, Stages(), traits=Traits())


def run(systems, method="stale", dearer=1.0):
    """What each solve of a sequence of systems on one mesh reported, and the solver."""
    made, reports = solver(method, dearer), []
    for k, system in enumerate(systems):
        mat, b, x = petsc(system)
        reports.append(made.solve(mat, b, x, k == 0))
        assert true_residual(mat, b, x) <= TOLERANCE * (1 + 1e-6)
        error = np.linalg.norm(system.solution - system.matrix @ x.getArray())
        assert error <= TOLERANCE * (1 + 1e-6) * np.linalg.norm(system.solution)
    return reports, made


@pytest.mark.slow
@pytest.mark.parametrize("dearer", [0.3, 1.0, 4.0, 1e6])
def test_iterations_are_those_of_an_independent_method(systems, table, dearer):
    reports, _ = run(systems, dearer=dearer)
    factor = 0
    for j, report in enumerate(reports):
        cost = table[factor, j]
        if report.refreshed:
            factor = j
        elif j:
            assert abs(report.iterations - cost) <= 1
            assert report.age == j - factor
    assert sum(report.refreshed for report in reports) > 1 or dearer > 4


def best_schedule(table, refresh):
    """The least cost of all schedules of refreshes, in iterations; the first frame is a refresh."""
    n = len(table)
    best = [0.0] + [np.inf] * n
    for start in range(n):
        for end in range(start + 1, n + 1):
            cost = best[start] + refresh + table[start, start:end].sum()
            best[end] = min(best[end], cost)
    return best[n]


@pytest.mark.parametrize("dearer", [0.3, 1.0, 3.0, 10.0])
def test_never_worse_than_twice_the_best_schedule(systems, table, dearer):
    reports, made = run(systems, dearer=dearer)
    refresh = made.refresh.break_even
    spent = sum(report.iterations + refresh * report.refreshed for report in reports)
    best = best_schedule(table, refresh)
    always, never = (FRAMES + 1) * (refresh + 1), refresh + table[0].sum()
    assert best <= min(always, never) * (1 + 1e-12)
    assert best <= spent <= 2 * best + table[0, -1]
    # The rule is worth something: one of the two fixed habits is worse by far.
    assert spent < 0.9 * max(always, never)


def test_the_budget_is_the_price_of_a_refresh(systems):
    _, made = run(systems[:1])
    A = systems[0].matrix
    filled = made.ksp.getPC().getFactorMatrix().getInfo()["nz_used"]
    assert splu(A.tocsc(), permc_spec="MMD_AT_PLUS_A").L.nnz / 3 < filled < 3 * A.nnz
    known = made.kept.choice.calibration
    price = known.refresh_seconds(A.shape[0], A.nnz, filled) / known.iteration_seconds(A.shape[0], A.nnz, filled)
    assert price <= made.refresh.break_even < price + 1


def test_a_jump_is_noticed_in_mid_solve(systems, table):
    reports, made = run([systems[0], systems[1], systems[-1], systems[-1], systems[-2]])
    assert made.refresh.break_even < table[0, -1]
    jump, same, near = reports[2:]
    assert jump.refreshed and jump.age == 0
    assert made.refresh.break_even <= jump.iterations <= made.refresh.break_even + 3
    # The factor is that of the jump's own matrix now, and it is kept.
    assert not same.refreshed and same.age == 1 and same.iterations == 1
    assert not near.refreshed and near.age == 2 and near.iterations <= 4


def test_direct_factors_each_time(systems):
    reports, _ = run(systems[:5], "direct")
    assert all(report.refreshed and report.age == 0 for report in reports)


def test_ilu_is_kept(systems):
    reports, _ = run(systems, "ilu")
    assert [report.refreshed for report in reports] == [True] + FRAMES * [False]
    assert [report.age for report in reports] == list(range(FRAMES + 1))
    system = systems[0]
    full = conjugate_gradients(system.matrix, system.solution, splu(system.matrix.tocsc()).solve)[0]
    none = conjugate_gradients(system.matrix, system.solution, lambda r: r)[0]
    loose = conjugate_gradients(system.matrix, system.solution, spilu(system.matrix.tocsc(), 1e-8, 20).solve)[0]
    assert loose <= full + 3
    assert full < reports[0].iterations < none / 3


def test_a_new_system_makes_a_new_factor(systems):
    made = solver()
    for k in range(3):
        A = sp.csr_matrix(systems[0].matrix[: -2 * k or None, : -2 * k or None])
        mat, b, x = petsc(GatheredSystem(A, np.ones(A.shape[0])))
        report = made.solve(mat, b, x, True)
        assert report.refreshed and report.age == 0 and report.iterations <= 2


@pytest.mark.parametrize("kind", ["asm", "bjacobi"])
def test_a_set_up_that_has_failed_does_not_spoil_the_next_ones(systems, kind):
    """As ranks have it; PETSc 3.18 keeps what a block has failed by."""
    options = PETSc.Options("test_")
    given = {"pc_type": kind, "sub_pc_type": "cholesky"}
    for key, value in given.items():
        options.setValue(key, value)
    try:
        made, system = solver(), systems[0]
        singular = GatheredSystem(0.0 * system.matrix, system.solution)
        with pytest.raises(ReplayProblem):
            made.solve(*petsc(singular), True)
        mat, b, x = petsc(system)
        made.solve(mat, b, x, True)
        assert true_residual(mat, b, x) <= TOLERANCE * (1 + 1e-6)
    finally:
        for key in given:
            options.delValue(key)


def test_a_pattern_analysed_beside_serves_the_next_new_system_alone(systems, monkeypatch):
    """A frame that is refused takes up none: another system comes next, whatever has the matrix after it."""
    made, chosen = solver("direct"), []
    begin = made.kept.begin_system
    monkeypatch.setattr(made.kept, "begin_system", lambda *given: (chosen.append(given), begin(*given)))
    first, second = (petsc(system)[0] for system in systems[:2])
    assert made.factor_beside(first, 40) is not None
    made.prepare(first, True, 40)
    assert len(chosen) == 1
    assert made.factor_beside(first, 40) is not None
    for k, mat in enumerate((second, first)):
        made.prepare(mat, True, 40)
        assert len(chosen) == 3 + k


def test_nothing_loaded_has_the_solution_0(systems):
    for method in ("stale", "ilu", "direct"):
        mat, b, x = petsc(GatheredSystem(systems[0].matrix, np.zeros(systems[0].matrix.shape[0])))
        solver(method).solve(mat, b, x, True)
        assert x.norm() == 0.0 and true_residual(mat, b, x) == 0.0
