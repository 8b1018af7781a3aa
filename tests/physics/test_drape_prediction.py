"""Drapes of the frames of a drag by their derivatives: order, rest on release, samples, and what is refused."""

import numpy as np
import pytest
from drape_designs import BALL, CONTACT, HELD, sheet
from small_scenes import across, drag, make_replay, rows_of, write_scene, write_script

QUANTITIES = '[quantities]\nlowest = { displacement = "z", reduce = "min" }\n'
HANGING = sheet("morley", HELD, QUANTITIES, size=0.03)
ON_BALL = sheet("hinge", HELD, BALL.format(friction=0.3), CONTACT, QUANTITIES, size=0.025)
ALONE = ["predict.frame_time=0"]
HAND = (0.2, 0.1)


def shown(scene, script, kind, overrides=()):
    """Rows of a replay, and the corners of the cloth in each frame."""
    made, found = make_replay(scene, script, overrides=list(overrides), predict=kind), []
    rows = rows_of(made, lambda row: found.append(made.analysis.problem.corners(made.analysis.x).copy()))
    return rows, found


def off(found, exact):
    """The largest distance [m] of corners."""
    return float(np.linalg.norm(found - exact, axis=1).max())


def far(*places, rest=12, frames=5):
    """A drag of the right side through places, at each of which the hand rests."""
    events, at = [{"do": "press", "on": "right", "at": list(HAND)}], HAND
    for place in places:
        events += [{"do": "drag", "path": across(at, place, frames)}, {"do": "idle", "frames": rest}]
        at = place
    return [*events, {"do": "release"}]


@pytest.mark.slow
@pytest.mark.parametrize("text", [HANGING, ON_BALL], ids=["hanging", "on a ball"])
def test_a_drag_is_shown_to_first_order_and_relaxed_on_release(tmp_path, text):
    scene = write_scene(tmp_path, text)
    script = write_script(tmp_path, drag("right", HAND, across(HAND, (0.2004, 0.1), 4)))
    (rows, found), (true, exact) = (shown(scene, script, kind) for kind in ("linear", "none"))
    assert [row["predicted"] for row in rows] == [0, 0, 1, 1, 1, 1, 0]
    errors = [off(found[k], exact[k]) for k in range(2, 6)]
    # Twice as far, four times the error.
    assert errors[3] / errors[1] == pytest.approx(4.0, rel=0.3) and errors[3] < 0.1 * off(exact[0], exact[5])
    for row in rows[2:6]:
        assert row["converged"] == -1 and row["relaxation_steps"] == 0 and row["newton"] == 0
        assert row["estimate"] > 0.0 and not row["note"] and row["lowest_distance"] >= 0.0
    assert rows[6]["converged"] == 1 and off(found[6], exact[6]) < 1e-5
    assert rows[6]["q_lowest"] == pytest.approx(true[6]["q_lowest"], rel=1e-4)
    assert rows[6]["relaxation_steps"] < true[0]["relaxation_steps"]


@pytest.mark.slow
def test_several_drapes_predict_better_than_one(tmp_path):
    scene, script = write_scene(tmp_path, ON_BALL), write_script(tmp_path, far((0.21, 0.1), (0.22, 0.1), (0.23, 0.1)))
    replays = {kind: shown(scene, script, kind, ALONE) for kind in ("none", "linear", "gmls")}
    exact, errors = replays["none"][1], {}
    for kind in ("linear", "gmls"):
        rows, found = replays[kind]
        errors[kind] = [off(found[k], exact[k]) for k, row in enumerate(rows) if row["event"] == "drag"]
    assert np.mean(errors["gmls"]) < np.mean(errors["linear"]) / 2.0
    rows, _ = replays["gmls"]
    assert max(row["samples"] for row in rows) >= 3 and any("derivative" in row["idle_work"] for row in rows)


@pytest.mark.slow
def test_the_same_bits_twice_idle_work_included(tmp_path):
    scene, script = write_scene(tmp_path, ON_BALL), write_script(tmp_path, far((0.22, 0.1), (0.21, 0.1)))
    (rows, one), (again, two) = (shown(scene, script, "gmls") for _ in range(2))
    assert [x.tobytes() for x in one] == [x.tobytes() for x in two]
    names = ("samples", "sample_ages", "solver_steps", "idle_spent", "idle_work")
    assert [[row[name] for name in names] for row in rows] == [[row[name] for name in names] for row in again]


