"""Policy `auto`: the choice by counted work, refreshes in mid-solve, and the same answer with each preconditioner."""

import json
from dataclasses import replace

import numpy as np
import pytest
from petsc4py import PETSc
from small_scenes import across, drag, make_replay, plate, rows_of, write_scene, write_script

from restshape import _kernels, measurement
from restshape.algebra.linear import LinearSolver
from restshape.algebra.linear_report import true_residual
from restshape.algebra.projection import Projection
from restshape.algebra.reuse.candidates import CHOLESKY, GAMG, ICC, ILU
from restshape.algebra.reuse.choice import Choice
from restshape.algebra.reuse.kept_preconditioner import KeptPreconditioner
from restshape.algebra.reuse.prices import Size, prices
from restshape.algebra.reuse.traits import Traits
from restshape.algebra.stages import LOGGED, Stages, log_stage
from restshape.calibration import Calibration
from restshape.errors import ReplayProblem

NOMINAL = Calibration.load()
EVENTS = drag("window", (0.5, 0.5), across((0.5, 0.5), (1.3, 0.5), 40))
NO_REFRESH = replace(NOMINAL, numeric_nonzero=1e9, ilu_numeric_nonzero=1e9, gamg_refresh_nonzero=1e9)


def plane(n: int, ranks: int = 1) -> Size:
    """A plate of triangles."""
    return Size(n, 13.8 * n, 2, ranks)


def solver(prefix="auto_", method="auto", calibration=NOMINAL, **settings) -> LinearSolver:
    return LinearSolver(
        PETSc.COMM_SELF, prefix, method, 1e-6, calibration, Stages(), **{"traits": Traits(), **settings}
    )


# --- the choice ---------------------------------------------------------------------------------------------------


def test_in_the_plane_a_complete_factor_is_best_while_memory_holds_it():
    """On the plate a level-1 frame of 1,000,000 unknowns takes 0.6 of the time that one with multigrid takes."""
    names = [Choice(NOMINAL)(plane(n)).name for n in (500, 2_000, 8_000, 20_000, 200_000, 1_000_000, 5_000_000)]
    assert names == 6 * ["cholesky"] + ["gamg"]


def test_in_space_multigrid_is_best_from_some_ten_thousand_unknowns_on_of_sheets_later():
    """Work on a factor of a sheet grows as in the plane."""
    found = {}
    for sheet in (False, True):
        choice = Choice(NOMINAL, traits=Traits(fields=3, dimension=3, sheet=sheet))
        sizes = [Size(n, 42.0 * n, 3, fields=3, sheet=sheet) for n in (1_000, 5_000, 13_000, 40_000)]
        found[sheet] = [choice(size).name for size in sizes]
    assert found[False] == ["cholesky", "cholesky", "gamg", "gamg"]
    assert found[True][:3] == 3 * ["cholesky"]
    assert KeptPreconditioner(PETSc.KSP().create(), choice, choice.traits, None, "auto").size.sheet


def test_a_factor_larger_than_memory_is_never_chosen():
    # 2,000 unknowns have a factor of about 50,000 nonzeros: 0.6 MB.
    assert Choice(NOMINAL, memory=2e6)(plane(2_000)) is CHOLESKY
    assert Choice(NOMINAL, memory=2e5)(plane(2_000)) is not CHOLESKY


@pytest.mark.parametrize("ranks", [2, 4])
def test_incomplete_factors_of_ranks_own_rows_take_no_fewer_iterations_than_complete_ones(ranks):
    """What couples the rows of different ranks is in neither: on small meshes that is what both wait for."""
    choice = Choice(NOMINAL)
    for n in (160, 450, 2_000, 20_000):
        least = choice.expected(CHOLESKY, plane(n, ranks))[0]
        assert all(choice.expected(one, plane(n, ranks))[0] >= least for one in (ICC, ILU))
    assert not {ICC, ILU} & {choice(plane(n, ranks)) for n in (160, 450, 2_000)}


def test_the_choice_follows_what_is_counted():
    choice, size = Choice(NOMINAL), plane(20_000)
    assert choice(size) is CHOLESKY
    for age in range(60):
        choice.count(CHOLESKY, size, age % 6, 8 * (age % 6))
    for age in range(60):
        choice.count(GAMG, size, age, 3)
    assert choice(size) is GAMG
    # Counted were 8 more with each solve of age, less what the prior weighs.
    assert choice.expected(CHOLESKY, size)[1] == pytest.approx(8, rel=0.25)


