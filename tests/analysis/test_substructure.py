"""A part of a body that alone changes, with the rest condensed onto its border: equal to the whole, and less work."""

import logging

import numpy as np
import pytest
import scipy.sparse as sp
from small_scenes import (
    CLAMPED,
    HEAD,
    HOLE,
    PULLED,
    QUANTITIES,
    STEEL,
    across,
    block,
    drag,
    make_replay,
    meshed,
    write_scene,
    write_script,
)

from restshape.algebra.factors import condensation
from restshape.analysis.static import border_quantities
from restshape.errors import ReplayProblem
from restshape.fem.derivative import Derivative, Differentiable
from restshape.replay.parity import Parity

TIGHT = "[solve]\ntolerance = 1e-12\n"
PLATE = HEAD + block(2.0, 1.0) + HOLE + STEEL + CLAMPED + PULLED
WINDOW = drag("window", (0.5, 0.5), across((0.5, 0.5), (0.56, 0.53), 4))
CORNER = drag("c", (2.0, 1.0), across((2.0, 1.0), (2.06, 1.02), 3))
PUSHED = '[loads.top]\non = "top"\nforce = [1e4, -2e4]\n[loads.own]\non = "all"\nbody = ["1e6*x", "1e6*y"]\n'
PULLED_ON = '[supports.end]\non = "right"\nfix = { x = "1e-3*y" }\n'


def replay(folder, text, events, *overrides, predict="none"):
    return make_replay(write_scene(folder, text), write_script(folder, events), overrides=overrides, predict=predict)


def alone(made):
    """Whether the last frame was solved for its moving part alone."""
    return made.analysis.parts.solved is made.analysis.state


@pytest.mark.parametrize(
    ("text", "events"),
    [
        (PLATE + meshed(0.12), WINDOW),
        (PLATE + meshed(0.2, 2), WINDOW),
        (PLATE + PUSHED + meshed(0.12), WINDOW),
        (PLATE + PULLED_ON + meshed(0.12), CORNER),
    ],
    ids=["hole", "second order", "loads on both parts", "supports on both parts"],
)
def test_condensed_equals_whole(tmp_path, text, events):
    made, count = replay(tmp_path, text + "reach = 0.12\n" + TIGHT, events), 0
    for row in made.frames():
        analysis = made.analysis
        if row["level"] == 1:
            assert alone(made)
            cold = analysis.cold_unknowns()
            np.testing.assert_allclose(analysis.x, cold, rtol=0, atol=1e-10 * np.abs(cold).max())
            assert row["residual"] < 1e-12
            count += 1
    assert count >= 3


def test_reuse_equals_rebuild_on_all_levels(tmp_path):
    made = replay(
        tmp_path,
        PLATE + meshed(0.1) + "reach = 0.15\n" + QUANTITIES,
        drag("window", (0.5, 0.5), across((0.5, 0.5), (0.72, 0.5), 15)),
    )
    check, levels = Parity(made), set()
    for row in made.frames():
        check()
        levels.add((row["level"], alone(made)))
    assert check.summary()["holds"]
    assert {(1, True), (2, True), (3, False)} <= levels


def test_flips_and_moves_stay_in_the_part(tmp_path):
    made = replay(
        tmp_path,
        PLATE + meshed(0.1) + "reach = 0.15\n",
        drag("window", (0.5, 0.5), across((0.5, 0.5), (0.72, 0.5), 15)),
    )
    before, flips = None, 0
    for row in made.frames():
        mesh, part = made.moving.mesh, made.moving.part
        if row["level"] in (1, 2) and before is not None and before[0] is mesh:
            stays = np.setdiff1d(np.arange(len(mesh.X)), part.nodes)
            np.testing.assert_array_equal(mesh.X[stays], before[1][stays])
            others = np.setdiff1d(np.arange(len(mesh.cells)), part.cells)
            np.testing.assert_array_equal(mesh.cells[others], before[2][others])
            flips += row["flips"]
        before = mesh, mesh.X.copy(), mesh.cells.copy()
    assert flips


