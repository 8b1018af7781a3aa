"""Two ranks give what one rank gives."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from small_scenes import across, drag, plate, write_scene, write_script

pytestmark = pytest.mark.mpi

EVENTS = [
    *drag("window", (0.5, 0.5), across((0.5, 0.5), (1.3, 0.5), 40)),
    {"do": "undo"},
    {"do": "delete", "on": "left"},
    {"do": "idle", "frames": 2},
]


def levels_of(table: Path) -> str:
    """The level of each frame."""
    with table.open() as file:
        return "".join(row["level"] for row in csv.DictReader(file))


@pytest.mark.parametrize("name", ["auto", "thesis", pytest.param("refactor", marks=pytest.mark.weekly)])
def test_replay(tmp_path, on_ranks, name):
    scene, script = write_scene(tmp_path, plate(0.07)), write_script(tmp_path, EVENTS)
    found = []
    for ranks in (1, 2):
        words = ("--edits", script, "--policy", name, "--json", f"{ranks}.json", "--set", "solve.tolerance=1e-9")
        done = on_ranks(ranks, "replay", scene, *words, "--parity", "--csv", f"{ranks}.csv")
        assert done.returncode == 0, done.stdout + done.stderr
        found.append(json.loads((tmp_path / f"{ranks}.json").read_text()))
    one, two = found
    assert (one["ranks"], two["ranks"]) == (1, 2)
    for key in ("frames", "refused", "levels", "unknowns", "elements"):
        assert one[key] == two[key], key
    assert one["refused"] == 1 and one["parity"]["holds"] and two["parity"]["holds"]
    levels = [levels_of(tmp_path / f"{ranks}.csv") for ranks in (1, 2)]
    assert levels[0] == levels[1]
    for quantity in one["quantities"]:
        pair = (np.array(run["quantities"][quantity], dtype=float) for run in (two, one))
        np.testing.assert_allclose(*pair, rtol=1e-5, err_msg=quantity)


def test_a_new_mesh_in_the_frame_after_a_flip(tmp_path, on_ranks):
    script, table = write_script(tmp_path, EVENTS), tmp_path / "levels.csv"
    # Which frames get new meshes is a matter of rounding, and so of the processor: one of some meshes does.
    for size in (0.07, 0.065, 0.075, 0.08, 0.085, 0.09):
        scene = write_scene(tmp_path, plate(size))
        assert on_ranks(1, "replay", scene, "--edits", script, "--csv", table).returncode == 0
        if "23" in levels_of(table):
            break
    before = levels_of(table)
    assert "23" in before
    done = on_ranks(2, "replay", scene, "--edits", script, "--csv", table, "--parity")
    assert done.returncode == 0, done.stdout + done.stderr
    assert levels_of(table) == before


def test_validation(tmp_path, on_ranks):
    cases = ("plane.patch", "solid.manufactured")
    done = on_ranks(2, "validate", *(w for case in cases for w in ("--case", case)), "--json", "v.json")
    assert done.returncode == 0, done.stdout + done.stderr
    rows = json.loads((tmp_path / "v.json").read_text())
    assert {row["case"] for row in rows} == set(cases) and all(row["passed"] for row in rows)


@pytest.mark.slow
def test_a_scene_that_cannot_be_simulated_ends_all_ranks(tmp_path, restshape):
    scene = write_scene(tmp_path, plate().replace('fix = ["x", "y"]', 'fix = ["x"]'))
    done = restshape("replay", scene, ranks=2)
    assert done.returncode == 2 and "free to move" in done.stderr and "Traceback" not in done.stderr


def test_one_recording_is_written(tmp_path, restshape):
    scene, script = write_scene(tmp_path, plate()), write_script(tmp_path, EVENTS)
    done = restshape("replay", scene, "--edits", script, "--out", "a.vtkhdf", "--csv", "a.csv", ranks=2)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count(" frames, ") == 1
    assert len((tmp_path / "a.csv").read_text().splitlines()) == 1 + 47


@pytest.mark.slow
def test_work_on_two_ranks_is_counted_once(tmp_path, on_ranks):
    """An application of block Jacobi is one of its blocks too; iterations at their price are the same work."""
    scene, script = write_scene(tmp_path, plate(0.1)), write_script(tmp_path, EVENTS)
    done = on_ranks(2, "replay", scene, script, "--regret", "--json", "a.json")
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count("times the best policy") == 1
    found = json.loads((tmp_path / "a.json").read_text())["regret"]
    assert found["policies"]["auto"]["seconds"] == pytest.approx(found["hindsight"]["run"], rel=0.2)
    assert found["over_policy"] <= 1.05
