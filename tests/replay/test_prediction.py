"""Drags that are predicted: what is shown between solved frames, and which frames are solved."""

import json
from pathlib import Path

import numpy as np
import pytest
from small_scenes import CLAMPED, PULLED, across, drag, make_replay, plate, rows_of, write_scene, write_script

from restshape.application import application
from restshape.errors import UserError
from restshape.replay import predicted_frames
from restshape.replay.columns import columns_of
from restshape.replay.parity import Parity
from restshape.replay.recording.recorder import Recorder
from restshape.replay.recording.recording import Recording
from restshape.scene.load import load_scene

SHORT = drag("window", (0.5, 0.5), across((0.5, 0.5), (0.54, 0.53), 8))
LONG = drag("window", (0.5, 0.5), across((0.5, 0.5), (1.3, 0.55), 60))
DOUBTED = "solved: its prediction would be off by about"
EXACT = ["solve.tolerance=1e-11"]
LARGE = plate().replace("200e9", "4e9") + "[effects.large_deformation]\n"
KINDS = {"linear": plate(), "large": LARGE, "second order": plate(0.2, 2)}


def both(tmp_path, events, text=None, overrides=EXACT, policy="auto"):
    """(predicted, solved) rows of the same edits, and the displacements of every frame."""
    scene, script = write_scene(tmp_path, text or plate()), write_script(tmp_path, events)
    found = []
    for predict in ("linear", "none"):
        made = make_replay(scene, script, policy, overrides, predict=predict)
        shown = []
        rows = rows_of(made, lambda row, made=made, shown=shown: shown.append(made.analysis.x.copy()))
        found.append((rows, shown))
    return found


def distance(x, exact):
    """The relative distance of two displacements."""
    return np.linalg.norm(x - exact) / np.linalg.norm(exact)


@pytest.mark.parametrize("kind", KINDS)
def test_a_drag_is_shown_to_first_order_and_solved_on_release(tmp_path, kind):
    (rows, shown), (true, exact) = both(tmp_path, SHORT, KINDS[kind])
    assert [row["predicted"] for row in rows] == [0, 0, *[1] * 8, 0]
    assert [row["level"] for row in rows] == [row["level"] for row in true]
    moved = range(2, 10)
    # Nothing is assembled or solved while the hand moves.
    for i in moved:
        row = rows[i]
        assert row["iterations"] == 0 and row["ms_values"] == row["ms_krylov"] == row["ms_factor"] == 0.0
    errors = [distance(shown[i], exact[i]) for i in moved]
    # Twice as far, four times the error.
    assert errors[7] / errors[3] == pytest.approx(4.0, rel=0.15) and errors[3] / errors[1] == pytest.approx(
        4.0, rel=0.15
    )
    assert 1e-5 < errors[-1] < 0.02
    assert rows[-1]["iterations"] > 0 and distance(shown[-1], exact[-1]) < 1e-8
    assert rows[-1]["q_stretch"] == pytest.approx(true[-1]["q_stretch"], rel=1e-8)
    # The derivative predicts better than the last solution does.
    assert errors[-1] < 0.1 * distance(shown[0], exact[9])


def test_quantities_and_residual_are_those_of_what_is_shown(tmp_path):
    (rows, _), (true, _) = both(tmp_path, SHORT)
    for row, other in zip(rows[2:10], true[2:10]):
        assert row["q_stretch"] == pytest.approx(other["q_stretch"], rel=1e-2)
        assert row["q_wall"] == pytest.approx(other["q_wall"], rel=2e-2)
    residuals = [row["residual"] for row in rows[2:10]]
    # Forces out of balance grow with the square of the way too.
    assert residuals[7] / residuals[3] == pytest.approx(4.0, rel=0.15)
    assert rows[-1]["residual"] < 1e-10 and rows[1]["residual"] < 1e-10


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_frames_that_flip_or_remesh_are_solved_and_predicted_from(tmp_path, kind):
    (rows, shown), (true, exact) = both(tmp_path, LONG, KINDS[kind])
    levels = [row["level"] for row in rows]
    assert levels == [row["level"] for row in true] and 2 in levels and 3 in levels
    for i, row in enumerate(rows):
        doubted = row["note"].startswith(DOUBTED)
        assert row["predicted"] == int(row["event"] == "drag" and row["level"] == 1 and not doubted)
        if not row["predicted"]:
            assert distance(shown[i], exact[i]) < 1e-7
    after = [i for i in range(3, len(rows)) if rows[i]["predicted"] and not rows[i - 1]["predicted"]]
    assert len(after) >= 2
    assert max(distance(shown[i], exact[i]) for i in after) < 5e-3


WIDE = drag("window", (0.5, 0.5), across((0.5, 0.5), (0.8, 0.62), 12))
"""Far from where it begins, in large frames."""


