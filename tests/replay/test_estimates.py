"""Error estimates beside the frames of a replay: what is reported when, at no cost to the answer."""

import json

import numpy as np
import pytest
from modal import EDITS as BARS
from modal import SCENES as METALLOPHONE
from modal import replay as modal_replay
from small_scenes import across, drag, make_replay, plate, rows_of, write_scene, write_script

from restshape.analysis.correction import largest_values
from restshape.application import application
from restshape.replay.columns import ESTIMATES, columns_of
from restshape.replay.recording.recorder import Recorder
from restshape.replay.recording.recording import Recording
from restshape.replay.summary import summarise
from restshape.report.tables import estimate_table

SHORT = drag("window", (0.5, 0.5), across((0.5, 0.5), (0.54, 0.53), 8))
LARGE = plate().replace("200e9", "4e9") + "[effects.large_deformation]\n"
KINDS = {"linear": plate(), "large": LARGE, "second order": plate(0.2, 2)}
REFUSED = [*drag("window", (0.5, 0.5), [[0.55, 0.5], [0.5, 5.0], [0.6, 0.5]]), {"do": "delete", "on": "left"}]


@pytest.mark.parametrize("policy", ["auto", "refactor"])
@pytest.mark.parametrize("kind", KINDS)
def test_prediction_reports_its_distance_from_the_solution(tmp_path, kind, policy):
    """Frame by frame against a replay that solves; on release against the solve that follows."""
    scene, script = write_scene(tmp_path, KINDS[kind]), write_script(tmp_path, SHORT)
    tight = ["solve.tolerance=1e-10"]
    ahead, solved = (make_replay(scene, script, policy, tight, predict=p) for p in ("linear", "none"))
    rows = []
    for row, _ in zip(ahead.frames(), solved.frames()):
        rows.append(row)
        if row["predicted"]:
            true = solved.analysis.predictor.error(ahead.analysis.x)
            assert row["estimate"] == pytest.approx(true, rel=0.05)
    assert [row["predicted"] for row in rows] == [0, 0, *[1] * 8, 0]
    assert np.isnan([row["prediction_error"] for row in rows[:-1]]).all()
    assert rows[-1]["prediction_error"] == pytest.approx(rows[-2]["estimate"], rel=0.05)
    # The way squared; and what the mesh does is reported where there is a solution.
    assert rows[9]["estimate"] / rows[5]["estimate"] == pytest.approx(4.0, rel=0.2)
    assert rows[-1]["estimate"] == pytest.approx(rows[0]["estimate"], rel=0.2)


@pytest.mark.parametrize("model", ["solid", "plate"])
def test_predicted_frequencies(model):
    overrides = [f"effects.modal.model={model}", "mesh.size=0.01", "mesh.order=1", "effects.modal.modes=3"]
    tight = [*overrides, "solve.tolerance=1e-8"]
    ahead, solved = (
        modal_replay("bar_100.toml", BARS / "remainder.jsonl", tight, predict=p) for p in ("linear", "none")
    )
    compared = 0
    for row, other in zip(ahead.frames(), solved.frames()):
        if row["predicted"]:
            true = max(abs(row[f"f_{k}"] / other[f"f_{k}"] - 1.0) for k in (1, 2, 3))
            if true > 1e-9:
                assert row["estimate"] == pytest.approx(true, rel=0.15)
                compared += 1
    assert compared >= 2


def test_estimates_change_nothing(tmp_path, monkeypatch):
    """The same bits with them and without, in a drag that is predicted in parts."""
    scene = write_scene(tmp_path, plate())
    script = write_script(tmp_path, drag("window", (0.5, 0.5), across((0.5, 0.5), (1.3, 0.55), 40)))
    found = []
    for _ in range(2):
        replay = make_replay(scene, script, predict="linear")
        found.append([(replay.analysis.x.tobytes(), row["iterations"], row["pc_age"]) for row in replay.frames()])
        monkeypatch.setattr(
            "restshape.replay.frame_errors.FrameErrors._estimates", lambda *_: dict.fromkeys(ESTIMATES, 0.0)
        )
    assert found[0] == found[1]


