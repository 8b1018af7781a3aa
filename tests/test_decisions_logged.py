"""What is logged of each decision, and why it was made, agrees with what rows, matrices and PETSc say of it."""

import logging
import re

import numpy as np
import pytest
from modal import replay as replay_modes
from petsc4py import PETSc
from small_scenes import across, drag, make_replay, plate, rows_of, write_scene, write_script

from restshape.algebra.linear import LinearSolver
from restshape.algebra.reuse.candidates import CHOLESKY, GAMG
from restshape.algebra.reuse.choice import Choice
from restshape.algebra.reuse.prices import Size
from restshape.algebra.reuse.traits import Traits
from restshape.algebra.stages import Stages
from restshape.calibration import Calibration

MESH = re.compile(r"^ *(\d+) Mesh level (\d): (.+)$")
BAR = """{"format": "restshape-edits", "version": 1, "scene": "bar_100.toml", "units": "m"}
{"t": 0.0, "do": "press", "on": "c", "at": [0.1, 0.03]}
{"t": 0.1, "do": "drag", "path": [[0.1, 0.032], [0.1, 0.034], [0.1, 0.036], [0.1, 0.038], [0.1, 0.06], [0.1, 0.08]]}
{"t": 1.0, "do": "release"}
"""


@pytest.fixture
def logged(caplog):
    """What has been logged so far, each line once, by a function."""
    caplog.set_level(logging.DEBUG, "restshape")

    def lines() -> list[str]:
        found = [record.getMessage() for record in caplog.records]
        caplog.clear()
        return found

    return lines


def test_each_level_of_the_mesh_has_a_reason(tmp_path, logged):
    path = [*across((0.5, 0.5), (1.3, 0.5), 20), (1.3, 0.5)]
    events = [*drag("window", (0.5, 0.5), path), {"do": "set", "key": "material.steel.E", "value": "100 GPa"}]
    made = make_replay(write_scene(tmp_path, plate(0.15)), write_script(tmp_path, events))
    levels = {str(row["index"]): str(row["level"]) for row in rows_of(made)}
    found = [match.groups() for match in map(MESH.match, logged()) if match]
    assert {index: level for index, level, _ in found} == levels and len(found) == len(levels)
    reasons: dict[str, set[str]] = {}
    for _, level, reason in found:
        reasons.setdefault(level, set()).add(reason)
    assert {"the shape stays as it is", "values change, and the shape stays as it is"} <= reasons["0"]
    assert all("no invalid, no low-quality" in reason for reason in reasons["1"]) and {"2", "3"} & set(reasons)


def test_what_a_jump_of_the_mesh_costs_is_not_logged_as_the_frames_own(tmp_path, caplog):
    path = [*across((0.5, 0.5), (1.3, 0.5), 20), (1.3, 0.5)]
    scene = plate(0.15) + '[solve]\nestimate = "every"\n'
    made = make_replay(write_scene(tmp_path, scene), write_script(tmp_path, drag("window", (0.5, 0.5), path)))
    caplog.set_level(logging.INFO, "restshape")
    rows = rows_of(made)
    lines = [record.getMessage() for record in caplog.records]
    jumps = [line for line in lines if "Mesh jump: " in line]
    assert len(jumps) == sum(str(row["level"]) in "23" for row in rows) - 1 > 0
    assert sum("rebuilt: another system" in line for line in lines) <= sum(str(row["level"]) == "3" for row in rows)
    assert logging.getLogger("restshape").level == logging.INFO


REASONS = (
    ("auto", Traits(symmetric=False), None, "lu", "the matrices are not symmetric"),
    ("auto", Traits(definite=False), None, "cholesky", "symmetric and not definite"),
    ("direct", Traits(), None, "cholesky", "the policy solves by direct"),
    ("ilu", Traits(), None, "ilu(3)", "the policy solves by ilu"),
    ("auto", Traits(), "jacobi", "jacobi", "PETSc's options name it"),
)


@pytest.mark.parametrize(("method", "traits", "named", "kind", "why"), REASONS)
def test_a_preconditioner_without_a_choice_has_a_reason(logged, method, traits, named, kind, why):
    n = 12
    dense = 4.0 * np.eye(n) - np.eye(n, k=1) - (1.0 if traits.symmetric else 0.5) * np.eye(n, k=-1)
    mat = PETSc.Mat().createDense(dense.shape, array=dense, comm=PETSc.COMM_SELF)
    mat.convert("aij")
    mat.setOption(PETSc.Mat.Option.SYMMETRIC, traits.symmetric)
    b, x = mat.createVecLeft(), mat.createVecRight()
    b.set(1.0)
    options = PETSc.Options("reasons_")
    if named:
        options.setValue("pc_type", named)
    try:
        solver = LinearSolver(PETSc.COMM_SELF, "reasons_", method, 1e-9, Calibration.load(), Stages(), traits=traits)
        solver.solve(mat, b, x, True)
    finally:
        options.delValue("pc_type")
    assert solver.ksp.getPC().getType() == kind.partition("(")[0] and np.allclose(dense @ x.array, 1.0)
    first, rebuilt, *_ = logged()
    assert first.startswith(f"KSP reasons_ PC {kind}, without a choice: ") and why in first
    assert rebuilt == f"KSP reasons_ PC {kind} rebuilt: another system"


def test_what_is_left_out_of_a_choice_has_a_reason(logged):
    size = Size(2_000, 27_600.0)
    assert Choice(Calibration.load())(size) is CHOLESKY
    assert logged()[0].startswith("PC cholesky chosen for 2000 unknowns") and not logged()
    small = Choice(Calibration.load(), memory=2e5)
    small.exclude(GAMG)
    chosen = small(size)
    (line,) = logged()
    assert line.startswith(f"PC {chosen.name} chosen") and "gamg has failed" in line
    # By the prior measured on plates: 4.05 n^1.24 nonzeros of 12 bytes.
    needed = float(re.search(r"cholesky needs (\S+) bytes of 2e\+05", line)[1])
    assert needed == pytest.approx(12 * 4.05 * 2_000**1.24, rel=0.01)


def test_each_factor_of_an_eigenproblem_has_a_reason(tmp_path, logged):
    script = tmp_path / "bar.jsonl"
    script.write_text(BAR)
    run = replay_modes("bar_100.toml", script, ["mesh.layers=1", "mesh.size=0.02"])
    rebuilt, reasons = [], []
    for row in run.frames():
        found = [line for line in logged() if line.startswith("ST factor rebuilt at shift ")]
        rebuilt.append((row["index"], bool(found), bool(row["pc_rebuilt"])))
        reasons += [line.partition(": ")[2] for line in found]
    assert all(said == done for _, said, done in rebuilt) and not all(done for *_, done in rebuilt)
    assert reasons[0] == "Krylov-Schur, no modes to start from" and all(reasons)
