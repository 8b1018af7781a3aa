"""Buckling on two ranks, which share its matrices: load factors are those of one rank, and their bits repeat."""

import csv
import json

import numpy as np
import pytest
from modal import SCENES
from small_scenes import write_script

pytestmark = pytest.mark.mpi

SETTINGS = ("--set", 'mesh.size="25 mm"', "--set", "effects.buckling.modes=3", "--set", "solve.tolerance=1e-6")
DRAG = [
    {"do": "press", "on": "right", "at": [0.05, 0.5]},
    {"do": "drag", "path": [[0.046, 0.5]], "frames": 4},
    {"do": "release"},
    {"do": "idle", "frames": 1},
]


def rows(path):
    with path.open() as file:
        return list(csv.DictReader(file))


def test_load_factors_are_those_of_one_rank(tmp_path, on_ranks):
    edits, found = write_script(tmp_path, DRAG), {}
    for name, ranks in (("one", 1), ("two", 2), ("again", 2)):
        reported = ("--json", f"{name}.json", "--csv", f"{name}.csv", *(["--parity"] if name == "two" else []))
        words = ("replay", SCENES / "column.toml", "--edits", edits, *SETTINGS, *reported)
        done = on_ranks(ranks, *words)
        assert done.returncode == 0, done.stdout + done.stderr
        found[name] = rows(tmp_path / f"{name}.csv")
    assert json.loads((tmp_path / "two.json").read_text())["parity"]["holds"]
    assert [row["mode_ids"] for row in found["two"]] == [row["mode_ids"] for row in found["one"]]
    for column in ("mu_1", "mu_2"):
        one, two = (np.array([float(row[column]) for row in found[name]]) for name in ("one", "two"))
        np.testing.assert_allclose(two, one, rtol=1e-8)
        assert [row[column] for row in found["two"]] == [row[column] for row in found["again"]]
    # In the frame in which the hand has let go they are counted.
    assert any(row["inertia_checked"] == "1" for row in found["two"][1:])