def test_quantities_at_few_nodes_are_those_of_the_whole(tmp_path):
    local = '[quantities]\nstretch = { displacement = "x", at = "right", reduce = "mean" }\n'
    local += 'wall = { reaction = "x", at = "left" }\n'
    local += 'hole = { displacement = "magnitude", at = "window", reduce = "max" }\n'
    # The length of a mean is not linear, nor is the largest value; energies hang on all.
    local += 'bend = { displacement = "magnitude", at = "right", reduce = "mean" }\n'
    local += 'far = { displacement = "y", at = "right", reduce = "max" }\nenergy = { energy = "strain" }\n'
    made = replay(tmp_path, PLATE + meshed(0.12) + "reach = 0.12\n" + TIGHT + local, WINDOW)
    for row in made.frames():
        if row["level"] == 1:
            whole = made.analysis.state.observer(made.analysis.cold_unknowns())
            for name in whole:
                assert row[f"q_{name}"] == pytest.approx(whole[name], rel=1e-9)
            known, _ = made.analysis.parts.found._quantities
            assert set(known.values) == {"stretch", "wall"}


def test_rest_is_found_when_it_is_asked_for(tmp_path, monkeypatch):
    calls, counts = [], []
    solve = condensation.NodeFactor.__call__
    monkeypatch.setattr(condensation.NodeFactor, "__call__", lambda self, force: calls.append(1) or solve(self, force))
    made = replay(tmp_path, PLATE + meshed(0.12) + "reach = 0.12\n", WINDOW)
    made.errors.estimating = False
    for row in made.frames():
        if row["level"] == 1:
            counts.append(len(calls))
    # What loads do to the rest alone is found once.
    assert len(set(counts)) == 1 and len(calls) == counts[0]
    assert made.analysis.x.shape == made.moving.mesh.X.shape and len(calls) > counts[0]


def test_ways_of_a_drag_are_learned(tmp_path, monkeypatch):
    learned = []
    learn = condensation.Condensation._learn
    monkeypatch.setattr(condensation.Condensation, "_learn", lambda self, way: learned.append(1) or learn(self, way))
    there, back = across((0.5, 0.5), (0.54, 0.5), 8), across((0.54, 0.5), (0.5, 0.5), 8)
    text = PLATE + meshed(0.12) + "reach = 0.12\n" + QUANTITIES
    made = replay(tmp_path, text, drag("window", (0.5, 0.5), there + back))
    counts = [len(learned) for row in made.frames() if row["level"] == 1]
    assert 0 < counts[7] < 8 and counts[-1] <= counts[7] + 1


def test_more_ways_than_are_kept(tmp_path, monkeypatch):
    monkeypatch.setattr(condensation, "MOST_WAYS", 2)
    made = replay(tmp_path, PLATE + meshed(0.12) + "reach = 0.12\n" + TIGHT, WINDOW)
    for row in made.frames():
        if row["level"] == 1:
            cold = made.analysis.cold_unknowns()
            np.testing.assert_allclose(made.analysis.x, cold, rtol=0, atol=1e-10 * np.abs(cold).max())


def test_derivative_of_a_drag_with_a_reach(tmp_path):
    step = 1e-4
    events = drag("window", (0.5, 0.5), [(0.5 - step, 0.5), (0.5 + step, 0.5), (0.5, 0.5)])
    made, found = replay(tmp_path, PLATE + meshed(0.12) + "reach = 0.12\n" + TIGHT, events), []
    for row in made.frames():
        if row["level"] == 1:
            found.append(made.analysis.x.copy())
            if len(found) == 3:
                break
    derivative = made.analysis.predictor.derivative(made.moving.linear_motion, 1e-12)[0]
    wanted = (found[1] - found[0]) / (2.0 * step)
    np.testing.assert_allclose(derivative.reshape(wanted.shape), wanted, rtol=0, atol=1e-4 * np.abs(wanted).max())


