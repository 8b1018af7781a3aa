"""Undo and redo bring back the answer that there was, at once: cloth, its friction, its mesh."""

import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from cloths import BALL, CONTACT, write_cloth
from petsc4py import PETSc

from restshape.application import application_of
from restshape.calibration import Calibration
from restshape.policy import policy
from restshape.replay.loop import Replay
from restshape.replay.request import Request
from restshape.replay.returns import Returns
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

pytestmark = pytest.mark.slow

SCENES = Path(__file__).parents[1] / "scenes"
COARSE = ("mesh.size=0.12", "effects.cloth.bending=hinge", "parameters.half=0.5")
LEVELS = ("mesh.size=0.1", "mesh.levels=2", "effects.cloth.bending=hinge")
THERE_AND_BACK = (
    {"do": "press", "on": "ball", "at": [0.5, 0.5, -0.3]},
    {"do": "drag", "to": [0.6, 0.45, -0.3], "frames": 3},
    {"do": "release"},
    {"do": "set", "key": "bodies.ball.sphere.radius", "value": 0.3, "frames": 2},
    {"do": "undo"},
    {"do": "undo"},
    {"do": "redo"},
    {"do": "redo"},
    {"do": "idle", "frames": 1},
)
SHAPES = (
    {"do": "scale", "on": "outline", "factor": 1.1, "frames": 2},
    {"do": "hole", "name": "pocket", "center": [0.12, 0.12], "radius": 0.06},
    {"do": "press", "on": "c"},
    {"do": "drag", "to": [0.8, 1.0], "frames": 3},
    {"do": "release"},
    {"do": "undo"},
    {"do": "undo"},
    {"do": "undo"},
    {"do": "redo"},
)


@pytest.fixture(scope="module")
def replay(tmp_path_factory):
    """Makes replays of the square of cotton on a ball."""
    folder = tmp_path_factory.mktemp("returns")

    def made(events, overrides=COARSE, name="auto", most=None, predict="none") -> Replay:
        path = write_cloth(folder, CONTACT, BALL.replace('"half"', "0.5"))
        head = {"format": "restshape-edits", "version": 1, "scene": path.name, "units": "m"}
        lines = [head, *({"t": 0.1 * k} | event for k, event in enumerate(events, 1))]
        (folder / "edits.jsonl").write_text("\n".join(map(json.dumps, lines)))
        scene = load_scene(path, overrides)
        script = load_script(folder / "edits.jsonl", scene)
        request = Request(scene, script, application_of(scene), policy(name), Calibration.load(), predict=predict)
        found = Replay(request, PETSc.COMM_SELF)
        if most is not None:
            found.solver.returns.most = most
        return found

    return made


def seen(found: Replay) -> list[dict]:
    """What there is of each frame: its row, places, anchors of friction and nodes of the mesh."""
    frames = []
    for row in found.frames():
        assert not row["refused"], row["refused"]
        analysis = found.analysis
        anchors = analysis.problem.contact.history.anchors
        frames.append(
            {**row, "x": analysis.x.copy(), "anchors": anchors.copy(), "X": analysis.space.X.copy()}
            | {"cells": analysis.space.cells.copy(), "energy": analysis.problem.energy(analysis.x)}
        )
    return frames


def same(one: dict, other: dict) -> bool:
    """Whether two frames are the same to the last bit."""
    arrays = ("x", "anchors", "X", "cells")
    return all(np.array_equal(one[name], other[name]) for name in arrays) and (
        one["energy"] == other["energy"] and one["residual"] == other["residual"]
    )


@pytest.fixture(scope="module")
def there_and_back(replay):
    """The frames of a way there and back, and the bytes that are kept at its end."""
    full = replay(THERE_AND_BACK)
    return seen(full), full.solver.returns.nbytes


