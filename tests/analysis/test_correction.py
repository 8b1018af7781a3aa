"""Corrections by conjugate gradients, whose preconditioner may be a poor one, against complete factors."""

import json
from pathlib import Path

import numpy as np
import pytest
from counted_replays import begin_log
from petsc4py import PETSc
from rank_threads import Ranks
from scipy.sparse import diags
from scipy.sparse.linalg import splu
from small_scenes import across, drag, make_replay, write_scene, write_script

from restshape.analysis.correction import DELAY, MOST, RowOperation, conjugate_steps, largest_values
from restshape.analysis.time_error import StepMatrix
from restshape.replay.event_counts import EventCounts

BUILDING = Path(__file__).parents[1] / "scenes" / "building.toml"
COARSE = ("mesh.size=0.8", "effects.dynamics.steps=10")
MOVED = [{"do": "idle", "frames": 3}, *drag("right_top", (5.7, 16.6), across((5.7, 16.6), (5.7, 16.0), 4))]


def directly(analysis, rest):
    """The solution of the step's own equations by a complete factor, as `conjugate_steps` is asked for it."""
    stiffness, mass, damping = analysis.matrices()
    newmark, free = analysis.state.integration.scheme, ~analysis.body.constrained.ravel()
    found = np.zeros_like(rest)
    found[free] = splu((stiffness + newmark.a0 * mass + newmark.a1 * damping).tocsc()).solve(rest[free])
    return found


@pytest.mark.slow
@pytest.mark.parametrize("policy", ["auto", "thesis"])
def test_error_of_a_time_step_with_an_incomplete_factor(tmp_path, monkeypatch, policy):
    replay = make_replay(BUILDING, write_script(tmp_path, MOVED), policy, COARSE)
    ratios = []
    for row in replay.frames():
        if row["index"]:
            with monkeypatch.context() as changed:
                changed.setattr(StepMatrix, "solve", lambda _, rest: directly(replay.analysis, rest))
                ratios.append(row["estimate_time"] / replay.analysis.errors()["estimate_time"])
    assert len(ratios) == 9
    np.testing.assert_allclose(ratios, 1.0, atol=0.02)


@pytest.mark.parametrize("steps, applied, products", [(20, 1, 1), (1, 3, 4)])
def test_the_error_of_a_time_step_costs_a_solve_with_the_kept_factor(tmp_path, steps, applied, products):
    """One application where the factor is that of the step's matrix, three where it is an old one; and one product."""
    begin_log()
    overrides = ["mesh.size=0.8", f"effects.dynamics.steps={steps}", "solve.jumps=false"]
    replay = make_replay(BUILDING, write_script(tmp_path, MOVED), "auto", overrides)
    counts, moved = EventCounts(("PCApply", "MatMult")), 0
    for row in replay.frames():
        counts.since_last()
        replay.analysis.errors()
        spent = counts.since_last()
        if row["level"] == 1:
            moved += 1
            assert spent["PCApply"] <= applied and spent["MatMult"] <= products
    assert moved >= 2


@pytest.mark.slow
@pytest.mark.mpi
def test_two_ranks_report_the_error_of_time_steps_that_one_reports(tmp_path, on_ranks):
    script, found = write_script(tmp_path, MOVED), []
    for ranks in (1, 2):
        words = ("--edits", script, "--policy", "thesis", "--json", f"{ranks}.json")
        done = on_ranks(ranks, "replay", BUILDING, *words, *(word for one in COARSE for word in ("--set", one)))
        assert done.returncode == 0, done.stdout + done.stderr
        found.append(json.loads((tmp_path / f"{ranks}.json").read_text())["estimate_time"])
    assert found[1] == pytest.approx(found[0], rel=0.05)


def test_steps_that_gain_little_for_a_while_do_not_end_it():
    """Part of the way lies in directions that the first steps hardly see: it is gone all the same."""
    values = np.concatenate([np.linspace(1.0, 2.0, 80), [1e-3, 2e-3]])
    rest = np.concatenate([np.ones(80), [1e-1, 1e-1]])
    taken = []

    def product(d):
        taken.append(d)
        return values * d

    found = conjugate_steps(product, lambda r: r, rest)
    wrong, exact = found - rest / values, rest / values
    assert wrong @ (values * wrong) < 1e-4 * (exact @ (values * exact))
    assert DELAY < len(taken) < MOST


def test_a_complete_factor_takes_no_more_steps_than_the_delay_and_one():
    rng = np.random.default_rng(2)
    values, rest = rng.uniform(1.0, 1e6, 50), rng.standard_normal(50)
    matrix, taken = diags(values), []
    found = conjugate_steps(lambda d: taken.append(d) or matrix @ d, lambda r: r / values, rest)
    np.testing.assert_allclose(found, rest / values, rtol=1e-10)
    assert len(taken) <= DELAY + 1


def test_steps_that_are_not_enough_give_no_number():
    values = np.logspace(0, 12, 500)
    found = conjugate_steps(lambda d: values * d, lambda r: r, np.ones(500))
    assert np.isnan(found).all()
    assert np.isnan(largest_values(np.full((3, 3), np.nan), np.eye(3), 2)).tolist() == [True, True]


