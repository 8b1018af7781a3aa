"""A problem with fields on different nodes as any other: frames of edits, reuse beside rebuilds, predictions."""

from dataclasses import replace

import numpy as np
import pytest
from petsc4py import PETSc
from small_scenes import PATCH, across, drag, write_scene, write_script
from stokes import flow

from restshape.application import application_of
from restshape.calibration import Calibration
from restshape.policy import policy
from restshape.replay.loop import Replay
from restshape.replay.request import Request
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

TOLERANCE = 1e-9
SETTINGS = ["mesh.order=2", "mesh.size=0.2", f"solve.tolerance={TOLERANCE}"]
PATH = across((0.5, 0.5), (0.75, 0.6), 12)
BACK = PATH[-2::-1][:6]
DRAG = drag("window", (0.5, 0.5), PATH)


def replay_of(folder, events, name="auto", predict="none", settings=()):
    scene = load_scene(write_scene(folder, PATCH), [*SETTINGS, *settings])
    flowing = replace(application_of(scene), analysis="stokes:stokes_analysis")
    script = load_script(write_script(folder, events), scene)
    request = Request(scene, script, flowing, policy(name), Calibration.load(), predict=predict)
    return Replay(request, PETSc.COMM_SELF)


def velocity_error(analysis) -> float:
    space = analysis.space
    away = space.values("velocity", analysis.x) - flow(space.X)[0]
    return float(np.abs(away).max() / np.abs(flow(space.X)[0]).max())


def checked_rows(replay) -> list[dict]:
    """All rows; each frame is beside a cold solve of it, and beside the closed form."""
    rows = []
    for row in replay.frames():
        rows.append(dict(row))
        if not row["predicted"]:
            compared = replay.analysis.compare_cold()
            assert compared.entries < 1e-13 and compared.solution < 100 * TOLERANCE, row["index"]
            assert row["residual"] <= 2 * TOLERANCE
        assert velocity_error(replay.analysis) < 5e-3 and not row["refused"]
        assert np.isnan(row["estimate"])
    return rows


@pytest.mark.parametrize("name", ["auto", "refactor", "rebuild"])
def test_frames_of_a_drag_are_those_of_cold_solves_and_of_the_closed_form(tmp_path, name):
    rows = checked_rows(replay_of(tmp_path, DRAG, name))
    moved = [row for row in rows if row["level"]]
    assert len(moved) >= len(PATH) - 1
    if name == "auto":
        assert sum(row["pc_rebuilt"] for row in rows) < len(moved)
    assert all(row["newton"] == 0 and row["iterations"] > 0 for row in moved)


def test_flips_and_new_meshes_take_both_fields_with_them(tmp_path):
    rows = checked_rows(replay_of(tmp_path, DRAG, settings=["mesh.min_quality=0.45"]))
    assert {1, 2, 3} <= {row["level"] for row in rows}


def test_a_guess_from_another_mesh_is_near(tmp_path):
    """Fields of second and of first order are exact at linear ones, wherever the new nodes lie."""
    replay = replay_of(tmp_path, [])
    list(replay.frames())
    old = replay.analysis.space
    other = replay_of(tmp_path, [], settings=["mesh.size=0.13"])
    list(other.frames())
    new = other.analysis.space
    x = np.zeros((len(old.node), 1))
    for name in ("velocity", "pressure"):
        rows = old.rows(name)
        x[rows, 0] = (old.X[old.node[rows[:, 0]]] @ np.array([[1.0, -2.0], [0.5, 3.0]]))[:, : rows.shape[1]]
    found = new.project(old, x)
    inside = np.setdiff1d(np.arange(len(new.X)), new.base.facets)
    for name in ("velocity", "pressure"):
        rows = new.rows(name)
        nodes = new.node[rows[:, 0]]
        wanted = (new.X[nodes] @ np.array([[1.0, -2.0], [0.5, 3.0]]))[:, : rows.shape[1]]
        kept = np.isin(nodes, inside)
        np.testing.assert_allclose(found[rows, 0][kept], wanted[kept], atol=1e-9)


def test_other_values_of_the_scene_leave_the_unknowns(tmp_path):
    events = [*DRAG, {"do": "set", "key": "material.m.E", "value": 2e9}, *drag("window", PATH[-1], BACK)]
    rows = checked_rows(replay_of(tmp_path, events, settings=["mesh.min_quality=0.45"]))
    assert any(row["event"] == "set" for row in rows)


def test_frames_are_predicted(tmp_path):
    rows = checked_rows(
        replay_of(tmp_path, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.52, 0.5), 4)), predict="linear")
    )
    assert any(row["predicted"] for row in rows)