def test_undo_and_redo_bring_back_cloth_and_friction_without_a_step(there_and_back):
    frames, _ = there_and_back
    start, dragged, grown = frames[0], frames[5], frames[7]
    assert not same(start, dragged) and not same(dragged, grown)
    for frame, known in zip(frames[8:], (dragged, start, dragged, grown, grown)):
        assert same(frame, known) and frame["converged"] == known["converged"]
        assert frame["untrusted"] == known["untrusted"] and frame["max_strain"] == known["max_strain"]
        assert frame["relaxation_steps"] == frame["iterations"] == frame["factorisations"] == frame["pc_rebuilt"] == 0


@pytest.mark.weekly
def test_undo_brings_back_an_edit_whose_last_frame_was_refused(replay):
    """Its end is the frame before: a hole grew past the border."""
    pocket = {"do": "hole", "name": "pocket", "center": [0.12, 0.12], "radius": 0.06}
    larger = {"do": "scale", "on": "pocket", "factor": 3, "frames": 4}
    grown = {"do": "set", "key": "bodies.ball.sphere.radius", "value": 0.27}
    found = replay([pocket, larger, grown, {"do": "undo"}])
    rows, x = zip(*((row, found.analysis.x.copy()) for row in found.frames()))
    assert [bool(row["refused"]) for row in rows] == [False, False, False, True, True, True, False, False]
    np.testing.assert_array_equal(x[7], x[2])
    assert not np.array_equal(x[6], x[2]) and rows[7]["relaxation_steps"] == 0


@pytest.mark.parametrize("refused", [True, False])
def test_an_edit_whose_last_frame_is_refused_ends_with_the_one_before(refused):
    """Its answer is kept when the next edit leaves it; one of a frame within an edit is not."""

    def frame(ended, refused=None):
        return SimpleNamespace(edit_ended=ended, refused=refused, change="values", do="scale", outline=[], scene=[])

    answer = SimpleNamespace(kept_answer=lambda: np.zeros(3))
    parts = SimpleNamespace(analysis=SimpleNamespace(recalling=answer), moving=None)
    returns = Returns(parts, policy("auto"))
    solved = frame(ended=False)
    returns.leave(solved)
    returns.take(solved, True)
    if refused:
        returns.leave(frame(ended=True, refused="edges cross"))
    assert returns.nbytes == 0
    returns.leave(frame(ended=False))
    assert returns.nbytes == (24 if refused else 0)


def test_without_what_was_kept_the_way_back_ends_elsewhere(replay):
    """What this is for: friction remembers the way, so that a solve finds another drape."""
    frames = seen(replay(THERE_AND_BACK, most=0))
    assert frames[8]["relaxation_steps"] > 0
    assert np.abs(frames[8]["x"] - frames[5]["x"]).max() > 1e-3


@pytest.mark.parametrize("overrides", [pytest.param(COARSE, marks=pytest.mark.weekly), LEVELS])
def test_meshes_come_back_too(replay, overrides):
    """After relocated nodes, and new meshes, with and without levels."""
    frames = seen(replay(SHAPES, overrides))
    assert frames[3]["level"] == 3 and len(frames[3]["X"]) != len(frames[2]["X"])
    known = frames[3], frames[2], frames[0], frames[2]
    assert all(same(frame, one) for frame, one in zip(frames[9:], known))
    # A mesh with other triangles is another mesh to who records them.
    assert [frame["level"] for frame in frames[9:]] == [1, 3, 1, 1]


def test_what_follows_an_undo_does_not_hang_on_what_was_undone(replay):
    """To the last bit: neither friction nor factors of edits that are gone lead it elsewhere."""
    edit = {"do": "set", "key": "bodies.ball.sphere.radius", "value": 0.28, "frames": 2}
    ends = []
    for gone in ({"key": "bodies.ball.sphere.radius", "value": 0.2}, {"key": "material.cotton.E", "value": 1e6}):
        ends.append(seen(replay(({"do": "set"} | gone, {"do": "undo"}, edit)))[-1])
    assert same(*ends) and ends[0]["pc_age"] == ends[1]["pc_age"]


def test_memory_is_bounded_and_the_oldest_go_first(replay, there_and_back):
    most = there_and_back[1] - 1
    found = replay(THERE_AND_BACK, most=most)
    frames = seen(found)
    assert 0 < found.solver.returns.nbytes <= most
    # Of three the first one is forgotten; the last one is still known.
    assert frames[8]["relaxation_steps"] == 0