def test_iterations_of_incomplete_factors_scale_with_the_mesh():
    choice = Choice(NOMINAL)
    for _ in range(1000):
        choice.count(ILU, plane(2_000), 0, 50)
    # Conjugate gradients with ILU(k) on a second-order problem in the plane: iterations grow like 1/h.
    assert choice.expected(ILU, plane(8_000))[0] == pytest.approx(100, rel=0.02)


def test_the_predicted_life_is_the_cheapest():
    """The cost of a solve against a sum over lives, with no new meshes in sight."""
    choice, size = Choice(NOMINAL), plane(2_000)
    choice.solves = 1e12
    price = prices("cholesky", size, choice.filled(CHOLESKY, size), NOMINAL)
    fresh, growth = choice.expected(CHOLESKY, size)
    lives = [
        (price.refresh + sum(price.iteration * (fresh + growth * age) for age in range(life))) / life
        for life in range(1, 200)
    ]
    # The sum over whole ages falls short of the integral by half a growth.
    assert choice.cost(CHOLESKY, size) == pytest.approx(min(lives) + price.iteration * growth / 2, rel=0.02)


def test_what_has_failed_is_not_chosen_again():
    choice, size = Choice(NOMINAL), plane(2_000)
    for candidate in (CHOLESKY, ICC, ILU):
        choice.exclude(candidate)
    assert choice(size) is GAMG
    choice.exclude(GAMG)
    assert choice(size) is GAMG


# --- a box of tetrahedra ------------------------------------------------------------------------------------------


def box(m: int, bend: float = 0.0):
    """The stiffness of a unit cube of 6 m^3 tetrahedra held at the bottom, its right side, and the nodes."""
    X, cells = measurement.box(m + 1)
    X[:, 0] += bend * np.sin(np.pi * X[:, 0]) * X[:, 2]
    element = _kernels.Element("linear_elastic_tet4")
    values = {"lambda": 1.2, "mu": 0.8, "bz": -1.0}
    params = np.array([values.get(name, 0.0) for name in element.parameters])
    operator = _kernels.Operator(False, 3, np.array([0, len(X)], dtype=np.int32), 0, "csr")
    operator.set_topology([cells])
    operator.set_constraints(np.repeat(X[:, 2] == 0, 3).astype(np.uint8))
    rhs = np.zeros(X.size)
    operator.begin()
    operator.add(0, np.ascontiguousarray(X), [(element, np.zeros_like(X), params, 1.0)], rhs)
    operator.end()
    mat = operator.mat
    b, x = mat.createVecLeft(), mat.createVecRight()
    b.setArray(rhs)
    return operator, mat, b, x, X


@pytest.mark.parametrize("memory", [4e9, 1e6])
def test_in_space_a_complete_factor_loses(memory):
    _, mat, b, x, X = box(14)
    made = solver(memory=memory, traits=Traits(fields=3, dimension=3))
    report = made.solve(mat, b, x, True, places=X)
    assert report.preconditioner in ("icc(1)", "ilu(1)", "gamg")
    assert true_residual(mat, b, x) <= 1e-6


def test_multigrid_knows_the_rigid_motions():
    found = {}
    PETSc.Options()["forced_pc_type"] = "gamg"
    for m in (4, 12):
        for known in (False, True):
            _, mat, b, x, X = box(m)
            found[m, known] = (
                solver("forced_", traits=Traits(fields=3, dimension=3))
                .solve(mat, b, x, True, places=X if known else None)
                .iterations
            )
            assert true_residual(mat, b, x) <= 1e-6
    PETSc.Options().delValue("forced_pc_type")
    # With them the iterations hardly grow with the mesh, 27 times as large.
    assert found[12, True] <= 1.6 * found[4, True]
    assert found[12, True] < 0.8 * found[12, False]


@pytest.mark.parametrize("kind", ["cholesky", "icc", "ilu", "gamg"])
def test_each_preconditioner_solves_when_old(kind):
    PETSc.Options()["old_pc_type"] = kind
    made = solver("old_", traits=Traits(fields=3, dimension=3))
    PETSc.Options().delValue("old_pc_type")
    assert not made.kept.chooses
    reports = []
    kept = []
    for k, bend in enumerate(np.linspace(0, 0.2, 9)):
        operator, mat, b, x, X = box(5, bend)
        kept.append(operator)
        reports.append(made.solve(mat, b, x, k == 0, places=X))
        assert true_residual(mat, b, x) <= 1e-6 * (1 + 1e-6)
    assert {report.preconditioner for report in reports} == {kind}
    assert not all(report.refreshed for report in reports)


# --- refreshes ----------------------------------------------------------------------------------------------------


