"""Recordings of flow in time: VTK reads velocity, pressure and speed of each frame."""

import json

import numpy as np
import pytest
from read_by_vtk import point_fields
from restshape_apps.flow import application

from restshape.replay.recording.recording import Recording

SCENE = application.folder / "scenes" / "flow.toml"


@pytest.mark.slow
def test_vtk_reads_the_fields_of_each_frame(command, tmp_path):
    lines = [{"format": "restshape-edits", "version": 1, "units": "mm"}, {"t": 0.0, "do": "idle", "frames": 2}]
    lines += [{"t": 0.1, "do": "press", "on": "tail", "at": [5, 0]}]
    lines += [{"t": 0.2, "do": "drag", "path": [[9, 0], [13, 0]]}, {"t": 0.4, "do": "release"}]
    (tmp_path / "e.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
    done = command("replay", SCENE, "--edits", "e.jsonl", "--out", "out.vtkhdf", "--json", "out.json")
    assert done.returncode == 0, done.stderr
    frames = [*point_fields(tmp_path / "out.vtkhdf")]
    fastest = json.loads((tmp_path / "out.json").read_text())["quantities"]["fastest"]
    assert len(frames) == len(fastest) == 7
    with Recording(tmp_path / "out.vtkhdf") as recording:
        for i, found in enumerate(frames):
            X = recording.points(i)
            np.testing.assert_array_equal(found["points"][:, :2], X)
            for name in ("velocity", "pressure", "speed"):
                own = recording.field(i, name)
                np.testing.assert_array_equal(found[name][..., : own.shape[1]] if own.ndim == 2 else found[name], own)
            np.testing.assert_allclose(np.linalg.norm(found["velocity"], axis=1), found["speed"], rtol=1e-6, atol=1e-9)
            assert found["speed"].max() == pytest.approx(fastest[i], rel=1e-5)
    # The fluid goes in at the wind's speed, and stands still at the body, whose tail has moved.
    inlet = np.isclose(frames[-1]["points"][:, 0], -0.08)
    np.testing.assert_allclose(frames[-1]["velocity"][inlet, 0], 0.1, rtol=1e-6)
    tail = np.linalg.norm(frames[-1]["points"][:, :2] - (0.013, 0.0), axis=1).argmin()
    assert frames[-1]["speed"][tail] == 0.0
