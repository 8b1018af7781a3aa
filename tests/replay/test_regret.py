"""Counted work of `auto` beside the best policy and the best schedule of refreshes in hindsight."""

import json
from pathlib import Path

import pytest
from petsc4py import PETSc
from small_scenes import across, drag, plate, write_scene, write_script

from restshape.application import application
from restshape.calibration import Calibration
from restshape.policy import policy
from restshape.replay.request import Request
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene
from restshape.variation.regret import measure

pytestmark = pytest.mark.skipif(PETSc.COMM_WORLD.size > 1, reason="one rank")
APPS = Path(__file__).parents[2] / "apps"
SCENES = Path(__file__).parents[1] / "scenes"
POLICIES = {"rebuild", "refactor", "thesis", "auto"}


@pytest.fixture
def files(tmp_path):
    scene = write_scene(tmp_path, plate(0.3))
    return scene, write_script(tmp_path, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.6, 0.5), 6)))


def test_a_replay_prints_its_regret(files, tmp_path, command):
    done = command("replay", *files, "--regret", "--json", "a.json")
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "a.json").read_text())["regret"]
    work = {name: one["seconds"] for name, one in found["policies"].items()}
    assert set(work) == POLICIES and min(work.values()) == work[found["best"]] > 0
    assert found["over_policy"] == pytest.approx(work["auto"] / min(work.values()))
    schedule = found["hindsight"]
    # The best is one of the schedules that were looked at, that of the run among them.
    assert schedule["run"] >= schedule["best"] * (1 - 1e-9)
    assert found["over_schedule"] == schedule["ratio"] == pytest.approx(schedule["run"] / schedule["best"])
    assert f"{found['over_policy']:.3f} times the best policy, {found['best']}" in done.stdout
    # The policy of the thesis solves with an incomplete factor, which costs more than twice as much: it was ended.
    assert work["thesis"] > 2 * min(work.values()) and found["policies"]["thesis"]["ended"] is not None
    assert "thesis was ended after frame" in done.stdout
    # A direct solver makes a factor a matrix, and applies it once.
    refactor = found["policies"]["refactor"]
    assert refactor["factors"] == refactor["iterations"] == schedule["matrices"]


def test_each_frame_of_each_policy_has_its_limit(files):
    """Who looks after the limit of a frame hears of every one, those of `refactor` as those of `auto` at least."""
    scene = load_scene(files[0])
    script = load_script(files[1], scene)
    request = Request(scene, script, application(scene.app), policy("auto"), Calibration.load())
    frames: list[None] = []
    measure(request, lambda: frames.append(None))
    assert len(frames) >= 2 * 9


@pytest.mark.parametrize(
    "word",
    [
        ("--out", "a.vtkhdf"),
        ("--policy", "auto"),
        ("--parity",),
        ("--strict",),
        ("--predict", "linear"),
        ("--fields", "stress"),
        ("--estimate", "5"),
    ],
)
def test_regret_keeps_no_replay(files, command, word):
    done = command("replay", *files, "--regret", *word)
    assert done.returncode == 2 and f"leave {word[0]} out" in done.stderr


def test_without_a_linear_solver_there_is_none(command):
    done = command("replay", SCENES / "fish.toml", "--regret")
    assert done.returncode == 2 and "no linear solver" in done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("name", ["cook", "csm1", "elastica", "kirsch", "slender", "strip"])
def test_auto_is_near_the_best_of_both(name, command, tmp_path):
    """Linear, and nonlinear with many steps of load; frames that hardly differ, and such as differ much."""
    scene, script = APPS / "solid" / "scenes" / f"{name}.toml", APPS / "solid" / "edits" / f"{name}.jsonl"
    done = command("replay", scene, script, "--regret", "--json", "a.json")
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "a.json").read_text())["regret"]
    # Of the slender plate each frame wants a factor of its own: few trials of old ones, of 46 frames, are not made up.
    assert found["over_policy"] <= 1.05 and found["over_schedule"] <= 2.0