def diagonal(values) -> PETSc.Mat:
    n = len(values)
    index = np.arange(n + 1, dtype=PETSc.IntType)
    mat = PETSc.Mat().createAIJ((n, n), csr=(index, index[:n], np.asarray(values, float)), comm=PETSc.COMM_SELF)
    mat.setOption(PETSc.Mat.Option.SPD, True)
    return mat


def test_a_factor_that_has_become_indefinite_is_rebuilt():
    """The factor of a matrix of both signs: conjugate gradients break down, and once more is enough."""
    values = np.linspace(1, 5, 60)
    made, b = solver(method="stale"), PETSc.Vec().createWithArray(np.ones(60), comm=PETSc.COMM_SELF)
    for k, sign in enumerate((np.where(np.arange(60) % 3, 1.0, -1.0), 1.0)):
        mat, x = diagonal(sign * values), PETSc.Vec().createWithArray(np.zeros(60), comm=PETSc.COMM_SELF)
        report = made.solve(mat, b, x, k == 0)
        assert report.refreshed and report.age == 0
    np.testing.assert_allclose(x.getArray(), 1 / values, rtol=1e-5)


def test_numbers_that_are_none_do_not_stay():
    made, b = solver(method="stale"), PETSc.Vec().createWithArray(np.ones(40), comm=PETSc.COMM_SELF)
    good, bad = np.linspace(1, 2, 40), np.full(40, np.nan)
    x = PETSc.Vec().createWithArray(np.zeros(40), comm=PETSc.COMM_SELF)
    made.solve(diagonal(good), b, x, True)
    with pytest.raises(ReplayProblem):
        made.solve(diagonal(bad), b, x, False)
    report = made.solve(diagonal(good), b, x, False)
    assert report.refreshed and true_residual(diagonal(good), b, x) <= 1e-6


def factorisations() -> int:
    """Numeric Cholesky factorisations so far."""
    stages = [None, *map(log_stage, LOGGED)]
    event = PETSc.Log.Event("MatCholFctrNum")
    return sum(event.getPerfInfo(stage and stage.id)["count"] for stage in stages)


def test_level_2_keeps_the_factor_while_that_pays(tmp_path):
    """Level 2 makes one where the frames before have spent it, or where its own iteration was given up."""
    PETSc.Log.begin()
    made = make_replay(
        write_scene(tmp_path, plate(0.07)),
        write_script(tmp_path, drag("window", (0.5, 0.5), across((0.5, 0.5), (1.5, 0.5), 60))),
        "auto",
        ["solve.jumps=false"],  # which solves on a second mesh
        relocation="laplacian",
        criterion="author",
    )
    before, kept, spent = factorisations(), 0, False
    for row in made.frames():
        now, refresh = factorisations(), made.analysis.solver.refresh
        assert now - before == row["pc_rebuilt"]
        if row["level"] == 2:
            kept += not row["pc_rebuilt"]
            # A fresh factor needs 1 iteration: more means that the old one was tried.
            assert not row["pc_rebuilt"] or row["iterations"] > 2 or spent
        # At the price on the old pattern, which is the least.
        spent = refresh.ahead > 0 or refresh.worth_refreshing()
        before = now
    assert kept >= 3


def test_after_a_patch_a_refresh_is_dearer(tmp_path):
    made = make_replay(
        write_scene(tmp_path, plate(0.07)),
        write_script(tmp_path, drag("window", (0.5, 0.5), across((0.5, 0.5), (1.5, 0.5), 60))),
        "auto",
        relocation="laplacian",
        criterion="author",
    )
    seen = set()
    for row in made.frames():
        own = made.analysis.solver
        if row["level"] == 2 and own.kept.pattern_changed:
            size, filled = own.kept.size, own.kept.filled
            price = NOMINAL.factor_seconds(size.unknowns, size.nonzeros, filled)
            one = NOMINAL.iteration_seconds(size.unknowns, size.nonzeros, filled)
            assert own.refresh.break_even == pytest.approx(price / one, abs=1.0)
            seen.add("patched")
    assert seen


@pytest.mark.slow
def test_a_thousand_frames_without_a_refresh(tmp_path):
    """The factor of the first frame serves for good, unless the mesh is rebuilt; each frame is solved or says why."""
    path = [(0.5 + 0.45 * np.sin(0.05 * k), 0.5 + 0.1 * np.sin(0.13 * k)) for k in range(1, 1001)]
    script = write_script(tmp_path, drag("window", (0.5, 0.5), path))
    made = make_replay(
        write_scene(tmp_path, plate(0.15)), script, "auto", ["mesh.min_quality=0.05"], calibration=NO_REFRESH
    )
    rows = []
    for row in made.frames():
        rows.append(row)
        if not row["refused"]:
            assert made.analysis.residual_norm() <= 1e-6 * (1 + 1e-6)
    assert len(rows) == 1003
    moved = [row for row in rows[1:] if row["level"]]
    assert sum(row["pc_rebuilt"] and row["level"] < 3 for row in moved) == 0
    assert max(row["iterations"] for row in moved) < 1000
    assert max(row["pc_age"] for row in moved) > 100


