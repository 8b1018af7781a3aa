"""Recordings of an earlier version open: their columns and fields are read by the names of today."""

import h5py
import numpy as np
import pytest

from restshape.cli.main import main
from restshape.replay.columns import ALIASES, renamed
from restshape.replay.recording import Recording

SCENE = """
format = "restshape-scene"
version = 1
app = "plane"
[shape]
outline = ["bottom", "right", "top", "left"]
vertices = { a = [0, 0], b = [1, 0], c = [1, 1], d = [0, 1] }
edges.bottom = { line = ["a", "b"] }
edges.right = { line = ["b", "c"] }
edges.top = { line = ["c", "d"] }
edges.left = { line = ["d", "a"] }
[material.m]
E = 1e9
nu = 0.3
thickness = 1
[supports.wall]
on = "left"
fix = ["x", "y"]
[loads.pull]
on = "right"
force = [1e3, 0]
[mesh]
size = 0.3
[quantities]
far = { displacement = "x", at = "right", max = "1 m" }
"""


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    """A recording of one frame whose columns have the names of version 0.1, and the columns as they were written."""
    folder = tmp_path_factory.mktemp("old")
    scene, path = folder / "scene.toml", folder / "old.vtkhdf"
    scene.write_text(SCENE)
    assert main(["replay", str(scene), "--out", str(path)]) == 0
    with Recording(path) as today:
        assert not today.old_names
        table = today.table
    with h5py.File(path, "r+") as file:
        rows = file["restshape/table"][()]
        rows.dtype.names = tuple(ALIASES.get(name, name) for name in rows.dtype.names)
        attributes = dict(file["restshape/table"].attrs)
        del file["restshape/table"]
        file["restshape"].create_dataset("table", data=rows, maxshape=(None,), chunks=True).attrs.update(attributes)
    return path, table


def test_columns_are_read_by_the_names_of_today(recording):
    path, table = recording
    with Recording(path) as old:
        assert old.table.keys() == table.keys()
        assert old.old_names["pc_age"] == "age" and old.old_names["constraint_status"] == "verdict"
        assert old.table["constraint_status"][0] == "holds"
        for name, values in table.items():
            np.testing.assert_array_equal(old.table[name], values)


def test_a_report_of_an_old_recording_notes_the_names(recording, capsys):
    assert main(["report", str(recording[0]), "--animation", "none"]) == 0
    assert "note: columns of an earlier version" in capsys.readouterr().out


def test_no_old_name_hides_a_new_one():
    assert not set(ALIASES) & set(ALIASES.values())
    assert renamed({"age": 1, "pc_age": 2}) == {"age": 1, "pc_age": 2}