def test_steps_go_on_after_one_that_cost_too_much(tmp_path):
    """What the last step has cost says no more at another drape, whose tangent and factor are others."""
    scene, script = write_scene(tmp_path, HANGING), write_script(tmp_path, far((0.204, 0.1), (0.208, 0.1), frames=3))
    made = make_replay(scene, script, overrides=["predict.frame_time=1"], predict="gmls")

    def spend(row):
        if row["event"] == "press":
            made.prediction.predictor._applied = 10**9

    rows = [row for row in rows_of(made, spend) if row["event"] == "drag"]
    assert [row["solver_steps"] for row in rows[:3]] == [0, 0, 0]
    assert all(row["predicted"] and row["solver_steps"] >= 1 for row in rows[3:])


@pytest.mark.parametrize("kind", ["linear", "gmls"])
@pytest.mark.parametrize("held, to", [("ball", [0.101, 0.11]), ("pins", [0.101, 0.0])])
def test_a_body_or_a_pin_in_the_hand_is_relaxed_and_noted_once_a_drag(tmp_path, kind, held, to):
    scene = write_scene(tmp_path, ON_BALL)
    once = [{"do": "press", "on": held}, {"do": "drag", "to": to}, {"do": "release"}]
    rows, _ = shown(scene, write_script(tmp_path, [*once, *once]), kind)
    assert not any(row["predicted"] for row in rows) and all(row["converged"] == 1 for row in rows)
    noted = [row["event"] for row in rows if f"the hand moves {held}, which is no part of the shape" in row["note"]]
    assert noted == ["press", "press"]


def test_a_body_that_goes_within_a_drag_leaves_no_sample(tmp_path):
    scene = write_scene(tmp_path, ON_BALL)
    events = far((0.21, 0.1), rest=3)[:-1]
    events += [{"do": "set", "key": "bodies.ball.sphere.center", "value": [0.1, 0.11, -0.3]}]
    events += [{"do": "drag", "to": [0.2105, 0.1]}, {"do": "release"}]
    script = write_script(tmp_path, events)
    (rows, found), (_, exact) = (shown(scene, script, kind) for kind in ("gmls", "none"))
    k = next(row["index"] for row in rows if row["event"] == "set")
    assert rows[k]["converged"] == 1 and rows[k]["samples"] <= 1 and not rows[k]["predicted"]
    # The sheet that hangs then has rests 5 cm apart: samples are a fall of 26 cm away from both.
    for frame in (k, -1):
        assert off(found[frame], exact[frame]) < 0.3 * off(found[k - 1], exact[frame])


def test_a_press_while_the_cloth_is_not_at_rest_says_so(tmp_path):
    scene = write_scene(tmp_path, ON_BALL)
    script = write_script(tmp_path, drag("right", HAND, across(HAND, (0.202, 0.1), 2)))
    rows, _ = shown(scene, script, "gmls", ["effects.drape.steps=3"])
    assert rows[1]["note"].startswith("not predicted: the cloth is not at rest") or "not at rest" in rows[1]["note"]
    assert not any(row["predicted"] for row in rows)


@pytest.mark.slow
def test_drapes_of_a_drag_go_on_to_a_new_mesh(tmp_path):
    """With hinges unknowns are those of nodes: earlier drapes are projected to the nodes of a new mesh."""
    events = far((0.21, 0.1), rest=4, frames=3)[:-1]
    events += [{"do": "drag", "to": [0.45, 0.1]}, {"do": "drag", "to": [0.451, 0.1]}, {"do": "release"}]
    scene, script = write_scene(tmp_path, ON_BALL), write_script(tmp_path, events)
    rows, found = shown(scene, script, "gmls", [*ALONE, "mesh.min_quality=0.9"])
    new = next(row["index"] for row in rows[1:] if row["level"] == 3)
    assert rows[new]["samples_projected"] == rows[new]["samples"] - 1 > 0
    after = rows[new + 1]
    assert after["predicted"] and not after["refused"] and after["samples_projected"] > 0
    assert off(found[new + 1], found[new]) < 0.01


@pytest.mark.slow
@pytest.mark.parametrize("text", [HANGING, ON_BALL], ids=["hanging", "on a ball"])
def test_the_estimate_is_about_the_distance_from_the_drape(tmp_path, text):
    """Far along one derivative cloth is stretched, whose tension would hide most of the distance."""
    scene = write_scene(tmp_path, text.replace("size = 0.0", "size = 0.05 #"))
    script = write_script(tmp_path, drag("right", HAND, across(HAND, (0.3, 0.1), 6)))
    made, parts = make_replay(scene, script, predict="linear"), []
    for row in made.frames():
        if row["predicted"]:
            parts.append(row["estimate"] / made.analysis.predictor.compare_cold())
    assert len(parts) >= 3 and min(parts) > 0.3 and np.median(parts) > 0.5 and max(parts) < 2.5, parts