# --- guesses ------------------------------------------------------------------------------------------------------


def test_a_guess_is_the_nearest_point_in_energy():
    """Against a dense least squares problem with the square root of A."""
    rng = np.random.default_rng(3)
    A = np.diag(np.linspace(1, 30, 50))
    mat = diagonal(np.diagonal(A))
    right = rng.normal(size=50)
    solutions = [rng.normal(size=50) for _ in range(4)]
    made = Projection(PETSc.COMM_SELF, 3)

    def vector(values):
        return PETSc.Vec().createWithArray(values.copy(), comm=PETSc.COMM_SELF)

    for y in solutions:
        made.keep(vector(y))
    x = vector(solutions[-1])
    made(mat, vector(right), x)
    steps, root = np.diff(solutions, axis=0).T, np.sqrt(A)
    error = np.linalg.solve(A, right) - solutions[-1]
    weights = np.linalg.lstsq(root @ steps, root @ error, rcond=None)[0]
    np.testing.assert_allclose(x.getArray(), solutions[-1] + steps @ weights, rtol=1e-8)


@pytest.mark.slow
def test_projected_guesses_save_iterations(tmp_path):
    scene, script = write_scene(tmp_path, plate(0.014)), write_script(tmp_path, EVENTS)
    # Projections pay where a substitution costs more than they do, as on larger meshes.
    solve, numeric = 4.0 * NOMINAL.solve_nonzero, 12.0 * NOMINAL.numeric_nonzero
    dear = replace(NOMINAL, solve_nonzero=solve, numeric_nonzero=numeric)
    spent = []
    for guess in ("extrapolated", "projected"):
        rows = rows_of(make_replay(scene, script, "auto", ["mesh.min_quality=0.05"], guess=guess, calibration=dear))
        spent.append((sum(row["iterations"] for row in rows), sum(row["pc_rebuilt"] for row in rows)))
    assert spent[1][0] < 0.85 * spent[0][0] and spent[1][1] <= spent[0][1]


# --- whole replays ------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["icc", "ilu", "gamg"])
def test_a_forced_preconditioner_has_parity(tmp_path, command, kind):
    scene, script = write_scene(tmp_path, plate(0.07)), write_script(tmp_path, EVENTS)
    PETSc.Options()["solid_pc_type"] = kind
    try:
        done = command("replay", scene, "--edits", script, "--parity", "--json", "a.json")
    finally:
        PETSc.Options().delValue("solid_pc_type")
    assert done.returncode == 0, done.stdout + done.stderr
    found = json.loads((tmp_path / "a.json").read_text())
    assert found["parity"]["holds"] and list(found["preconditioners"]) == [kind]


def test_two_ranks_choose_alike_and_twice_the_same(tmp_path, on_ranks):
    scene, script = write_scene(tmp_path, plate(0.07)), write_script(tmp_path, EVENTS)
    found = []
    for name, more in (("a", ("--parity", "--json", "a.json")), ("b", ())):
        done = on_ranks(2, "replay", scene, "--edits", script, "--csv", f"{name}.csv", *more)
        assert done.returncode == 0, done.stdout + done.stderr
        lines = (tmp_path / f"{name}.csv").read_text().splitlines()
        head = lines[0].split(",")
        keep = [k for k, column in enumerate(head) if not column.startswith("ms")]
        found.append([[line.split(",")[k] for k in keep] for line in lines])
    assert found[0] == found[1]
    assert json.loads((tmp_path / "a.json").read_text())["parity"]["holds"]


@pytest.mark.slow
def test_the_choice_is_reported(tmp_path, command):
    scene, script = write_scene(tmp_path, plate(0.07)), write_script(tmp_path, EVENTS)
    reported = {}
    for memory in ("4e9", "1e5"):
        words = ("replay", scene, "--edits", script, "--json", "a.json", "--set", f"solve.factor_memory={memory}")
        done = command(*words, "--parity")
        assert done.returncode == 0, done.stdout + done.stderr
        reported[memory] = json.loads((tmp_path / "a.json").read_text())["preconditioners"]
    assert list(reported["4e9"]) == ["cholesky"]
    assert "cholesky" not in reported["1e5"]
