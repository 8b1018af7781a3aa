"""Recordings of heat in fluids: VTK reads velocity, pressure and temperature of each frame."""

import json

import numpy as np
import pytest
from read_by_vtk import point_fields
from restshape_apps.thermal import application

SCENE = application.folder / "scenes" / "thermal.toml"


@pytest.mark.slow
def test_vtk_reads_the_fields_of_each_frame(command, tmp_path):
    lines = '{"format": "restshape-edits", "version": 1, "units": "mm"}\n{"t": 0, "do": "idle", "frames": 3}\n'
    (tmp_path / "e.jsonl").write_text(lines)
    done = command("replay", SCENE, "--edits", "e.jsonl", "--out", "out.vtkhdf")
    assert done.returncode == 0, done.stderr
    frames = [*point_fields(tmp_path / "out.vtkhdf")]
    assert len(frames) == 4
    for found in frames:
        assert {"velocity", "pressure", "temperature"} <= found.keys()
        (x, y), warm = found["points"][:, :2].T, found["temperature"]
        np.testing.assert_allclose(warm[y == 0.0], 294.15 - (x[y == 0.0] / 0.022) ** 4, rtol=1e-6)
        assert warm.min() > 293.0 and warm[y > 0.03].max() < 293.3
    # Warm water begins to rise.
    assert frames[-1]["velocity"][:, 1].max() > frames[1]["velocity"][:, 1].max() > 0.0


@pytest.mark.slow
def test_the_scene_with_a_fluid_that_new_writes_runs(command, tmp_path):
    assert command("new", "thermal", "mine", "--kind", "fluid").returncode == 0
    done = command("replay", "mine/scene.toml", "mine/edits.jsonl", "--parity", "--json", "out.json")
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "out.json").read_text())["quantities"]
    assert all(value < 0.0 for value in found["heating"]) and found["mean"][-1] < found["mean"][0]


def test_another_kind_of_template_is_refused(command):
    done = command("new", "thermal", "mine", "--kind", "gas")
    assert done.returncode == 2 and "there is no template of the kind 'gas'" in done.stderr
    assert "use one of: fluid" in done.stderr