def test_predicted_frames(tmp_path):
    made = replay(tmp_path, PLATE + meshed(0.12) + "reach = 0.12\n" + QUANTITIES, WINDOW, predict="linear")
    rows = list(made.frames())
    assert any(row["predicted"] for row in rows)
    # To first order in the hand, of which they know.
    assert all(0.0 < row["estimate"] < 0.05 for row in rows if row["predicted"])


@pytest.mark.parametrize(
    ("more", "why"),
    [
        ("[effects.large_deformation]\n", "not linear, symmetric and definite"),
        ("reach = 5\n", "the whole is solved for"),
    ],
)
def test_the_whole_is_solved_for_where_parts_cannot_be(tmp_path, caplog, more, why):
    reach = "" if more.startswith("reach") else "reach = 0.12\n"
    made = replay(tmp_path, PLATE + meshed(0.12) + reach + more, WINDOW)
    with caplog.at_level(logging.INFO, "restshape"):
        check = Parity(made)
        for _ in made.frames():
            check()
            assert not alone(made)
    assert check.summary()["holds"] and why in caplog.text


def test_new_values_in_a_drag_condense_again(tmp_path):
    edits = [*WINDOW[:2], {"do": "set", "key": "loads.pull.traction", "value": ["120 MPa", 0]}]
    edits += [{"do": "set", "key": "material.steel.E", "value": 100e9}, {"do": "release"}, *CORNER]
    made = replay(tmp_path, PLATE + meshed(0.12) + "reach = 0.12\n", edits)
    check = Parity(made)
    for _ in made.frames():
        check()
    assert check.summary()["holds"]


def test_the_matrix_of_the_whole_is_itself_again_where_nothing_could_be_condensed(tmp_path, monkeypatch):
    def refuse(*_):
        raise ReplayProblem("no factor")

    monkeypatch.setattr("restshape.analysis.static.substructure.Condensation", refuse)
    made = replay(tmp_path, PLATE + meshed(0.12) + "reach = 0.12\n" + TIGHT, WINDOW)
    levels = set()
    for row in made.frames():
        assert made.analysis.residual_norm() < 1e-12 and not alone(made)
        levels.add(row["level"])
    assert levels >= {0, 1}


def test_factors_of_parts_are_freed_with_their_owner():
    factor = condensation.NodeFactor(sp.identity(4, format="csr"), 2)
    assert factor(np.ones(4)) == pytest.approx(np.ones(4))
    held = factor._matrix, factor._pc
    del factor
    assert not any(held)


def test_a_quantity_with_no_slope_at_nothing_is_not_taken_for_a_linear_one():
    class Still:
        problem = None

        def stays(self):
            return np.ones(3, dtype=bool)

        def at_border(self):
            return np.zeros(2)

        def seen_from_border(self, load):
            return load[:2, 0]

    def quantity(derivative):
        return Differentiable(lambda x: 0.0, lambda x: Derivative(derivative(x)), lambda: np.arange(3))

    functions = {"sum": quantity(np.ones_like), "square": quantity(lambda x: 2.0 * x)}
    known = border_quantities.BorderQuantities(Still(), lambda: np.zeros((3, 1)), functions)
    assert set(known.values) == {"sum"}


def test_rest_without_support_has_no_factor():
    with pytest.raises(ReplayProblem, match="no factor"):
        condensation.Condensation(sp.csr_matrix(np.diag([0.0, 1.0, 1.0])), 1, 1)


@pytest.mark.mpi
def test_two_ranks_solve_for_the_whole(tmp_path, on_ranks):
    scene = write_scene(tmp_path, PLATE + meshed(0.2) + "reach = 0.1\n")
    script = write_script(tmp_path, WINDOW)
    done = on_ranks(2, "replay", scene, "--edits", script, "-v")
    assert done.returncode == 0 and "several ranks share it" in done.stdout + done.stderr
