"""A strip that is pulled straight over the edge of a rough table stays straight: nothing pushes it sideways."""

import json

import numpy as np
import pytest
from petsc4py import PETSc
from small_scenes import block, head

from restshape.application import application
from restshape.calibration import Calibration
from restshape.physics.cloth.relaxation.equilibrium import Tries
from restshape.policy import policy
from restshape.replay.loop import Replay
from restshape.replay.request import Request
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

STRIP = f"""
{head("cloth")}{block(0.5, 0.06)}
[material.cotton]
E = "1 MPa"
nu = 0.3
rho = "500 kg/m^3"
thickness = "0.3 mm"
bending = "5e-6 N m"
[effects.gravity]
[effects.contact]
[effects.cloth]
bending = "hinge"
[mesh]
size = 0.015
[bodies.table]
box = {{ center = [0.1, 0.03, -0.067], half = [0.2, 0.3, 0.065], radius = 0.02 }}
friction = 0.3
[supports.left]
on = "left"
fix = {{ x = 0, y = 0, z = 0 }}
"""
PULL = {"t": 0.1, "do": "set", "key": "supports.left.fix.x", "value": "-0.06 m", "frames": 4}


@pytest.mark.slow
@pytest.mark.parametrize("left_out", [False, True])
def test_a_strip_that_is_pulled_straight_over_an_edge_does_not_drift(tmp_path, monkeypatch, left_out):
    """By few steps of Newton's method and a descent too, whose iterates go far to the sides."""
    (tmp_path / "strip.toml").write_text(STRIP)
    scene = load_scene(tmp_path / "strip.toml")
    head = {"format": "restshape-edits", "version": 1, "scene": "strip.toml", "units": "m"}
    edits = tmp_path / "edits.jsonl"
    edits.write_text("\n".join(map(json.dumps, (head, PULL))))
    if left_out:
        monkeypatch.setattr(Tries, "left_out", lambda _: True)
    request = Request(scene, load_script(edits, scene), application("cloth"), policy("auto"), Calibration.load())
    replay = Replay(request, PETSc.COMM_SELF)
    for _ in replay.frames():
        state = replay.analysis.state
        problem = state.problem
        X, y = problem.mesh.X, problem.corners(state.x)
        assert state.report.converged
        assert np.abs(y[:, 1] - X[:, 1])[np.abs(X[:, 0] - 0.25) < 0.01].max() < 1e-3
        assert abs((y[:, 1] - X[:, 1])[X[:, 0] > 0.5 - 1e-9].mean()) < 1e-3
    # It has come along.
    assert y[:, 2].min() == pytest.approx(-0.149, abs=3e-3)
