"""Drags that are predicted from several samples: what they gain, what idle time is spent on, and what is refused."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from columns import column
from modal import replay as modal_replay
from small_scenes import across, drag, make_replay, plate, rows_of, write_scene, write_script

from restshape.application import application
from restshape.calibration import Calibration
from restshape.errors import UserError
from restshape.replay.columns import SAMPLED, columns_of
from restshape.replay.parity import Parity
from restshape.replay.recording.recorder import Recorder
from restshape.replay.recording.recording import Recording
from restshape.scene.load import load_scene
from restshape.sensitivity.samples import DragSamples

EXACT = ["solve.tolerance=1e-11"]
ALONE = [*EXACT, "predict.frame_time=0"]
"""Without solver steps in frames of a drag."""
LARGE = plate().replace("200e9", "4e9") + "[effects.large_deformation]\n"
KINDS = {"linear": plate(), "large": LARGE, "second order": plate(0.2, 2)}
START, TURN, FAR = (0.5, 0.5), (0.56, 0.53), (0.62, 0.5)


def resting(*places, on="window", frames=6, rest=12):
    """A drag through places, at each of which the hand rests."""
    events = [{"do": "press", "on": on, "at": list(places[0])}]
    for a, b in zip(places, places[1:]):  # noqa: RUF007 (each drag goes on from the last place)
        events += [{"do": "drag", "path": across(a, b, frames)}, {"do": "idle", "frames": rest}]
    return [*events, {"do": "release"}]


PATH = resting(START, TURN, FAR, START)


def shown(scene, script, kind, overrides=ALONE, look=lambda analysis: analysis.x.copy(), **known):
    """Rows of a replay, and what it shows in each frame."""
    made, found = make_replay(scene, script, overrides=overrides, predict=kind, **known), []
    rows = rows_of(made, lambda row: found.append(look(made.analysis)))
    return rows, found


def off(rows, found, exact):
    """Relative errors of the predicted frames of drags."""
    return [
        np.linalg.norm(x - e) / np.linalg.norm(e)
        for row, x, e in zip(rows, found, exact)
        if row["predicted"] and row["event"] == "drag"
    ]


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_several_samples_predict_better_than_one(tmp_path, kind):
    scene, script = write_scene(tmp_path, KINDS[kind]), write_script(tmp_path, PATH)
    (_, exact), (rows, linear), (sampled, several) = (shown(scene, script, way) for way in ("none", "linear", "gmls"))
    assert np.mean(off(sampled, several, exact)) < np.mean(off(rows, linear, exact)) / 3.0
    assert sampled[1]["samples"] == 1 and max(row["samples"] for row in sampled) >= 4
    # Where the hand rests the frame is solved, and what is recorded of the time before it says so.
    first = next(k for k, row in enumerate(sampled) if row["event"] == "idle")
    rest = sampled[first + 1]
    assert not rest["predicted"] and np.linalg.norm(several[first + 1] - exact[first + 1]) < 1e-8
    works = [row["idle_work"] for row in sampled]
    assert "derivative" in " ".join(works) and sum(row["idle_spent"] for row in sampled) > 0.0
    assert all(len(row["sample_ages"].split()) == row["samples"] for row in sampled)
    assert sampled[-1]["event"] == "release" and np.linalg.norm(several[-1] - exact[-1]) < 1e-8


@pytest.mark.parametrize("kind", ["linear", "large"])
def test_steps_in_the_time_of_a_frame_reach_the_solution(tmp_path, kind):
    scene, script = write_scene(tmp_path, KINDS[kind]), write_script(tmp_path, resting(START, TURN))
    (_, exact), (rows, found) = (shown(scene, script, way, EXACT) for way in ("none", "gmls"))
    drags = [row for row in rows if row["event"] == "drag"]
    assert all(row["predicted"] and row["solver_steps"] >= 1 for row in drags)
    assert max(off(rows, found, exact)) < 1e-8
    # The estimate is that of what is shown.
    assert max(row["estimate"] for row in drags) < 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["linear", "large"])
def test_the_same_bits_twice_idle_work_included(tmp_path, kind):
    scene, script = write_scene(tmp_path, KINDS[kind]), write_script(tmp_path, PATH)
    twice = [shown(scene, script, "gmls", [], lambda analysis: analysis.x.tobytes()) for _ in range(2)]
    assert twice[0][1] == twice[1][1]
    for one, two in zip(*(rows for rows, _ in twice)):
        assert {name: one[name] for name in SAMPLED} == {name: two[name] for name in SAMPLED}
    assert any(row["idle_work"] for row in twice[0][0])


def slowed(factor):
    """The calibration of a machine so many times as slow."""
    known = Calibration.load()
    units = {name: value * factor for name, value in known.__dict__.items() if name != "machine"}
    return replace(known, **units)


def test_idle_time_is_work_by_the_calibration(tmp_path):
    """On a machine that the calibration says to be slower the same rest pays for its solve later, or never."""
    scene, script = write_scene(tmp_path, plate()), write_script(tmp_path, resting(START, TURN, rest=20))
    solved = []
    for factor in (1.0, 600.0, 1e7):
        rows, _ = shown(scene, script, "gmls", EXACT, calibration=slowed(factor))
        idle = [row for row in rows if row["event"] == "idle"]
        solved.append(next((k for k, row in enumerate(idle) if "solve" in row["idle_work"]), None))
        spent, given = (sum(row[name] for row in idle) for name in ("idle_spent", "idle_time"))
        assert given > 0.0 and spent <= 1.5 * given
        drags = [row["solver_steps"] for row in rows if row["event"] == "drag"]
        assert (max(drags) > 0) == (factor == 1.0)
        # Until there is time for it, what the drag has shown is shown.
        assert [row["predicted"] for row in idle] == [int(solved[-1] is None or k < solved[-1]) for k in range(20)]
    assert solved[0] <= 1 < solved[1] < 19 and solved[2] is None


@pytest.mark.slow
def test_ten_samples_on_one_line_and_more(tmp_path):
    places = [(0.5 + 0.024 * k, 0.5) for k in range(13)]
    scene, script = write_scene(tmp_path, plate()), write_script(tmp_path, resting(*places, frames=2, rest=3))
    (_, exact), (rows, linear), (sampled, found) = (shown(scene, script, way) for way in ("none", "linear", "gmls"))
    assert max(row["samples"] for row in sampled) == 10
    assert np.mean(off(sampled, found, exact)) < np.mean(off(rows, linear, exact)) / 3.0
    fewer, _ = shown(scene, script, "gmls", [*ALONE, "predict.samples=3"])
    assert max(row["samples"] for row in fewer) == 3


def test_a_hand_that_leaves_all_samples_is_solved_for(tmp_path):
    text = plate(0.2, 2)
    events = [{"do": "press", "on": "window", "at": [0.5, 0.5]}, {"do": "drag", "to": [0.51, 0.5]}]
    events += [{"do": "drag", "to": [0.95, 0.72]}, {"do": "idle", "frames": 2}, {"do": "drag", "to": [0.96, 0.72]}]
    scene, script = write_scene(tmp_path, text), write_script(tmp_path, [*events, {"do": "release"}])
    rows, found = shown(scene, script, "gmls")
    _, exact = shown(scene, script, "none")
    far = next(row for row in rows if row["event"] == "drag" and row["line"] == 4)
    assert far["level"] > 1 or far["note"].startswith("solved: its prediction would be off by about")
    assert not far["predicted"] and rows[far["index"] + 3]["predicted"]
    assert off(rows, found, exact)[-1] < 0.05 and np.linalg.norm(found[-1] - exact[-1]) < 1e-8


def test_values_set_within_a_drag_begin_again(tmp_path):
    events = [
        *resting(START, TURN)[:-1],
        {"do": "set", "key": "loads.pull.traction", "value": ["200 MPa", 0]},
        {"do": "idle", "frames": 2},
        {"do": "drag", "to": [0.565, 0.53]},
        {"do": "release"},
    ]
    scene, script = write_scene(tmp_path, plate()), write_script(tmp_path, events)
    (_, exact), (rows, found) = (shown(scene, script, way) for way in ("none", "gmls"))
    k = next(row["index"] for row in rows if row["event"] == "set")
    assert rows[k - 1]["samples"] >= 2 and rows[k]["samples"] == 1
    assert rows[-2]["predicted"] and off(rows, found, exact)[-1] < 1e-3


@pytest.mark.slow
def test_flips_and_new_meshes_within_a_drag(tmp_path):
    """Samples stay after flips of first order, whose nodes they are of, and are projected to a new mesh."""
    path = across((0.5, 0.5), (1.3, 0.55), 60)
    scene, script = write_scene(tmp_path, plate()), write_script(tmp_path, drag("window", (0.5, 0.5), path))
    (_, exact), (rows, found) = (shown(scene, script, way) for way in ("none", "gmls"))
    assert {1, 2, 3} <= {row["level"] for row in rows}
    flipped = [row["samples"] for row in rows if row["level"] == 2]
    assert max(flipped) > 1 and all(row["samples"] == 10 for row in rows[1:] if row["level"] == 3)
    assert [row["samples_projected"] for row in rows[1:] if row["level"] == 3] == [9]
    assert max(off(rows, found, exact)) < 1e-3
    made = make_replay(scene, script, predict="gmls", overrides=EXACT)
    check = Parity(made)
    assert sum(1 for _ in made.frames() if check()) == len(rows) and check.summary()["holds"]


@pytest.mark.slow
def test_frequencies_of_a_pair_that_opens(tmp_path):
    """A square plate has pairs of modes that the drag turns: they are mixed in one basis."""
    events = resting((10.0, 10.0), (10.5, 10.2), (11.0, 11.0), on="c", frames=4, rest=10)
    script, found = write_script(tmp_path, events), {}
    over = ["mesh.size=0.8", "solve.tolerance=1e-8", "predict.frame_time=0"]
    for kind in ("none", "linear", "gmls"):
        made, values = modal_replay("square.toml", script, over, predict=kind), []
        rows = rows_of(made, lambda row, made=made, values=values: values.append(made.analysis.frequencies.copy()))
        found[kind] = rows, values
    errors = {}
    for kind in ("linear", "gmls"):
        rows, values = found[kind]
        drags = [k for k, row in enumerate(rows) if row["event"] == "drag" and row["predicted"]]
        errors[kind] = np.mean([np.abs(values[k] / found["none"][1][k] - 1.0).max() for k in drags])
    assert errors["gmls"] < errors["linear"] / 3.0
    assert max(row["samples"] for row in found["gmls"][0]) >= 3


@pytest.mark.slow
def test_load_factors(tmp_path):
    scene = write_scene(tmp_path, column(height=0.2, size=0.06))
    events = resting((0.5, 0.2), (0.5, 0.17), (0.52, 0.14), (0.5, 0.2), on="top", frames=4, rest=10)
    script, look = write_script(tmp_path, events), lambda analysis: analysis.load_factors.copy()
    over = ["predict.frame_time=0"]
    _, exact = shown(scene, script, "none", over, look)
    errors = {}
    for kind in ("linear", "gmls"):
        rows, found = shown(scene, script, kind, over, look)
        drags = [k for k, row in enumerate(rows) if row["event"] == "drag" and row["predicted"]]
        errors[kind] = np.mean([np.abs(found[k] / exact[k] - 1.0).max() for k in drags])
        assert np.abs(found[-1] / exact[-1] - 1.0).max() < 1e-6
    assert errors["gmls"] < errors["linear"] / 2.0


@pytest.mark.slow
def test_a_frame_solved_near_a_sample_takes_its_place(tmp_path):
    """A thin column whose steps are far less than the least distance of samples, which is a part of its diagonal."""
    scene = write_scene(tmp_path, column(height=0.04, size=0.02))
    script = write_script(tmp_path, drag("top", (0.5, 0.04), across((0.5, 0.04), (0.5, 0.02), 30)))
    predicted = {}
    for kind in ("linear", "gmls"):
        rows, _ = shown(scene, script, kind, ["predict.frame_time=0"], lambda analysis: None)
        predicted[kind] = sum(row["predicted"] for row in rows)
    assert predicted["gmls"] >= predicted["linear"]


def test_a_recording_says_how_it_was_predicted(tmp_path):
    scene, script = write_scene(tmp_path, plate()), write_script(tmp_path, resting(START, TURN))
    loaded, app = load_scene(scene, ["predict.epsilon=0.02"]), application("plane")
    columns = columns_of(loaded, app, predict="gmls")
    assert set(SAMPLED) <= set(columns) and not set(SAMPLED) & set(columns_of(loaded, app, predict="linear"))
    made = make_replay(scene, script, overrides=["predict.epsilon=0.02"], predict="gmls")
    with Recorder.start(tmp_path / "a.vtkhdf", {}, columns) as recorder:
        made.recorder = recorder
        rows = rows_of(made)
    with Recording(tmp_path / "a.vtkhdf") as recording:
        assert recording.verify() == []
        assert recording.table["samples"].tolist() == [row["samples"] for row in rows]
        assert recording.table["idle_spent"].tolist() == [row["idle_spent"] for row in rows]


@pytest.mark.slow
def test_the_command_records_epsilon(tmp_path, command):
    write_scene(tmp_path, plate())
    write_script(tmp_path, resting(START, TURN))
    words = ("--edits", "edits.jsonl", "--predict", "gmls", "--out", "a.vtkhdf", "--set", "predict.epsilon=0.02")
    done = command("replay", "scene.toml", *words)
    assert done.returncode == 0 and "frames predicted" in done.stdout, done.stderr
    with Recording(tmp_path / "a.vtkhdf") as recording:
        assert recording.header["predict"] == "gmls"
        assert recording.header["prediction"] == {
            "epsilon": 0.02,
            "samples": 10,
            "frame_time": 1.0 / 60.0,
            "levels": 1,
        }


def test_a_script_without_edit_time_is_reported(tmp_path, command):
    write_scene(tmp_path, plate())
    events = [{**event, "t": 0.0} for event in resting(START, TURN, frames=2, rest=2)]
    lines = [{"format": "restshape-edits", "version": 1, "units": "m"}, *events]
    (tmp_path / "edits.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
    done = command("replay", "scene.toml", "--edits", "edits.jsonl", "--predict", "gmls", "--csv", "a.csv")
    assert done.returncode == 0 and "no time is left to take samples in" in done.stderr
    rows, _ = shown(tmp_path / "scene.toml", tmp_path / "edits.jsonl", "gmls")
    assert all(row["idle_time"] == 0.0 and not row["idle_work"] for row in rows)


@pytest.mark.parametrize("value", ["0", "-0.1", "inf"])
def test_epsilon_that_makes_no_sense_is_refused(tmp_path, value):
    with pytest.raises(UserError, match=r"predict\.epsilon"):
        make_replay(write_scene(tmp_path, plate()), None, overrides=[f"predict.epsilon={value}"])


def test_a_time_of_a_frame_that_no_hand_waits_for_is_refused(tmp_path):
    with pytest.raises(UserError, match=r"predict\.frame_time"):
        make_replay(write_scene(tmp_path, plate()), None, overrides=["predict.frame_time=1e9"])


def test_more_than_ten_samples_are_refused(tmp_path):
    with pytest.raises(UserError, match=r"predict\.samples"):
        make_replay(write_scene(tmp_path, plate()), None, overrides=["predict.samples=11"])


def test_what_cannot_be_mixed_is_refused(tmp_path, command):
    scene = write_scene(tmp_path, plate())
    for policy, over, word in (("thesis", [], "springs"), ("rebuild", [], "rebuild")):
        with pytest.raises(UserError, match=word):
            make_replay(scene, None, policy, over, predict="gmls")
    with pytest.raises(UserError, match="springs"):
        make_replay(scene, None, overrides=['mesh.relocation="laplacian"'], predict="gmls")
    building = Path(__file__).parents[1] / "scenes" / "building.toml"
    done = command("replay", building, "--predict", "gmls")
    assert done.returncode == 2 and "--predict gmls" in done.stderr and "time integration" in done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["linear", "large", "second order"])
def test_a_new_mesh_in_each_third_frame_keeps_samples(tmp_path, kind):
    """They are projected, agree with the answer on the new mesh, and predict better than that answer alone."""
    over = [*ALONE, "mesh.relocation=mvc", "mesh.min_quality=0.7"]
    path = across((0.5, 0.5), (1.4, 0.52), 18)
    scene, script = write_scene(tmp_path, KINDS[kind]), write_script(tmp_path, drag("window", (0.5, 0.5), path))
    (_, exact), (rows, found) = (shown(scene, script, way, over) for way in ("none", "gmls"))
    new = [row for row in rows[1:] if row["level"] == 3]
    assert len(new) > 3 and all(row["samples_projected"] == row["samples"] - 1 > 0 for row in new[1:])
    errors = off(rows, found, exact)
    alone = off(*shown(scene, script, "linear", over), exact)
    assert np.mean(errors) < min(2e-3, 0.8 * np.mean(alone))
    check = Parity(made := make_replay(scene, script, predict="gmls", overrides=[*EXACT, *over[2:]]))
    assert sum(1 for _ in made.frames() if check()) == len(rows) and check.summary()["holds"]


def test_samples_are_projected_from_where_the_old_mesh_lies(tmp_path):
    """In a jump triangles invert: the old mesh stays on the shape before, and new nodes are looked for there."""
    events = [{"do": "press", "on": "window", "at": [0.5, 0.5]}, {"do": "drag", "path": across(START, TURN, 6)}]
    events += [{"do": "drag", "to": [1.2, 0.55]}, {"do": "drag", "to": [1.19, 0.55]}, {"do": "release"}]
    scene, script = write_scene(tmp_path, plate()), write_script(tmp_path, events)
    (_, exact), (rows, found) = (shown(scene, script, way) for way in ("none", "gmls"))
    jump = rows[8]
    assert jump["level"] == 3 and jump["samples_projected"] == jump["samples"] - 1 >= 2
    assert rows[9]["predicted"] and np.linalg.norm(found[9] - exact[9]) < 2e-3 * np.linalg.norm(exact[9])


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["linear", "large", "second order"])
def test_what_samples_of_another_mesh_gain_where_they_agree_with_an_answer_of_this_one(tmp_path, kind, monkeypatch):
    """Their own discretisation errors differ: as they are they predict two to three times as badly."""
    path = across(START, (1.3, 0.55), 60)
    scene, script = write_scene(tmp_path, KINDS[kind]), write_script(tmp_path, drag("window", START, path))
    _, exact = shown(scene, script, "none")
    rows, found = shown(scene, script, "gmls")
    monkeypatch.setattr(DragSamples, "rebase", lambda *_: None)
    _, plain = shown(scene, script, "gmls")
    last = min(row["index"] for row in rows[1:] if row["level"] == 3)
    after = slice(last, last + 9)
    assert 0 < last < len(rows) - 5 and rows[last]["samples_projected"] > 5
    errors = [np.mean(off(rows[after], one[after], exact[after])) for one in (found, plain)]
    assert errors[0] < errors[1] / 1.8 and errors[0] < 2e-4