def test_predictions_that_are_far_off_are_solved(tmp_path, monkeypatch):
    """With a lower bound than the usual one, which the estimate of each frame gives for the next."""
    text = plate(0.2, 2)
    monkeypatch.setattr(predicted_frames, "TRUSTED", np.inf)
    (rows, shown), (_, exact) = both(tmp_path, WIDE, text)
    off = [distance(shown[i], exact[i]) for i in range(len(rows)) if rows[i]["predicted"]]
    estimates = [row["estimate"] for row in rows if row["predicted"]]
    assert max(estimates) > 0.2 and max(off) > 0.04
    monkeypatch.setattr(predicted_frames, "TRUSTED", 0.05)
    (rows, shown), _ = both(tmp_path, WIDE, text)
    doubted = [i for i, row in enumerate(rows) if row["note"].startswith(DOUBTED)]
    assert doubted and all(not rows[i]["predicted"] and distance(shown[i], exact[i]) < 1e-7 for i in doubted)
    guarded = [row["estimate"] for row in rows if row["predicted"]]
    assert len(guarded) > len(rows) / 2 and max(guarded) < 0.055
    # The next frames are predicted from there.
    assert any(rows[i + 1]["predicted"] for i in doubted)


def test_many_unknowns_are_estimated_where_the_hand_has_gone_far(tmp_path, monkeypatch):
    """The others have the last estimate, grown with the square of the way; `every` and numbers ask for their own."""
    events = drag("window", (0.5, 0.5), across((0.5, 0.5), (0.62, 0.55), 12))
    scene, script = write_scene(tmp_path, plate(0.2, 2)), write_script(tmp_path, events)
    found = {}
    for many, when in ((np.inf, "auto"), (0, "auto"), (0, "every")):
        monkeypatch.setattr(predicted_frames, "MANY", many)
        made = make_replay(scene, script, overrides=[f"solve.estimate={when}"], predict="linear")
        found[many, when] = [row for row in rows_of(made) if row["predicted"]]
    each, few, every = found.values()
    own = [row["index"] for row in few if np.isfinite(row["residual"])]
    assert len(own) <= 4 < 8 < len(few) and own[0] == few[0]["index"]
    assert all(np.isfinite(row["residual"]) for row in each + every)
    for row, exact, asked in zip(few, each, every):
        assert asked["estimate"] == exact["estimate"]
        for name in ("estimate", "stretch_distance"):
            assert row[name] == pytest.approx(exact[name], rel=1e-12 if row["index"] in own else 0.5)


def test_a_first_frame_that_goes_far_is_solved(tmp_path, monkeypatch):
    monkeypatch.setattr(predicted_frames, "TRUSTED", 0.05)
    events = drag("window", (0.5, 0.5), across((0.5, 0.5), (0.75, 0.6), 1))
    (rows, shown), (_, exact) = both(tmp_path, events, plate(0.2, 2))
    assert rows[2]["event"] == "drag" and rows[2]["level"] == 1
    assert rows[2]["note"].startswith(DOUBTED) and distance(shown[2], exact[2]) < 1e-7


@pytest.mark.slow
@pytest.mark.parametrize("policy", ["auto", "refactor"])
def test_parity_holds_in_solved_frames(tmp_path, policy):
    script = write_script(tmp_path, LONG)
    made = make_replay(write_scene(tmp_path, plate()), script, policy, predict="linear")
    check = Parity(made)
    predicted = [check() and made.row["predicted"] for _ in made.frames()]
    found = check.summary()
    assert found["holds"] and 0 < sum(predicted) < len(predicted) == found["frames"]
    assert sum(found["compared"].values()) + sum(found["left_out"].values()) == len(predicted)
    assert found["left_out"]["predicted"] == sum(predicted) and found["prediction"] > 0.0


def test_the_same_bits_twice(tmp_path):
    scene, script = write_scene(tmp_path, plate()), write_script(tmp_path, LONG)
    found = []
    for _ in range(2):
        made = make_replay(scene, script, predict="linear")
        found.append([made.analysis.x.tobytes() for _ in made.frames()])
    assert found[0] == found[1]


def test_values_set_while_the_hand_holds(tmp_path):
    events = [
        *SHORT[:2],
        {"do": "set", "key": "loads.pull.traction", "value": ["200 MPa", 0]},
        {"do": "idle", "frames": 2},
        {"do": "drag", "to": [0.541, 0.531]},
        {"do": "release"},
    ]
    (rows, shown), (_, exact) = both(tmp_path, events)
    assert [row["predicted"] for row in rows] == [0, 0, *[1] * 8, 0, 0, 0, 1, 0]
    assert distance(shown[10], exact[10]) < 1e-8 and distance(shown[13], exact[13]) < 1e-3
    assert shown[10].max() > 1.5 * shown[9].max()


