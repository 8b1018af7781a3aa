"""Modes under edit: reuse against cold solves, levels, supports, numbers, and what a user can get wrong."""

import numpy as np
import pytest
from modal import EDITS, SCENES, replay, solved

from restshape.analysis.modal import mode_search
from restshape.errors import UserError
from restshape.interface.first_frame import first_frame
from restshape.replay.parity import Parity

WILD = """{"format": "restshape-edits", "version": 1, "scene": "bar_100.toml", "units": "m"}
{"t": 0.0, "do": "press", "on": "c", "at": [0.1, 0.03]}
{"t": 0.1, "do": "drag", "path": [[0.1, 0.04], [0.1, 0.06], [0.11, 0.08], [0.09, 0.06], [0.05, 0.05], [0.1, 0.03]]}
{"t": 1.0, "do": "release"}
{"t": 1.1, "do": "hole", "name": "h", "center": [0.05, 0.015], "radius": 0.005}
{"t": 1.2, "do": "press", "on": "h", "at": [0.05, 0.015]}
{"t": 1.3, "do": "drag", "path": [[0.06, 0.018], [0.07, 0.02], [0.08, 0.015], [0.03, 0.015]]}
{"t": 1.4, "do": "release"}
{"t": 1.5, "do": "set", "key": "material.aluminium.thickness", "value": "5 mm"}
{"t": 1.6, "do": "undo"}
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "model"),
    [
        *(("auto", model) for model in ("solid 1", "solid 2", "plate", "plane_stress")),
        *(("thesis", model) for model in ("solid 1", "plate", "plane_stress")),
        pytest.param("thesis", "solid 2", marks=pytest.mark.weekly),
    ],
)
def test_wild_edit_agrees_with_cold_solves_on_the_same_meshes(tmp_path, model, name):
    edits = tmp_path / "wild.jsonl"
    edits.write_text(WILD)
    model, _, order = model.partition(" ")
    size = 30 if order == "2" else 12
    overrides = [f"effects.modal.model={model}", "effects.modal.modes=3", "mesh.layers=1", f'mesh.size="{size} mm"']
    run = replay("bar_100.toml", edits, [*overrides, f"mesh.order={order or 1}"], name)
    parity, levels = Parity(run), set()
    for row in run.frames():
        parity()
        levels.add(row["level"])
        assert not row["refused"]
        assert row["residual"] <= 1.001e-3
    assert levels >= {1, 3}
    assert parity.entries <= 1e-13
    # Frequencies are right to about the square of the residual's tolerance, subspaces to that of it over the gap.
    assert parity.solution <= (5e-3 if name == "thesis" else 1e-5)


PARAMETER = """{"format": "restshape-edits", "version": 1, "scene": "bar_100.toml"}
{"t": 0, "do": "set", "key": "parameters.a", "value": "75 mm", "frames": 14}
"""


@pytest.mark.slow
@pytest.mark.parametrize("model", ["plane_stress", "plate"])
def test_a_parameter_of_the_shape_may_flip_edges(tmp_path, model):
    # Values and pattern change in one frame: cells that are flipped in place are not those of the body before.
    edits = tmp_path / "wide.jsonl"
    edits.write_text(PARAMETER)
    hole = 'shape.holes.h={ circle = { center = ["a", "15 mm"], radius = "6 mm" } }'
    overrides = [f"effects.modal.model={model}", 'mesh.size="5 mm"', 'parameters={ a = "45 mm" }', hole]
    run = replay("bar_100.toml", edits, [*overrides, "effects.modal.modes=2", "solve.tolerance=1e-5"])
    parity, levels = Parity(run), set()
    for row in run.frames():
        assert not row["refused"]
        parity()
        levels.add(row["level"])
    assert 2 in levels and parity.entries <= 1e-13 and parity.solution <= 1e-4


@pytest.fixture(scope="module")
def dragged():
    """Rows of a bar that is dragged there and back, slowly."""
    return list(replay("bar_100.toml", EDITS / "bar_100.jsonl", ["mesh.layers=1"]).frames())


@pytest.mark.slow
def test_slow_drag_reuses_its_factor(dragged):
    rows = [row for row in dragged if row["level"] == 1]
    assert len(rows) == 120
    assert sum(row["pc_rebuilt"] for row in rows) < 12
    assert sum(row["iterations"] for row in rows) < 240
    assert sum(row["inertia_checked"] for row in rows) >= 5 and not any(row["missed_modes"] for row in rows)


@pytest.mark.slow
def test_bar_comes_back_to_its_first_tone(dragged):
    there = next(row for row in dragged if row["event"] == "release")
    assert there["f_1"] == pytest.approx(dragged[0]["f_1"], rel=1e-6)


@pytest.mark.slow
def test_predicted_frames_follow_the_solved_ones_to_first_order():
    overrides = ["effects.modal.model=plate", "effects.modal.modes=3"]
    solved_rows, predicted = (
        list(replay("bar_100.toml", EDITS / "bar_100.jsonl", overrides, predict=kind).frames())
        for kind in ("none", "linear")
    )
    shown = [(a, b) for a, b in zip(solved_rows, predicted) if b["predicted"]]
    assert len(shown) == 120 and all(b["iterations"] == 0 for _, b in shown)
    start = solved_rows[0]["f_1"]
    for exact, guess in shown[:6]:
        change = abs(exact["f_1"] - start)
        assert abs(guess["f_1"] - exact["f_1"]) < 0.1 * change
    assert predicted[-1]["f_1"] == pytest.approx(solved_rows[-1]["f_1"], rel=1e-6)


def test_modes_in_the_plane_are_left_out_unless_asked_for():
    overrides = ["effects.modal.modes=5", "mesh.order=2", "mesh.layers=1", 'mesh.size="15 mm"']
    out, all_modes = (
        first_frame(SCENES / "bar_200.toml", [*overrides, f"effects.modal.in_plane={flag}"]).analysis
        for flag in ("false", "true")
    )
    assert np.all(out.state.modes.participation[out.state.modes.chosen] > 0.95)
    inside = all_modes.state.modes.participation[all_modes.state.modes.chosen] < 0.05
    assert inside.sum() == 1
    # The bar's bending in its own plane, by p-FEM of 3D elasticity.
    assert all_modes.frequencies[inside][0] == pytest.approx(3648.2, rel=5e-3)


def test_undercut_lowers_a_bar_and_ends_made_thin_raise_it():
    plain, undercut, tapered = (
        solved("plate", f"material.aluminium.thickness='{h}'").frequencies[0]
        for h in ("4 mm", "0.004*(1 - 0.4*exp(-((x - 0.05)/0.02)^2))", "0.004*(1 - 0.4*(abs(x - 0.05)/0.05)^4)")
    )
    assert undercut < 0.95 * plain and tapered > 1.02 * plain


def test_thickness_of_a_formula_means_the_same_for_plates_and_solids():
    thickness = "material.aluminium.thickness='0.004*(1 - 0.4*exp(-((x - 0.05)/0.02)^2))'"
    fine = ['mesh.size="5 mm"', "effects.modal.modes=1", thickness]
    plate = first_frame(SCENES / "bar_100.toml", [*fine, "effects.modal.model=plate"]).analysis
    solid = first_frame(SCENES / "bar_100.toml", [*fine, "mesh.order=2", "mesh.layers=1"]).analysis
    assert plate.frequencies[0] == pytest.approx(solid.frequencies[0], rel=5e-3)


def test_thin_plate_does_not_lock():
    lambdas = []
    for h in (1e-2, 1e-4):
        overrides = [f"material.steel.thickness={10 * h}", "effects.modal.modes=1", "mesh.size=0.8"]
        lambdas.append(first_frame(SCENES / "square.toml", overrides).analysis.frequencies[0] / h)
    assert lambdas[0] == pytest.approx(lambdas[1], rel=5e-3)


def test_supports_leave_the_rigid_motions_that_they_do():
    assert len(solved("plate").state.body.free_rigid_motions()) == 3
    assert len(solved("tet4").state.body.free_rigid_motions()) == 6
    assert len(solved("plane").state.body.free_rigid_motions()) == 0


@pytest.mark.parametrize(
    "scene, overrides, reported",
    [
        ("bar_100.toml", ["material.aluminium.rho=0"], "density"),
        ("slender.toml", ['supports.wall.fix=["z"]'], "no component 'z'"),
        ("slender.toml", ['supports.wall.fix={x="1 mm"}'], "prescribes"),
        ("bar_100.toml", ["effects.modal.model=plate", "mesh.order=2"], "first order"),
        ("bar_100.toml", ["quantities.pitch.frequency=9"], "1 mode is computed"),
        ("slender.toml", ["material.steel.thickness='0.01 + 0*x'"], "one thickness"),
    ],
)
def test_scenes_that_make_no_sense_are_refused(scene, overrides, reported):
    with pytest.raises(UserError, match=reported):
        first_frame(SCENES / scene, overrides)


def test_thickness_that_vanishes_is_refused():
    with pytest.raises(UserError, match="thickness is"):
        first_frame(SCENES / "bar_100.toml", ["material.aluminium.thickness='0.004 - 0.1*x'"])


def test_a_plate_on_the_first_reconnected_mesh_has_its_free_sides():
    """Whatever number the topology of its mesh has."""
    made = first_frame(SCENES / "bar_100.toml", ["effects.modal.model=plate", 'mesh.size="9 mm"', "mesh.layers=1"])
    state, mesh = made.analysis.state, made.analysis.space
    known = state.body.stiffness.parameters.copy()
    mesh.topology = -1
    body = made.analysis.make(state.scene, state.plan, mesh, False)
    np.testing.assert_array_equal(body.stiffness.parameters, known)


def test_a_block_of_too_few_modes_out_of_the_plane_says_what_to_ask_for(monkeypatch):
    """Beyond its first modes a thick block moves in all directions alike; here none may lie between."""
    tall = ["material.aluminium.thickness=0.1", 'mesh.size="15 mm"', "effects.modal.modes=4"]
    monkeypatch.setattr(mode_search, "MOST_BESIDE", 0)
    with pytest.raises(UserError, match=r"lowest modes move mostly out of the plane.*effects\.modal\.in_plane = true"):
        first_frame(SCENES / "bar_100.toml", tall)
    assert len(first_frame(SCENES / "bar_100.toml", [*tall, "effects.modal.in_plane=true"]).analysis.frequencies) >= 4
