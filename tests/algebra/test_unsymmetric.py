"""Systems that are not symmetric: what they are solved by, and what becomes of a zero pivot."""

import logging

import numpy as np
import pytest
from petsc4py import PETSc

from restshape.algebra.krylov_method import set_krylov, solve_from
from restshape.algebra.linear import METHODS, NO_EXCHANGED, LinearSolver
from restshape.algebra.reuse.candidates import FLOW_IN_TIME, STEADY_FLOW, candidates
from restshape.algebra.reuse.choice import LESS, PATIENCE, Choice
from restshape.algebra.reuse.prices import Size
from restshape.algebra.reuse.refresh import RefreshCriterion
from restshape.algebra.reuse.traits import Traits
from restshape.algebra.stages import Stages
from restshape.calibration import Calibration
from restshape.errors import ReplayProblem

STEADY = Traits(False, False, 3, rigid_motions=False)
IN_TIME = Traits(False, False, 3, rigid_motions=False, rate=True)
NODES = 30


def solver(method: str, traits: Traits = STEADY, prefix: str = "unsymmetric_") -> LinearSolver:
    return LinearSolver(PETSc.COMM_SELF, prefix, method, 1e-9, Calibration.load(), Stages(), traits=traits)


def dense(seed: int = 1, nodes: int = NODES) -> np.ndarray:
    """A chain of nodes of three unknowns, dominated by its diagonal, with convection that is not symmetric."""
    rng = np.random.default_rng(seed)
    full = np.kron(np.eye(nodes), rng.uniform(-1, 1, (3, 3)) + 6.0 * np.eye(3))
    for k in (1, 5):
        full += np.kron(np.eye(nodes, k=k), rng.uniform(-1, 1, (3, 3))) + 0.5 * np.kron(
            np.eye(nodes, k=-k), rng.uniform(-1, 1, (3, 3))
        )
    return full


def petsc(full: np.ndarray, blocks: bool = True) -> PETSc.Mat:
    """As PETSc's, in blocks of three or by points, every diagonal entry stored."""
    at = PETSc.Mat().createDense(full.shape, array=full.copy(), comm=PETSc.COMM_SELF)
    at.setBlockSize(3)
    stored = np.abs(full) + np.eye(len(full)) > 0.0
    start = np.concatenate([[0], np.cumsum(stored.sum(1))]).astype(PETSc.IntType)
    columns = np.nonzero(stored)[1].astype(PETSc.IntType)
    mat = PETSc.Mat().createAIJ(full.shape, bsize=3, csr=(start, columns, full[stored]), comm=PETSc.COMM_SELF)
    return mat.convert("seqbaij") if blocks else mat


def solved(one: LinearSolver, full: np.ndarray, blocks: bool = True) -> float:
    """The residual that a solve leaves, over the right side."""
    mat = petsc(full, blocks)
    b, x = mat.createVecLeft(), mat.createVecRight()
    b.array = np.arange(len(full)) % 7 - 3.0
    x.set(0.0)
    one.solve(mat, b, x, True)
    return float(np.linalg.norm(full @ x.array - b.array) / b.norm())


def flow_size(unknowns: int) -> Size:
    return Size(unknowns, 20.4 * unknowns, 2, 1, 3, True)


def test_flows_have_candidates_and_bodies_under_pressure_none():
    assert candidates(STEADY) is STEADY_FLOW and candidates(IN_TIME) is FLOW_IN_TIME
    assert candidates(Traits(symmetric=False)) == ()
    names = [one.name for one in STEADY_FLOW]
    assert names == [one.name for one in FLOW_IN_TIME] and {"lu", "ilu(0)", "ilu(2)", "bicgstab+ilu(1)"} <= set(names)