def test_a_pause_shows_what_the_drag_has_shown(tmp_path):
    events = [*SHORT[:2], {"do": "idle", "frames": 2}, {"do": "release"}]
    (rows, shown), _ = both(tmp_path, events)
    assert [row["predicted"] for row in rows[9:]] == [1, 1, 1, 0]
    assert np.array_equal(shown[9], shown[11]) and rows[11]["q_peak"] == rows[9]["q_peak"]


def test_motions_without_a_hand_are_solved(tmp_path):
    events = [{"do": "rotate", "on": "window", "by": 0.1, "frames": 2}, *SHORT, {"do": "undo"}, {"do": "redo"}]
    (rows, shown), (_, exact) = both(tmp_path, events)
    assert [row["predicted"] for row in rows] == [0, 0, 0, 0, *[1] * 8, 0, 0, 0]
    assert max(distance(shown[i], exact[i]) for i in (1, 2, 13, 14)) < 1e-8


FORMULA = plate().replace(PULLED, '[loads.pull]\non = "right"\ntraction = ["S*sqrt(limit - x)", 0]\n') + (
    "[parameters]\nS = 1e8\nlimit = 2.05\n"
)


def test_a_load_that_ends_within_a_drag(tmp_path):
    # Beyond the limit there is no load: those frames are refused, and the drag goes on from the last good place.
    events = drag("right", (2.0, 0.5), [(2.005, 0.5), (2.01, 0.5), (2.2, 0.5), (2.015, 0.5)])
    (rows, shown), (true, exact) = both(tmp_path, events, FORMULA)
    assert [bool(row["refused"]) for row in rows] == [bool(row["refused"]) for row in true]
    assert [row["predicted"] for row in rows] == [0, 0, 1, 1, 1, 1, 0]
    assert "not a finite number" in rows[4]["refused"] and np.array_equal(shown[4], shown[3])
    assert distance(shown[5], exact[5]) < 0.05 and distance(shown[6], exact[6]) < 1e-8


def test_a_load_without_derivative_is_solved_and_says_so(tmp_path):
    # sqrt(x) at x = 0, where the hand pulls.
    grabbed = CLAMPED.replace("left", "right")
    text = plate().replace(PULLED, '[loads.a]\non = "top"\ntraction = ["1e6*sqrt(x)", 0]\n').replace(CLAMPED, grabbed)
    (rows, shown), (_, exact) = both(tmp_path, drag("d", (0.0, 1.0), [(0.01, 1.0), (0.02, 1.0)]), text)
    assert "no derivative" in rows[1]["note"] and rows[1]["predicted"] == rows[2]["predicted"] == 0
    assert distance(shown[2], exact[2]) < 1e-8


def test_springs_and_arcs_are_solved_and_say_so(tmp_path):
    (rows, _), _ = both(tmp_path, SHORT, policy="thesis")
    assert not any(row["predicted"] for row in rows) and "springs" in rows[1]["note"]
    (rows, _), _ = both(tmp_path, [{"do": "arc", "on": "top", "bulge": 0.1, "frames": 2}])
    assert not any(row["predicted"] for row in rows) and "arc" in rows[2]["note"]


def test_a_refused_frame_has_no_note_of_the_one_before(tmp_path):
    bent = {"do": "arc", "on": "top", "bulge": 0.1, "frames": 2}
    (rows, _), _ = both(tmp_path, [bent, {"do": "scale", "on": "window", "factor": 9}])
    assert rows[-1]["refused"] and "arc" in rows[-2]["note"] and rows[-1]["note"] == ""


def test_new_meshes_in_each_frame_cannot_be_predicted(tmp_path):
    with pytest.raises(UserError, match="rebuild"):
        make_replay(write_scene(tmp_path, plate()), None, "rebuild", predict="linear")


def test_recording_holds_predicted_fields(tmp_path):
    scene, script = write_scene(tmp_path, plate()), write_script(tmp_path, SHORT)
    columns = columns_of(load_scene(scene), application("plane"), predict="linear")
    with Recorder.start(tmp_path / "a.vtkhdf", {}, columns) as recorder:
        made = make_replay(scene, script, recorder=recorder, predict="linear")
        shown = [made.analysis.x.copy() for _ in made.frames()]
    with Recording(tmp_path / "a.vtkhdf") as recording:
        assert recording.verify() == []
        assert recording.table["predicted"].tolist() == [0, 0, *[1] * 8, 0]
        for i, x in enumerate(shown):
            assert np.array_equal(recording.field(i, "displacement")[:, :2], x)


