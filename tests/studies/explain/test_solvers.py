"""The plan of solvers reports the truth: matrices are of the kind that it says, and PETSc does what it says, no more.

Held against the entries of the assembled matrices, their eigenvalues by LAPACK, PETSc's own types and event counts.
"""

import numpy as np
import pytest
from counted_replays import begin_log, counted, happened, watched
from petsc4py import PETSc
from small_scenes import (
    CLAMPED,
    HEAD,
    HOLE,
    PULLED,
    STEEL,
    across,
    block,
    drag,
    head,
    meshed,
    write_scene,
    write_script,
)

from restshape.algebra.factors.gathering import gather_matrix
from restshape.algebra.stages import log_stage
from restshape.application import application
from restshape.scene.load import load_scene
from restshape.scene.plan import as_written, plan
from restshape.scene.solver import DEFINITE, INDEFINITE, UNSYMMETRIC

BODY = block(2.0, 1.0) + HOLE + STEEL + CLAMPED
LARGE = "[effects.large_deformation]\n"
PRESSURE = '[loads.push]\non = "right"\npressure = "100 MPa"\n'
MOVES = '[effects.dynamics]\ntime_step = "1 ms"\nsteps = 2\n'
MODAL = BODY.partition("[effects")[0] + "[mesh]\nsize = 0.3\n[effects.modal]\nmodel = MODEL\nmodes = 3\n"

CASES = {
    "small": ("plane", BODY + PRESSURE + meshed(0.25), "linear", DEFINITE),
    "large": ("plane", BODY + LARGE + PULLED + meshed(0.25), "nonlinear", DEFINITE),
    "followed": ("plane", BODY + LARGE + PRESSURE + meshed(0.25), "nonlinear", UNSYMMETRIC),
    "moving": ("moving", BODY + MOVES + PRESSURE + meshed(0.25), "linear", DEFINITE),
    "moving large": ("moving", BODY + MOVES + LARGE + PULLED + meshed(0.25), "nonlinear", DEFINITE),
    "moving followed": ("moving", BODY + MOVES + LARGE + PRESSURE + meshed(0.25), "nonlinear", UNSYMMETRIC),
    "buckling": ("plane", BODY + "[effects.buckling]\n" + PRESSURE + meshed(0.25), "linear", DEFINITE),
    "plate": ("modes", MODAL.replace("MODEL", '"plate"'), "eigenvalues", INDEFINITE),
    "membrane": ("modes", MODAL.replace("MODEL", '"plane_stress"'), "eigenvalues", INDEFINITE),
}
KINDS = {"cholesky": "MatCholFctrNum", "lu": "MatLUFactorNum"}


@pytest.fixture(scope="module", autouse=True)
def _logged():
    begin_log()


def test_events_that_an_error_left_open_are_counted_again():
    stage, event = log_stage("krylov"), PETSc.Log.Event("EPSSolve")
    stage.push()
    for _ in range(2):
        event.begin()
    assert not counted(event, stage.id)
    stage.pop()
    begin_log()
    stage.push()
    assert counted(event, stage.id)
    stage.pop()


@pytest.mark.parametrize("name", list(CASES))
def test_solvers_are_those_of_the_plan(tmp_path, name):
    app, text, equations, matrix = CASES[name]
    path = write_scene(tmp_path, head(app) + text)
    planned = plan(load_scene(path), application(app)).solver
    first = planned.systems[0]
    assert (planned.equations, first.matrix) == (equations, matrix)
    assert planned.symmetric == (matrix != UNSYMMETRIC)
    script = write_script(tmp_path, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.54, 0.5), 2)))
    rows, replay = watched(path, script)
    assert not any(row["refused"] for row in rows)
    other = {"cholesky": "lu", "lu": "cholesky"}[first.factor]
    assert happened(rows, KINDS[first.factor]) > 0 == happened(rows, KINDS[other])
    assert (happened(rows, "SNESSolve") > 0) == (equations == "nonlinear")
    if first.krylov:
        static = replay.analysis.prebuckling if name == "buckling" else replay.analysis
        solver = static.solver
        assert solver.ksp.getType() == first.krylov and solver.kind == first.factor
        matrix = static.step_matrix() if "moving" in name else static.warm_system().matrix
        _holds_of(matrix.toarray(), first.matrix)
    else:
        stiffness, mass = (m.toarray() for m in replay.analysis.state.matrices.gather())
        _holds_of(stiffness - replay.analysis.solver.pencil.shift * mass, first.matrix)


def test_load_factors_come_from_an_indefinite_factor(tmp_path):
    path = write_scene(tmp_path, HEAD + CASES["buckling"][1])
    planned = plan(load_scene(path), application("plane")).solver
    assert [system.matrix for system in planned.systems] == [DEFINITE, INDEFINITE]
    _, replay = watched(path)
    pencil = replay.analysis.solver.pencil
    parts = (pencil.mass, pencil.stiffness)
    stiffness, geometric = (gather_matrix(part, PETSc.COMM_SELF).toarray() for part in parts)
    free = np.flatnonzero(replay.analysis.state.prebuckling.problem.boundary.mask.ravel() == 0)
    beyond = 1.01 * replay.analysis.load_factors[-1]
    _holds_of((stiffness + beyond * geometric)[np.ix_(free, free)], INDEFINITE)


def test_an_edit_that_would_call_for_another_solver_is_refused(tmp_path):
    followed = {"on": "right", "pressure": "-100 MPa"}
    script = write_script(
        tmp_path,
        [
            {"do": "set", "key": "loads.pull", "value": followed},
            {"do": "set", "key": "loads.pull.traction", "value": ["50 MPa", 0]},
        ],
    )
    path = write_scene(tmp_path, HEAD + CASES["large"][1] + '[quantities]\nx = { displacement = "x", at = "right" }\n')
    rows, _ = watched(path, script)
    assert "which pressures follow the boundary" in rows[1]["refused"] and rows[1]["stale"]
    assert not rows[2]["refused"] and rows[2]["q_x"] == pytest.approx(0.5 * rows[0]["q_x"], rel=1e-2)
    small = write_scene(tmp_path, HEAD + CASES["small"][1])
    pulled = write_script(
        tmp_path, [{"do": "set", "key": "loads.push", "value": {"on": "right", "traction": [1e6, 0]}}]
    )
    assert not any(row["refused"] for row in watched(small, pulled)[0])


@pytest.mark.parametrize(("order", "why"), [(None, "buckling asks for it"), (1, "the scene says so")])
def test_the_order_of_elements_has_its_reason(tmp_path, order, why):
    text = HEAD + BODY + "[effects.buckling]\n" + PRESSURE + meshed(0.25, order)
    planned = plan(as_written(load_scene(write_scene(tmp_path, text))), application("plane"))
    assert planned.order == (1 if order else 2) and planned.order_why.startswith(why)


def _holds_of(matrix, kind):
    """Holds a matrix against what it is said to be."""
    skew = np.abs(matrix - matrix.T).max() / np.abs(matrix).max()
    assert (skew > 1e-6) if kind == UNSYMMETRIC else (skew < 1e-12)
    if kind != UNSYMMETRIC:
        values = np.linalg.eigvalsh(matrix)
        assert values[-1] > 0.0
        assert (values[0] > 0.0) == (kind == DEFINITE)
