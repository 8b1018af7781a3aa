"""A preconditioner that costs more by counted work than another one is expected to is left, by rent or buy."""

import json
from dataclasses import replace
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
from petsc4py import PETSc

from restshape.algebra.linear import LinearSolver
from restshape.algebra.reuse.candidates import CHOLESKY
from restshape.algebra.reuse.outlay import FEW, Outlay, Rival
from restshape.algebra.reuse.prices import Size
from restshape.algebra.reuse.traits import Traits
from restshape.algebra.stages import Stages
from restshape.calibration import Calibration
from restshape.replay.loop import Replay
from restshape.replay.request import Request
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

VIBRATION = Path(__file__).parents[2] / "apps" / "vibration"
NOMINAL = Calibration.load()


@pytest.mark.parametrize("seed", range(6))
def test_what_is_left_has_cost_no_more_than_its_rival_and_a_set_up(seed):
    rng = np.random.default_rng(seed)
    cost, setup = rng.uniform(0.5, 2.0), rng.uniform(5.0, 50.0)
    outlay, each = Outlay(), rng.uniform(0.0, 4.0 * cost, 400)
    outlay.begin(Rival(CHOLESKY, cost, setup))
    left = None
    for k, seconds in enumerate(each):
        if outlay.exceeded:
            left = k
            break
        outlay.solve(seconds)
    assert left is not None and left >= FEW
    # Rented so far for a set-up more than the rival's solves: all in all no more than twice buying at once.
    spent = each[:left].sum()
    assert spent <= setup + left * cost + each[left - 1]
    assert spent + setup <= 2.0 * (setup + left * cost) + each[left - 1]


def test_what_costs_less_than_its_rival_stays():
    outlay = Outlay()
    outlay.begin(Rival(CHOLESKY, 1.0, 3.0))
    for _ in range(1000):
        outlay.solve(0.9)
        assert not outlay.exceeded
    # One refresh a solve: that is part of what it costs.
    for _ in range(1000):
        outlay.refresh(1.0)
        outlay.solve(0.9)
    assert outlay.exceeded


def test_what_has_no_rival_stays():
    outlay = Outlay()
    for _ in range(2 * FEW):
        outlay.solve(1e9)
    assert not outlay.exceeded


@pytest.fixture(scope="module")
def frames(tmp_path_factory):
    """The first frames of the building, a step each, where a factor is dear: rows, with what they cost beyond it."""
    dear = replace(NOMINAL, numeric_work=150.0 * NOMINAL.numeric_work, numeric_nonzero=150.0 * NOMINAL.numeric_nonzero)
    one_step = ("effects.dynamics.steps=1", "solve.jumps=false")
    scene = load_scene(VIBRATION / "scenes" / "building.toml", one_step)
    path = tmp_path_factory.mktemp("outlay") / "idle.jsonl"
    head = {"format": "restshape-edits", "version": 1, "scene": "building.toml", "units": "m"}
    idle = {"t": 0.0, "do": "idle", "frames": 40}
    path.write_text(f"{json.dumps(head)}\n{json.dumps(idle)}\n", encoding="utf-8")
    script = load_script(path, scene)
    replay = Replay(Request.of(scene, script, "auto", calibration=dear), PETSc.COMM_SELF)
    replay.errors.estimating = replay.errors.measuring = False
    choice, rows = replay.analysis.solver.kept.choice, []
    for row in islice(replay.frames(), 40):
        outlay = choice.outlay
        _, cost, setup = outlay.rival or Rival(CHOLESKY, 0.0, 0.0)
        rows.append({**row, "beyond": outlay.spent - outlay.solves * cost, "setup": setup})
    return rows


def test_multigrid_that_takes_more_iterations_than_its_prior_is_left_within_a_mesh(frames):
    """Second-order triangles in motion: 8 iterations are expected, and 27 to 41 come."""
    rows = frames
    names = [row["preconditioner"] for row in rows[1:]]
    changed = names.index("cholesky")
    assert FEW < changed < len(names) - 1
    assert set(names[:changed]) == {"gamg"} and set(names[changed:]) == {"cholesky"}
    assert all(row["level"] == 0 for row in rows[1:])
    assert max(row["iterations"] for row in rows[changed + 1 :]) <= 2 < 20 < rows[changed]["iterations"]


def test_it_is_left_as_soon_as_another_one_would_have_paid(frames):
    changed = [row["preconditioner"] for row in frames].index("cholesky", 1)
    before, last = frames[changed - 2], frames[changed - 1]
    assert before["beyond"] < before["setup"] == last["setup"] <= last["beyond"]


def test_what_comes_in_place_of_a_failed_one_has_an_account_of_its_own():
    """Without a rival that has failed: one that is left for costing too much never goes to that."""
    solver = LinearSolver(PETSc.COMM_SELF, "outlay_", "auto", 1e-6, NOMINAL, Stages(), traits=Traits())
    kept, choice = solver.kept, solver.kept.choice
    kept.size = Size(1_000_000, 13_800_000.0, 2)
    choice.memory = 0.0
    kept.begin_system()
    while True:
        failed = kept.candidate
        choice.outlay.solve(1e9)
        if not kept.replace_failed():
            break
        assert (choice.outlay.solves, choice.outlay.spent) == (0, 0.0)
        rival = choice.outlay.rival
        assert kept.candidate is not failed
        assert rival is None or rival.candidate not in (kept.candidate, failed)
        assert rival is None or rival.candidate.name not in choice.excluded
    assert len(choice.excluded) > 1
