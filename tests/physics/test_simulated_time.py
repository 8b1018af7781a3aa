"""The column of simulated time: steps times their size, whatever the edit time is."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from restshape_studies.stability.scenery import across, drag, make_replay, rows_of, write_scene, write_script
from thermal_scenes import COOLING, MANUFACTURED

from restshape.cli.main import main
from restshape.replay.recording.recording import Recording
from restshape.report.frames import caption
from restshape.report.scenery import scenery

BUILDING = Path(__file__).parents[1] / "scenes" / "building.toml"
SLOW = COOLING.replace("time_step = 0.5\nsteps = 1", "time_step = 0.5\nsteps = 4").replace("size = 0.05", "size = 0.5")


@pytest.fixture
def recorded(tmp_path):
    """A recording of three frames of 2 s each, with its CSV and JSON."""
    script = write_script(tmp_path, [{"do": "idle", "frames": 3}])
    out = tmp_path / "out.vtkhdf"
    words = ["--out", out, "--csv", tmp_path / "out.csv", "--json", tmp_path / "out.json"]
    scene = write_scene(tmp_path, SLOW)
    assert main(["replay", str(scene), "--edits", str(script), *map(str, words)]) == 0
    return out


def test_recording_csv_and_json_have_it(recorded):
    with Recording(recorded) as recording:
        np.testing.assert_allclose(recording.table["time"], [0.0, 2.0, 4.0, 6.0])
        assert recording.table["t"].max() < 0.1
    rows = list(csv.DictReader(recorded.with_suffix(".csv").read_text().splitlines()))
    assert [float(row["time"]) for row in rows] == [0.0, 2.0, 4.0, 6.0]
    assert json.loads(recorded.with_suffix(".json").read_text())["time"] == [0.0, 2.0, 4.0, 6.0]


def test_captions_show_it_where_it_is_not_the_edit_time(recorded):
    with Recording(recorded) as recording:
        assert recording.moments(0) == ["t = 0.00 s"]
        assert recording.moments(3) == ["t = 0.03 s", "sim. 6 s"]
        assert "sim. 6 s" in caption(recording, 3, scenery(recording), 60)


def test_recordings_without_it_have_captions(recorded):
    with Recording(recorded) as recording:
        del recording.table["time"]
        assert recording.moments(3) == ["t = 0.03 s"]


def test_steady_analyses_have_none(tmp_path):
    (row,) = rows_of(make_replay(write_scene(tmp_path, MANUFACTURED)))
    assert "time" not in row


def test_it_goes_on_over_new_meshes(tmp_path):
    text = SLOW + "[shape.holes.pipe]\ncircle = { center = [0.4, 0.5], radius = 0.1 }\n"
    script = write_script(tmp_path, drag("pipe", (0.4, 0.5), across((0.4, 0.5), (0.7, 0.6), 3)))
    rows = rows_of(make_replay(write_scene(tmp_path, text), script))
    np.testing.assert_allclose([row["time"] for row in rows], 2.0 * np.arange(len(rows)))


@pytest.mark.parametrize("effects", [(), ("effects.large_deformation={}",)])
def test_motions_have_it(tmp_path, effects):
    overrides = ["mesh.size=4", "mesh.near={}", "effects.dynamics.steps=3", "effects.dynamics.time_step=0.02", *effects]
    rows = rows_of(make_replay(BUILDING, write_script(tmp_path, [{"do": "idle", "frames": 2}]), overrides=overrides))
    np.testing.assert_allclose([row["time"] for row in rows], [0.0, 0.06, 0.12])
