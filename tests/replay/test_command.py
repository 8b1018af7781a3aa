"""`restshape replay` as people and programs call it."""

import csv
import json

import numpy as np
import pytest
from small_scenes import drag, plate, write_scene, write_script

from restshape.replay.recording.recording import Recording

EVENTS = [
    *drag("window", (0.5, 0.5), [(0.52, 0.5), (0.54, 0.5), (9.0, 9.0), (0.56, 0.5)]),
    {"do": "idle", "frames": 2},
]
FRAMES = 1 + 1 + 4 + 1 + 2


@pytest.fixture
def scene(tmp_path):
    return write_scene(tmp_path, plate(0.15))


@pytest.fixture
def script(tmp_path):
    return write_script(tmp_path, EVENTS)


def read_json(path):
    """A file's JSON, without NaN and infinities."""

    def refuse(name):
        raise ValueError(name)

    return json.loads(path.read_text(), parse_constant=refuse)


def test_json_for_programs(tmp_path, command, scene, script):
    done = command("replay", scene, "--edits", script, "--json", "a.json")
    assert done.returncode == 0 and all(line.startswith("note:") for line in done.stderr.splitlines())
    found = read_json(tmp_path / "a.json")
    assert (found["frames"], found["refused"], found["ranks"], found["policy"]) == (FRAMES, 1, 1, "auto")
    assert found["levels"] == {"1": 3, "2": 0, "3": 0}
    assert set(found["ms"]) == {"all", "1", "2", "3", "still"}
    for times in found["ms"].values():
        assert set(times) == {"p50", "p95", "p99"} and times["p50"] <= times["p95"] <= times["p99"]
    assert 0 < found["python_ms"]["p50"] < found["ms"]["all"]["p50"]
    assert {"relocate", "pattern", "values", "factor", "krylov", "observe", "record"} <= set(found["stages"])
    assert set(found["quantities"]) == {"stretch", "peak", "wall", "energy"}
    assert all(len(values) == FRAMES for values in found["quantities"].values())
    assert found["stale"] == [int(values is None) for values in found["quantities"]["stretch"]]
    assert [i for i, stale in enumerate(found["stale"]) if stale] == [4]
    assert found["unknowns"] > found["elements"] > 100


def test_tables_for_people(command, scene, script):
    done = command("replay", scene, "--edits", script, "--strict")
    reported = done.stdout
    # One frame is refused.
    assert done.returncode == 1 and command("replay", scene, "--strict").returncode == 0
    assert reported.startswith(f"{FRAMES} frames, 1 refused, ")
    for words in ("1 relocation", "2 reconnection", "3 reconstruction", "p95", "stretch", "largest"):
        assert words in reported


def test_csv_and_recording_hold_the_same(tmp_path, command, scene, script):
    done = command("replay", scene, "--edits", script, "--csv", "a.csv", "--out", "a.vtkhdf")
    assert done.returncode == 0, done.stderr
    rows = list(csv.DictReader((tmp_path / "a.csv").open(newline="")))
    with Recording(tmp_path / "a.vtkhdf") as recording:
        assert recording.n == len(rows) == FRAMES and recording.status == "done"
        assert set(rows[0]) == set(recording.table)
        for name in ("index", "line", "level", "iterations", "pc_rebuilt", "unknowns"):
            assert [int(row[name]) for row in rows] == recording.table[name].tolist(), name
        for name in ("t", "q_stretch", "q_peak", "residual", "ms_python", "ms_estimate"):
            found = [float(row[name] or "nan") for row in rows]
            assert np.array_equal(found, recording.table[name], equal_nan=True), name
        # A row cannot say how long it takes to write it.
        assert all(float(row["ms"]) >= ms for row, ms in zip(rows, recording.table["ms"]))
        empty = [i for i, row in enumerate(rows) if row["q_stretch"] == ""]
        assert empty == np.flatnonzero(recording.table["stale"]).tolist() == [4]
        assert [row["event"] for row in rows] == list(recording.table["event"])
        assert [bool(row["refused"]) for row in rows] == [i == 4 for i in range(FRAMES)]
        assert recording.header["script_text"] == (tmp_path / "edits.jsonl").read_text()
        assert recording.header["policy"] == "auto" and recording.header["calibration"]["seconds"]


def test_set_changes_the_scene(tmp_path, command, scene):
    found = []
    for words in ((), ("--set", "material.steel.E=100e9", "--set", 'loads.pull.traction=["50 MPa", 0]')):
        assert command("replay", scene, *words, "--json", "a.json").returncode == 0
        found.append(read_json(tmp_path / "a.json")["quantities"])
    assert found[1]["stretch"][0] == pytest.approx(found[0]["stretch"][0], rel=1e-5)
    assert found[1]["wall"][0] == pytest.approx(found[0]["wall"][0] / 2, rel=1e-5)