def test_flows_in_time_take_other_incomplete_factors_than_steady_ones():
    steady, in_time = (Choice(Calibration.load(), 1e6, traits) for traits in (STEADY, IN_TIME))
    assert [one(flow_size(3_000)).name for one in (in_time, steady)] == ["ilu(1)", "ilu(2)"]
    assert [one(flow_size(100_000)).name for one in (in_time, steady)] == ["ilu(2)", "bicgstab+ilu(2)"]
    for traits in (STEADY, IN_TIME):
        assert Choice(Calibration.load(), traits=traits)(flow_size(30_000)).name == "lu"


def test_a_factor_too_large_for_memory_is_left_out():
    assert not Choice(Calibration.load(), memory=1e6, traits=STEADY)(flow_size(30_000)).complete


def test_what_is_counted_changes_the_candidate_at_a_refresh_but_not_at_once():
    choice, size = Choice(Calibration.load(), traits=IN_TIME), flow_size(3_000)
    first = choice(size)
    for _ in range(PATIENCE - 1):
        choice.count(first, size, 3, 60)
        assert choice.again(size, first) is first
    choice.count(first, size, 3, 60)
    second = choice.again(size, first)
    assert second is not first and choice.cost(second, size) < LESS * choice.cost(first, size)


def test_many_iterations_ask_for_short_recurrences():
    choice, size = Choice(Calibration.load(), traits=STEADY), flow_size(100_000)
    long, short = (next(one for one in STEADY_FLOW if one.name == name) for name in ("ilu(0)", "bicgstab+ilu(0)"))
    assert choice.expected(long, size)[0] > 200 and choice.cost(short, size) < choice.cost(long, size)
    size = flow_size(300)
    assert choice.expected(long, size)[0] < 20 and choice.cost(short, size) > choice.cost(long, size)


@pytest.mark.parametrize("blocks", [True, False])
@pytest.mark.parametrize("name", [one.name for one in STEADY_FLOW])
def test_each_candidate_solves(name, blocks):
    one = solver("auto")
    for other in STEADY_FLOW:
        if other.name != name:
            one.kept.choice.exclude(other)
    assert solved(one, dense(), blocks) < 1e-9 and one.name == name
    assert one.ksp.getType() == ("bcgs" if name.startswith("bicgstab") else "fgmres")


def test_the_thesis_solves_by_bicgstab_and_ilu_without_fill():
    one = solver("ilu")
    assert solved(one, dense()) < 1e-9 and one.name == "bicgstab+ilu(0)"
    assert (one.ksp.getType(), one.ksp.getPC().getType()) == ("bcgs", "ilu")
    assert one.ksp.getPC().getFactorMatrix().getInfo()["nz_used"] == petsc(dense()).getInfo()["nz_used"]


def test_options_go_first():
    options = PETSc.Options("named_")
    for key, value in (("ksp_type", "gcr"), ("pc_type", "sor")):
        options.setValue(key, value)
    try:
        # By points: PETSc's blocks have relaxation for solves of one vector alone.
        one = solver("auto", prefix="named_")
        assert solved(one, dense(), blocks=False) < 1e-8
        assert (one.ksp.getType(), one.ksp.getPC().getType(), one.name) == ("gcr", "sor", "sor")
        options.delValue("pc_type")
        options.setValue("ksp_type", "bcgs")
        one = solver("auto", prefix="named_")
        assert solved(one, dense()) < 1e-9 and one.ksp.getType() == "bcgs" and one.name.startswith("bicgstab")
        one = solver("ilu", prefix="named_")
        options.setValue("ksp_type", "gmres")
        one = solver("ilu", prefix="named_")
        assert solved(one, dense()) < 1e-9 and one.ksp.getType() == "gmres"
    finally:
        for key in ("ksp_type", "pc_type"):
            options.delValue(key)