def test_estimates_of_modes_change_nothing(monkeypatch):
    found = []
    for _ in range(2):
        replay = modal_replay("bar_100.toml", BARS / "remainder.jsonl", ["mesh.size=0.012"], predict="linear")
        found.append(
            [
                (replay.analysis.state.modes.vectors.tobytes(), row["iterations"], row["pc_age"])
                for row in replay.frames()
            ]
        )
        monkeypatch.setattr(
            "restshape.replay.frame_errors.FrameErrors._estimates", lambda *_: dict.fromkeys(ESTIMATES, 0.0)
        )
    assert found[0] == found[1]


def test_frames_without_an_answer_of_their_own_have_no_estimate(tmp_path):
    replay = make_replay(write_scene(tmp_path, plate()), write_script(tmp_path, REFUSED))
    rows = rows_of(replay)
    refused = [bool(row["refused"]) for row in rows]
    assert any(refused) and not all(refused)
    assert [bool(np.isnan(row["estimate"])) for row in rows] == refused
    assert np.isnan([row["estimate_time"] for row in rows]).all()
    script = write_script(tmp_path, [*SHORT, {"do": "analyse"}])
    script.write_text(script.read_text().replace('"units": "m"', '"units": "m", "analysis": "on demand"'))
    rows = rows_of(make_replay(write_scene(tmp_path, plate()), script))
    # The first shape is solved, and shown until the hand moves it.
    assert [row["event"] for row in rows if np.isfinite(row["estimate"])] == ["start", "press", "analyse"]


def test_recording_and_tables_hold_them(tmp_path):
    replay = make_replay(write_scene(tmp_path, plate()), write_script(tmp_path, SHORT), predict="linear")
    with Recorder.start(
        tmp_path / "a.vtkhdf", {}, columns_of(replay.session.scene, application("plane"), predict="linear")
    ) as recorder:
        replay.recorder = recorder
        rows = rows_of(replay)
    with Recording(tmp_path / "a.vtkhdf") as recording:
        for name in ESTIMATES:
            np.testing.assert_array_equal(recording.table[name], [row[name] for row in rows])
        table = {row["error"]: row for row in estimate_table(recording)}
    assert table["estimate, of the mesh"]["frames"] == 3 and table["estimate, of predicted frames"]["frames"] == 8
    assert table["predicted against solved"]["max"] == rows[-1]["prediction_error"]
    found = summarise(rows, "auto", 1)
    assert found["predicted_estimate"]["max"] == table["estimate, of predicted frames"]["max"]
    assert found["estimate_time"] == {"p50": None, "max": None}


def test_summary_has_them(tmp_path, command):
    scene = METALLOPHONE / "bar_100.toml"
    words = ("--set", "mesh.size=0.012", "--predict", "linear", "--json", "a.json", "--csv", "a.csv")
    done = command("replay", scene, "--edits", BARS / "remainder.jsonl", *words)
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "a.json").read_text())
    assert found["estimate"]["of"] == "frequencies" and 0.1 < found["estimate"]["p50"] <= found["estimate"]["max"]
    assert found["prediction_error"]["max"] > 0.0 and found["estimate_time"] == {"p50": None, "max": None}
    lines = [line for line in done.stdout.splitlines() if "estimated error" in line]
    assert len(lines) == 1 and lines[0].startswith("estimated error (frequencies): median ")
    assert "predicted against solved, where a solve followed: at most" in done.stdout and "cents)" in done.stdout


@pytest.mark.mpi
def test_two_ranks_estimate_the_same(tmp_path, on_ranks):
    scene, script = write_scene(tmp_path, plate(0.1)), write_script(tmp_path, SHORT)
    found = []
    for ranks in (1, 2):
        words = ("--edits", script, "--predict", "linear", "--set", "solve.tolerance=1e-9", "--json", f"{ranks}.json")
        done = on_ranks(ranks, "replay", scene, *words)
        assert done.returncode == 0, done.stdout + done.stderr
        found.append(json.loads((tmp_path / f"{ranks}.json").read_text()))
    one, two = found
    for key, slack in (("estimate", 1e-6), ("predicted_estimate", 0.05), ("prediction_error", 1e-4)):
        for part in ("p50", "max"):
            assert two[key][part] == pytest.approx(one[key][part], rel=slack), (key, part)


def test_largest_values_where_vectors_repeat():
    rng = np.random.default_rng(1)
    B = rng.standard_normal((5, 3))
    a, b = np.diag([1.0, 5.0, 9.0]), np.diag([2.0, 1.0, 3.0])
    assert largest_values(B @ a @ B.T, B @ b @ B.T, 3) == pytest.approx([0.5, 3.0, 5.0], rel=1e-6)