def test_the_command(tmp_path, command):
    write_scene(tmp_path, plate())
    write_script(tmp_path, SHORT)
    done = command("replay", "scene.toml", "--edits", "edits.jsonl", "--predict", "linear", "--json", "a.json")
    assert done.returncode == 0 and "8 frames predicted" in done.stdout
    summary = json.loads((tmp_path / "a.json").read_text())
    assert summary["predicted"] == 8 and set(summary["predicted_ms"]) == {"p50", "p95", "p99"}


def test_a_motion_cannot_be_predicted(command):
    scene = Path(__file__).parents[1] / "scenes" / "building.toml"
    done = command("replay", scene, "--predict", "linear")
    assert done.returncode == 2 and "--predict" in done.stderr and "time integration" in done.stderr


@pytest.mark.parametrize("kind", ["linear", "large"])
def test_two_ranks_predict_the_same(tmp_path, on_ranks, kind):
    write_scene(tmp_path, KINDS[kind])
    write_script(tmp_path, LONG)
    found = []
    for ranks in (1, 2):
        words = ("--edits", "edits.jsonl", "--predict", "linear", "--set", "solve.tolerance=1e-10", "--json", "a.json")
        done = on_ranks(ranks, "replay", "scene.toml", *words)
        assert done.returncode == 0, done.stderr
        found.append(json.loads((tmp_path / "a.json").read_text()))
    assert found[0]["predicted"] == found[1]["predicted"] > 20
    for name, values in found[0]["quantities"].items():
        np.testing.assert_allclose(found[1]["quantities"][name], values, rtol=1e-6, err_msg=name)


def test_supports_that_move_with_their_place_hold_in_predicted_frames(tmp_path):
    grabbed = '[supports.end]\non = "right"\nfix = { x = 0, y = "0.001*x^2" }\n'
    text = plate().replace(PULLED, grabbed)
    scene = write_scene(tmp_path, text)
    script = write_script(tmp_path, drag("right", (2.0, 0.5), across((2.0, 0.5), (2.3, 0.5), 5)))
    for name in ("scene.toml", "large.toml"):
        path = scene if name == "scene.toml" else write_scene(tmp_path, text + "[effects.large_deformation]\n", name)
        made, gaps, predicted = make_replay(path, script, overrides=EXACT, predict="linear"), [], 0
        for row in made.frames():
            mesh = made.analysis.space
            nodes = mesh.nodes_of("right")
            gaps.append(np.abs(made.analysis.x[nodes, 1] - 0.001 * mesh.X[nodes, 0] ** 2).max())
            predicted += row["predicted"]
        assert predicted == 5 and max(gaps) < 1e-15


def test_limits_that_predictions_and_solutions_see_differently_are_uncertain(tmp_path):
    """The limit is between what is predicted and what is solved for the same shape; the shape's area is exact."""
    events = drag("window", (0.5, 0.5), across((0.5, 0.5), (0.9, 0.5), 4))
    (rows, _), (true, _) = both(tmp_path, events)
    k = max((k for k in range(len(rows)) if rows[k]["predicted"]), key=lambda k: rows[k]["estimate"])
    value, solved = rows[k]["q_energy"], true[k]["q_energy"]
    assert abs(solved - value) > 1e-4 * value
    limits = {"energy": 0.5 * (value + solved), "area": rows[k]["mesh_area"] * (1.0 + 1e-6)}
    for name, status in (("energy", "uncertain"), ("area", "holds")):
        text = plate().replace(
            "energy = {", f"energy = {{ max = {limits[name]!r}," if name == "energy" else "energy = {"
        )
        text += f"space = {{ area = true, max = {limits[name]!r} }}\n" if name == "area" else ""
        shown = rows_of(
            make_replay(write_scene(tmp_path, text), tmp_path / "edits.jsonl", "auto", EXACT, predict="linear")
        )
        assert shown[k]["predicted"] and shown[k]["constraint_status"] == status
    # Far from what is predicted, nothing is uncertain.
    far = value * (1.0 + 2.0 * rows[k]["estimate"])
    text = plate().replace("energy = {", f"energy = {{ max = {far!r},")
    shown = rows_of(make_replay(write_scene(tmp_path, text), tmp_path / "edits.jsonl", "auto", EXACT, predict="linear"))
    assert shown[k]["constraint_status"] == "holds"


def test_tables_name_the_frames_that_errors_are_of(tmp_path, command):
    text = plate().replace("stretch = {", "stretch = { error = true,")
    scene, script = write_scene(tmp_path, text), write_script(tmp_path, SHORT)
    for words, said in ((["--predict", "linear"], True), ([], False)):
        done = command("replay", str(scene), str(script), *words)
        assert ("largest estimated error, solved frames" in done.stdout) == said, done.stdout
        assert ("values of predicted frames are further off" in done.stdout) == said