def test_a_bad_line_keeps_the_frames_before_it(tmp_path, command, scene, script):
    lines = script.read_text().splitlines()
    script.write_text("\n".join([*lines[:3], '{"t": 0.15, "do": "fly"}', *lines[3:], ""]))
    done = command("replay", scene, "--edits", script, "--out", "a.vtkhdf", "--json", "a.json")
    assert done.returncode == 2 and "edits.jsonl: line 4" in done.stderr and "Traceback" not in done.stderr
    assert "the 6 frames before it were replayed and recorded" in done.stderr
    with Recording(tmp_path / "a.vtkhdf") as recording:
        assert recording.n == 6 and recording.verify() == []
    assert read_json(tmp_path / "a.json")["frames"] == 6


def test_one_frame_before_a_bad_line_is_one(command, scene, script):
    script.write_text("\n".join([script.read_text().splitlines()[0], '{"t": 0.15, "do": "fly"}', ""]))
    done = command("replay", scene, "--edits", script)
    assert done.returncode == 2 and done.stderr.endswith("\n  the frame before it was replayed\n")


def test_a_torn_last_line(tmp_path, command, scene, script):
    script.write_text(script.read_text()[:-12])
    done = command("replay", scene, "--edits", script, "--out", "a.vtkhdf")
    assert done.returncode == 2 and "torn" in done.stderr and "line 5" in done.stderr
    with Recording(tmp_path / "a.vtkhdf") as recording:
        assert recording.n == FRAMES - 2


@pytest.mark.parametrize("option", ["--out", "--json", "--csv"])
@pytest.mark.parametrize("place", ["nowhere/a.vtkhdf", "."])
def test_output_that_cannot_be_written(command, scene, script, option, place):
    done = command("replay", scene, "--edits", script, option, place)
    assert done.returncode == 2 and "Traceback" not in done.stderr and " try: " in done.stderr
    assert done.stdout == ""


def test_a_scene_is_not_overwritten_by_its_recording(command, scene):
    before = scene.read_text()
    done = command("replay", scene, "--out", scene)
    assert done.returncode == 2 and "the file that scene" in done.stderr and scene.read_text() == before


def test_a_policy_that_is_not_there(command, scene):
    done = command("replay", scene, "--policy", "fast")
    assert done.returncode == 2 and "fast" in done.stderr and "auto" in done.stderr


@pytest.mark.parametrize("name", ["auto", "thesis", "refactor", "rebuild"])
def test_parity_is_reported(tmp_path, command, scene, script, name):
    done = command("replay", scene, "--edits", script, "--policy", name, "--parity", "--json", "a.json")
    assert done.returncode == 0 and "parity with cold solves: holds" in done.stdout
    found = read_json(tmp_path / "a.json")["parity"]
    assert found["holds"] and found["entries"] <= 1e-13 and found["solution"] <= 1e-6


@pytest.mark.slow
def test_parity_that_fails_ends_with_1(restshape, scene, script):
    # The solver is asked to stop before the scene's tolerance.
    done = restshape("replay", scene, "--edits", script, "--parity", "--", "-solid_ksp_rtol", "1e-2")
    assert done.returncode == 1 and "FAILS" in done.stdout


@pytest.mark.slow
def test_petsc_options_after_two_dashes(restshape, scene, script):
    plain = restshape("replay", scene, "--edits", script)
    monitored = restshape("replay", scene, "--edits", script, "--", "-solid_ksp_monitor")
    assert monitored.returncode == 0, monitored.stderr
    assert "KSP Residual norm" not in plain.stdout and monitored.stdout.count("0 KSP Residual norm") >= 3


@pytest.mark.slow
def test_another_preconditioner_by_options(tmp_path, restshape, scene, script):
    words = ("replay", scene, "--edits", script, "--json", "a.json")
    done = restshape(*words, "--parity", "--", "-solid_pc_type", "jacobi")
    assert done.returncode == 0, done.stdout + done.stderr
    assert read_json(tmp_path / "a.json")["iterations"] > 100


def test_a_calibration_file(tmp_path, command, scene, script):
    (tmp_path / "c.json").write_text("{}")
    done = command("replay", scene, "--edits", script, "--calibration", "c.json")
    assert done.returncode == 2 and "c.json" in done.stderr
