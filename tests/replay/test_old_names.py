"""Recordings of an earlier version open: their columns, fields and limits are read by the names of today."""

import json

import numpy as np
import pytest
from cloths import BALL, CLOTH, CONTACT
from old_recordings import SCENE, make_old

from restshape.cli.main import main
from restshape.replay.columns import ALIASES, renamed
from restshape.replay.recording.recording import Recording
from restshape.report.recorded_quantities import limits_of

PLANE = SCENE + 'far = { displacement = "x", at = "right", reduce = "mean", max = "1 mm", min = -2e-3 }\n'
DRAPE = CLOTH.replace("[effects.gravity]", "[effects.cloth]\n[effects.gravity]") + BALL + CONTACT
SCENES = {
    "plane": (PLANE, {"pc_age": "age", "constraint_status": "verdict"}),
    "cloth": (DRAPE, {"converged": "at_rest", "tangent_positive_definite": "stable", "max_penetration": "deepest"}),
}


@pytest.fixture(scope="module", params=list(SCENES))
def recording(request, tmp_path_factory):
    """A recording with the names of version 0.1, some of them, and what it held and reported with those of today."""
    folder = tmp_path_factory.mktemp("old")
    scene, path = folder / "scene.toml", folder / "old.vtkhdf"
    text, old_names = SCENES[request.param]
    scene.write_text(text)
    assert main(["replay", str(scene), "--out", str(path)]) == 0
    today = read(path)
    assert not today[0]
    make_old(path)
    return path, old_names, today


def read(path):
    """Old names, the table, the fields of the first frame, limits, and the report for programs."""
    data = path.with_suffix(".json")
    with Recording(path) as one:
        fields = {name: one.field(0, name) for name in one.fields}
        found = one.old_names, one.table, fields, limits_of(one)
    assert main(["report", str(path), "--animation", "none", "--json", str(data)]) == 0
    return *found, json.loads(data.read_text())


@pytest.mark.slow
def test_all_is_read_by_the_names_of_today(recording, capsys):
    path, expected, (_, table, fields, limits, report) = recording
    old_names, *found = read(path)
    assert expected.items() <= old_names.items()
    for there, here in zip(found[:2], (table, fields), strict=True):
        assert there.keys() == here.keys()
        for name, values in here.items():
            np.testing.assert_array_equal(there[name], values)
    assert found[2:] == [limits, report]
    assert "note: columns of an earlier version" in capsys.readouterr().out


def test_limits_are_those_of_the_recorded_scene(recording):
    path, _, (_, _, _, limits, report) = recording
    with Recording(path) as old:
        assert "limits" not in old.header and limits_of(old) == limits
    assert limits == ({"far": {"max": 1e-3, "min": -2e-3}} if report["quantities"] else {})


def test_no_old_name_hides_a_new_one():
    assert not set(ALIASES) & set(ALIASES.values())
    assert renamed({"age": 1, "pc_age": 2}) == {"age": 1, "pc_age": 2}
