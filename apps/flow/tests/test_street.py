"""The Strouhal number of the street behind the blunt body."""

import numpy as np
import pytest
from restshape_apps.flow import application
from restshape_studies.stability.scenery import make_replay, write_scene, write_script

SCENE = application.folder / "scenes" / "flow.toml"
ASKED = 'street = { strouhal = { speed = "0.1 m/s", length = "20 mm" }, at = "body" }\n'


@pytest.mark.slow
def test_the_street_behind_the_blunt_body(tmp_path):
    """By the passages of its mean as well, also after a new mesh, on which the swing goes on."""
    new_mesh = {"do": "set", "key": "mesh.size", "value": 0.0108}
    events = [{"do": "idle", "frames": 250}, new_mesh, {"do": "idle", "frames": 3}]
    made = make_replay(write_scene(tmp_path, SCENE.read_text() + ASKED), write_script(tmp_path, events))
    rows = [dict(row) for row in made.frames()]
    assert np.isnan(rows[20]["q_street"]) and "street: the lift has not swung" in rows[20]["note"]
    assert len(rows[20]["note"].encode()) <= 160
    lift = np.array([row["q_lift"] for row in rows[150:251]])
    lift -= lift.mean()
    up = np.flatnonzero((lift[:-1] < 0) & (lift[1:] >= 0))
    times = 0.05 * (up + lift[up] / (lift[up] - lift[up + 1]))
    assert rows[250]["q_street"] == pytest.approx(0.02 / 0.1 / np.diff(times).mean(), rel=0.01)
    assert not rows[250].get("note")
    assert rows[251]["level"] == 3
    assert rows[253]["q_street"] == pytest.approx(rows[250]["q_street"], rel=0.02)
