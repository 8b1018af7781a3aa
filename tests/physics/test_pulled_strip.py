"""A strip that is pulled straight over a rough table's edge stays straight; over a rod it has tensions of a capstan."""

import json

import numpy as np
import pytest
from petsc4py import PETSc
from small_scenes import block, head, make_replay, write_scene, write_script

from restshape import _kernels
from restshape.algebra.reuse.tries import Tries
from restshape.application import application
from restshape.calibration import Calibration
from restshape.physics.cloth.contact.contact import Contact
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


ROD = f"""
{head("cloth")}{block(0.5, 0.024)}
[material.cotton]
E = "1 MPa"
nu = 0.3
rho = "500 kg/m^3"
thickness = "0.3 mm"
bending = "1e-6 N m"
[effects.gravity]
[effects.contact]
self = false
[effects.cloth]
bending = "hinge"
[mesh]
size = 0.004
[bodies.rod]
capsule = {{ start = [0.2, -0.2, -0.011], end = [0.2, 0.3, -0.011], radius = 0.01 }}
friction = 0.3
[supports.left]
on = "left"
fix = {{ x = 0.19, y = 0, z = -0.14 }}
[quantities]
pull = {{ reaction = "z", at = "left" }}
"""


@pytest.mark.slow
@pytest.mark.parametrize("frames", [1, 2, 8])
def test_tensions_over_a_rod_are_those_of_a_capstan_in_any_number_of_frames(tmp_path, frames):
    """The strip goes farther than around the rod: what is pressed where it leaves began below where it arrives."""
    pull = {"t": 0.1, "do": "set", "key": "supports.left.fix.z", "value": "-0.22 m", "frames": frames}
    replay = make_replay(write_scene(tmp_path, ROD), write_script(tmp_path, [pull]))
    row = list(replay.frames())[-1]
    assert row["converged"] == 1
    problem = replay.analysis.state.problem
    X, y = problem.mesh.X, problem.corners(replay.analysis.x)
    # Lengths of the strip that weigh as much as it is pulled with, on both sides of the rod's axis.
    middle, weight = -0.011, 500 * 0.3e-3 * 9.81 * 0.024
    arrives = middle - y[X[:, 0] > 0.5 - 1e-9, 2].mean()
    leaves = abs(row["q_pull"]) / weight + middle - y[X[:, 0] < 1e-9, 2].mean()
    mu, radius = 0.3, y[:, 2].max() - middle
    # Contact raises the tension where the strip goes into its layer, and lowers it where that leaves: between, it is
    # larger by the energy of contact a length, depth / 3 radii of it.
    contact = problem.contact
    depth = np.maximum(contact.thickness - contact.bodies[0].distance(contact.place(y))[0], 0.0)
    layer = np.average(depth, weights=contact.history.limits[0]) / (3.0 * radius)
    assert 0.02 < layer < 0.04
    growth = np.exp(mu * np.pi * (1.0 + layer))
    assert leaves == pytest.approx(arrives * growth + 2 * mu * radius * (1 + growth) / (1 + mu**2), rel=0.01)
    # Most of the way of the last frame, which is not straight in the first of these.
    assert 0.03 < row["slip_distance"] * max(frames, 2) < 0.085


def test_friction_acts_against_the_way_around_a_rod_from_below_it():
    """A narrow strip goes up to a rod and around it in one go: every pressed node is held by all of its friction."""
    radius, half = 0.0205, 0.005
    along, across = np.linspace(0.0, 0.1, 41), (-half, half)
    rod = _kernels.Body.capsule(np.array([0, -1.0, 0]), np.array([0, 1.0, 0]), 0.02)

    def strip(ahead: float) -> np.ndarray:
        """Straight up to the height of the rod's axis, and from there around it."""
        s = along + ahead
        angle = np.clip(s / radius, 0.0, np.pi)
        x, z = -radius * np.cos(angle), radius * np.sin(angle) + np.minimum(s, 0.0)
        z -= np.maximum(s - radius * np.pi, 0.0)
        return np.array([(x[i], w, z[i]) for i in range(len(s)) for w in across])

    pairs = [np.add.outer(2 * np.arange(40), corners) for corners in ((0, 2, 1), (1, 2, 3))]
    cells = np.concatenate(pairs).astype(np.int32)
    areas = np.full(82, 1e-4), np.full(80, 1e-4)
    contact = Contact([rod], areas[0], 1e6, 1e-3, 0.3, 1e-4, cells, areas[1])
    begin, end = strip(-0.12), strip(-0.04)
    contact.update_friction(begin)
    contact.begin_frame(begin)
    assert contact.update_friction(end) == 0.0
    limits, normals = contact.history.limits[0], contact.history.normals[0]
    friction = contact.forces(end)
    friction -= np.einsum("na,na->n", friction, normals)[:, None] * normals
    tangents = np.column_stack([normals[:, 2], np.zeros(82), -normals[:, 0]])
    pressed = limits > 0.0
    assert pressed.sum() > 40
    np.testing.assert_allclose(np.einsum("na,na->n", friction, tangents)[pressed], limits[pressed], rtol=1e-6)
    assert contact.end_frame(end) > 0.05