def test_the_last_step_without_a_delay_is_no_step_uphill():
    """A preconditioner that is not definite may give a negative weight, which is small as well."""
    values, signs = np.array([1.0, 4.0]), np.array([1.0, -0.25])
    found = conjugate_steps(lambda d: values * d, lambda r: signs * r, np.array([1.0, 0.1]), delay=0)
    first = np.array([1.0, -0.025])
    weight, stiffness = 1.0 - 0.0025, 1.0 + 4.0 * 0.025**2
    np.testing.assert_allclose(found, weight / stiffness * first)


def test_ranks_take_the_steps_of_their_own_rows():
    """Of operations whose rows ranks share: the same solution, whole on each rank, and no whole array on the way."""
    rng = np.random.default_rng(3)
    values, rest = rng.uniform(1.0, 50.0, 30), rng.standard_normal(30)
    whole = conjugate_steps(lambda d: values * d, lambda r: r, rest)

    class Own(RowOperation):
        def __init__(self, comm, factors):
            super().__init__(None, slice(15 * comm.rank, 15 * comm.rank + 15), comm)
            self.factors = factors

        def own(self, r, n):
            assert len(r) == 15 and n == 30
            return self.factors[self.rows] * r

    each = Ranks(2).run(lambda comm: conjugate_steps(Own(comm, values), Own(comm, np.ones(30)), rest))
    np.testing.assert_array_equal(*each)
    np.testing.assert_allclose(each[0], whole, rtol=1e-10)


def test_products_with_petsc_stay_what_they_are():
    """A later product uses the same vectors, and changes neither an earlier one nor what either is of."""
    rng = np.random.default_rng(1)
    dense, once, again = rng.standard_normal((5, 5)), np.arange(5.0), rng.standard_normal(5)
    matrix = PETSc.Mat().createDense((5, 5), array=dense, comm=PETSc.COMM_SELF)
    product = RowOperation(matrix.mult, slice(0, 5), PETSc.COMM_SELF)
    products = [product(once), product(again), product(once)]
    np.testing.assert_allclose(products, [dense @ once, dense @ again, dense @ once], atol=1e-14)
    assert once.tolist() == [0.0, 1.0, 2.0, 3.0, 4.0]


STIFF_INSIDE = """format = "restshape-scene"
version = 1
app = "moving"

[shape]
outline = ["e1", "e2", "e3"]
vertices = { p1 = [0.5, 0.0], p2 = [-0.25, 0.433], p3 = [-0.25, -0.433] }
edges = { e1 = { line = ["p1", "p2"] }, e2 = { line = ["p2", "p3"] }, e3 = { line = ["p3", "p1"] } }
regions = { patch = { polygon = [[0.06, -0.06], [0.18, -0.06], [0.18, 0.06], [0.06, 0.06]] } }
points = { probe = [0.0, 0.15] }

[material]
m = { E = 1e6, nu = 0.3, rho = 1000, thickness = 0.01 }
inner = { E = 210e9, nu = 0.3, rho = 1000, thickness = 0.01, region = ["patch"] }

[effects]
solid = { model = "plane_stress" }
large_deformation = {}
dynamics = { time_step = 0.01, steps = 1 }
ground = { displacement = 0.1, frequency = 2.0 }
damping = { beta = 0.1 }

[supports.s]
on = "e1"
fix = ["x", "y"]

[mesh]
size = 0.5
order = 1

[solve]
tolerance = 1e-3
"""


def test_a_new_mesh_on_which_nothing_had_to_be_solved_for(tmp_path, monkeypatch):
    """No step has asked for a preconditioner on it: the error is reported all the same."""
    script = write_script(tmp_path, drag("p1", (0.5, 0.0), [(0.5, 0.008)])[:2])
    replay = make_replay(write_scene(tmp_path, STIFF_INSIDE), script, "rebuild")
    unsolved = 0
    for row in replay.frames():
        if row["index"] and row["level"] == 3 and not row["iterations"]:
            unsolved += 1
            with monkeypatch.context() as changed:
                changed.setattr(StepMatrix, "solve", lambda _, rest: directly(replay.analysis, rest))
                right = replay.analysis.errors()["estimate_time"]
            assert row["estimate_time"] == pytest.approx(right, rel=0.02)
    assert unsolved == 1


def test_steps_go_on_from_a_new_mesh_on_which_nothing_had_to_be_solved_for(tmp_path):
    """The solver meets that mesh at the first step that asks for it, some frames later."""
    events = [*drag("p1", (0.5, 0.0), [(0.5, 0.008)])[:2], {"do": "idle", "frames": 12}]
    replay = make_replay(write_scene(tmp_path, STIFF_INSIDE), write_script(tmp_path, events), "rebuild")
    rows = list(replay.frames())
    assert len(rows) == 15 and not any(row["refused"] for row in rows)
    assert all(row["residual"] <= 1e-3 for row in rows if row["newton"])