def test_a_policy_that_rebuilds_all_returns_to_nothing(replay):
    found = replay(THERE_AND_BACK[:5], name="rebuild")
    assert seen(found)[-1]["relaxation_steps"] > 0 and found.solver.returns.nbytes == 0


STRIP = """
format = "restshape-scene"
version = 1
app = "plane"
[shape]
outline = ["bottom", "right", "top", "left"]
[shape.vertices]
a = [0, -0.005]
b = [1, -0.005]
c = [1, 0.005]
d = [0, 0.005]
[shape.edges]
bottom = { line = ["a", "b"] }
right = { line = ["b", "c"] }
top = { line = ["c", "d"] }
left = { line = ["d", "a"] }
[material.strip]
E = 12e6
nu = 0
thickness = 1
[effects.solid]
model = "plane_stress"
[effects.large_deformation]
[supports.wall]
on = "left"
fix = ["x", "y"]
[supports.end]
on = "right"
fix = { x = 0, y = 0 }
[loads.push]
on = "top"
traction = [0, -0.2]
[mesh]
size = 0.02
order = 2
[quantities]
lift = { displacement = "y", at = "top", reduce = "mean" }
"""
"""A strip between two walls, one of which comes nearer: it buckles to either side."""


def test_a_solid_that_has_snapped_through_snaps_back_by_undo(tmp_path):
    """It bows down, is pushed up until it snaps, and is let go: up it stays. Undo brings back each side that was."""
    (tmp_path / "strip.toml").write_text(STRIP)
    head = {"format": "restshape-edits", "version": 1, "units": "m"}
    push = {"do": "set", "key": "loads.push.traction.1"}
    events = [
        {"do": "set", "key": "supports.end.fix.x", "value": -0.02, "frames": 8},
        push | {"value": 0.2},
        push | {"value": 60, "frames": 10},
        push | {"value": 0.2, "frames": 10},
        *[{"do": "undo"}] * 4,
        {"do": "redo"},
    ]
    lines = [head, *({"t": 0.1 * k} | event for k, event in enumerate(events, 1))]
    (tmp_path / "strip.jsonl").write_text("\n".join(map(json.dumps, lines)))
    scene = load_scene(tmp_path / "strip.toml")
    script = load_script(tmp_path / "strip.jsonl", scene)
    found = Replay(Request(scene, script, application_of(scene), policy("auto"), Calibration.load()), PETSc.COMM_SELF)
    rows = list(found.frames())
    assert not any(row["refused"] for row in rows)
    lift = [row["q_lift"] for row in rows]
    assert lift[8] < -0.03 and lift[9] < -0.03 and lift[19] > 0.03 and lift[29] > 0.03
    assert lift[30:] == pytest.approx([lift[19], lift[9], lift[8], lift[0], lift[8]], rel=1e-6)


def test_a_linear_solution_is_kept_of_nothing(tmp_path):
    """Analyses that find the same answer again keep none."""
    scene = load_scene(SCENES / "plate.toml")
    script = load_script(SCENES / "plate.jsonl", scene)
    found = Replay(Request(scene, script, application_of(scene), policy("auto"), Calibration.load()), PETSc.COMM_SELF)
    for _ in zip(found.frames(), range(12)):
        pass
    assert found.solver.returns.nbytes == 0


@pytest.mark.parametrize("predict", ["linear", "gmls"])
def test_undo_after_a_predicted_drag_brings_back_the_drape(replay, predict):
    frames = seen(replay((*SHAPES[2:5], {"do": "undo"}, {"do": "redo"}, {"do": "idle", "frames": 1}), predict=predict))
    assert any(frame["predicted"] for frame in frames)
    start, released, undone, redone, idle = frames[0], *frames[-4:]
    assert same(undone, start) and same(redone, released) and same(idle, released) and not same(start, released)
    for frame in (undone, redone, idle):
        assert not frame["predicted"] and np.isnan(frame["prediction_error"]) and not frame["relaxation_steps"]
