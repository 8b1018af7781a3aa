"""The application `cantilever`: its scene is the thesis's, and its script is a session that reaches the goal."""

import json

import pytest
from small_scenes import make_replay

from restshape.application import application
from restshape.physics.goals import goal_curve
from restshape.scene.load import load_scene
from restshape.scene.script import load_script
from restshape.shape.session import EditSession

FOLDER = application("cantilever").folder
SCENE, EDITS = FOLDER / "scenes" / "cantilever.toml", FOLDER / "edits" / "cantilever.jsonl"
LENGTH = 2.0


def test_the_scene_has_as_many_triangles_as_the_thesis():
    replay = make_replay(SCENE)
    row = next(replay.frames())
    assert row["elements"] == 990
    assert row["q_miss"] > 0.05 * LENGTH


def test_the_goal_is_what_the_scene_says_of_it():
    curve = goal_curve(load_scene(SCENE).goal["wing"])
    low, tip = curve[0], curve[[abs(p[0] - 1.95) < 1e-12 for p in curve]]
    assert low == pytest.approx([0.0, 0.0])
    middle, half = 0.125 + 0.03 * 1.95**2, 0.055
    assert (tip[:, 1].min(), tip[:, 1].max()) == pytest.approx((middle - half, middle + half), abs=1e-3)


def test_the_script_is_a_session_by_hand():
    scene = load_scene(SCENE)
    frames = list(EditSession(scene, load_script(EDITS, scene)).frames())
    assert 100 <= len(frames) <= 300
    assert not any(frame.refused for frame in frames)
    assert {frame.do for frame in frames} == {"start", "idle", "press", "pull", "drag", "release"}


def test_the_session_brings_the_mean_distance_below_one_percent_of_the_length():
    script = load_script(EDITS, load_scene(SCENE))
    shape = None
    # The shape of the last frame alone, on a mesh of its own: nothing is reused, and the answer is the same.
    for frame in EditSession(load_scene(SCENE), script).frames():
        shape = frame.outline
    rows = [row["q_miss"] for row in make_replay(SCENE, EDITS).frames()]
    assert rows[-1] < 0.01 * LENGTH < rows[0]
    cold = make_replay(SCENE)
    cold.session.outline = shape
    assert next(cold.frames())["q_miss"] == pytest.approx(rows[-1], rel=0.2)


def test_the_template_runs(restshape, tmp_path):
    assert restshape("new", "cantilever", str(tmp_path / "mine")).returncode == 0
    scene, edits = tmp_path / "mine" / "scene.toml", tmp_path / "mine" / "edits.jsonl"
    done = restshape("replay", str(scene), "--edits", str(edits), "--json", str(tmp_path / "a.json"))
    assert done.returncode == 0, done.stderr
    told = json.loads((tmp_path / "a.json").read_text())
    assert told["refused"] == 0 and told["quantities"]["miss"][-1] < told["quantities"]["miss"][0]