def test_bicgstab_forgets_the_guess_of_another_solve():
    """PETSc's own would add it."""
    full = dense()
    mat, ksp = petsc(full), PETSc.KSP().create(PETSc.COMM_SELF)
    set_krylov(ksp, "bcgs")
    ksp.getPC().setType("ilu")
    ksp.setOperators(mat)
    ksp.setTolerances(rtol=1e-9)
    b, x = mat.createVecLeft(), mat.createVecRight()
    b.array = np.arange(len(full)) % 5 - 2.0
    for guess in (3.0, 0.0):
        x.set(guess)
        solve_from(ksp, b, x)
        assert np.linalg.norm(full @ x.array - b.array) < 1e-8 * b.norm()
    assert ksp.getTolerances()[:2] == (1e-9, 1e-50)


def zero_pivot(nodes: int = NODES) -> np.ndarray:
    """A regular matrix whose elimination meets a zero in any order of the nodes: each node's own block is zero."""
    full = dense(nodes=nodes)
    for k in range(nodes):
        full[3 * k : 3 * k + 3, 3 * k : 3 * k + 3] = 0.0
    # In pairs that are large, each the other's.
    for k in range(0, nodes, 2):
        full[3 * k : 3 * k + 3, 3 * k + 3 : 3 * k + 6] += 30.0 * np.eye(3)
        full[3 * k + 3 : 3 * k + 6, 3 * k : 3 * k + 3] += 30.0 * np.eye(3)
    return full


@pytest.mark.parametrize("blocks", [True, False])
@pytest.mark.parametrize("method", METHODS)
def test_a_zero_pivot_is_said_and_rows_are_exchanged(method, blocks, caplog):
    one = solver(method)
    with caplog.at_level(logging.WARNING, "restshape.algebra"):
        assert solved(one, zero_pivot(), blocks) < 1e-8
    (first, *_), said = [record.getMessage() for record in caplog.records], one.name
    assert "a zero pivot with " in first and "exchanges no rows" in first and first.endswith(" takes its place")
    assert said == "lu, rows exchanged" and one.ksp.getPC().getFactorMatrix().getType() == "mumps"
    assert one.ksp.getType() != "bcgs" or method == "ilu"


def tiny_pivot() -> np.ndarray:
    """The same with pivots that are not quite zero: without exchanges of rows, rounding takes over."""
    full = zero_pivot()
    for k in range(NODES):
        full[3 * k : 3 * k + 3, 3 * k : 3 * k + 3] = 1e-17 * np.eye(3)
    return full


@pytest.mark.parametrize("method", ["direct", "stale", "auto"])
def test_pivots_near_zero_are_not_trusted(method, caplog):
    one, full = solver(method), tiny_pivot()
    with caplog.at_level(logging.WARNING, "restshape.algebra"):
        assert all(solved(one, full) < 1e-8 for _ in range(2))
    assert "pivots near zero" in caplog.text or "no solution" in caplog.text
    assert one.kept.exchanges or not one.kept.complete


def test_where_single_precision_is_not_enough_double_takes_its_place(caplog):
    """Pivots so small have inverses that no number of single precision can hold."""
    one, full = solver("auto"), 1e-42 * dense()
    for other in STEADY_FLOW:
        if other.name != "lu":
            one.kept.choice.exclude(other)
    with caplog.at_level(logging.INFO, "restshape.algebra"):
        assert solved(one, full) < 1e-8
    assert "substitutions of double precision" in caplog.text and one.name == "lu" and not one.kept.rounded
    assert solved(one, dense()) < 1e-9 and one.kept.rounded, "another mesh is tried in single precision again"


@pytest.mark.parametrize("method", METHODS)
def test_a_matrix_without_any_factor_says_what_to_look_at(method):
    full = dense()
    full[:, 4] = full[4] = 0.0
    with pytest.raises(ReplayProblem) as raised:
        solved(solver(method), full)
    assert str(raised.value) == NO_EXCHANGED


def test_solves_that_ask_for_more_are_expected_to_take_more():
    refresh = RefreshCriterion(1000)
    refresh.restart()
    refresh.weight, refresh.uses = 2.0, 0
    refresh.count(10, True, False)
    refresh.weight, refresh.uses = 4.0, 2
    refresh.count(21, False, False)
    assert refresh.last_extra == pytest.approx(1.0)
