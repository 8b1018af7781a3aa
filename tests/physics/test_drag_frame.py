"""Frames of a drag of cloth: few steps of Newton's method from the last rest, to the rest that descents find too."""

import json

import numpy as np
import pytest
from cloths import CONTACT, write_cloth
from petsc4py import PETSc

from restshape.application import application
from restshape.calibration import Calibration
from restshape.physics.cloth.membrane import stretching
from restshape.physics.cloth.relaxation import binding
from restshape.physics.cloth.relaxation.mixed_newton import MixedNewton
from restshape.policy import policy
from restshape.replay.loop import Replay
from restshape.replay.request import Request
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

UPRIGHT = """
[start]
turn = ["90 deg", 0, 0]
[supports.left]
on = "d"
fix = ["x", "y", "z"]
[supports.right]
on = "c"
fix = { x = "-0.1 m", y = 0, z = 0 }
"""
DRAG = {"do": "set", "key": "supports.right.fix.x", "value": "-0.2 m", "frames": 8}
PUSHED = """
[bodies.ball]
sphere = { center = [0.5, -0.22, 0.4], radius = 0.2 }
friction = 0.3
"""
TOUCH = {"do": "set", "key": "bodies.ball.sphere.center.1", "value": -0.14, "frames": 8}
PUSH = {"do": "set", "key": "bodies.ball.sphere.center.1", "value": -0.138, "frames": 4}


def rests(folder, monkeypatch, *parts, first, then, by_newton=True):
    """The states, and their energies, after each frame of the second of two edits; descents follow the first."""
    scene = load_scene(write_cloth(folder, *parts), ("mesh.size=0.1",))
    edits = folder / "edits.jsonl"
    head = {"format": "restshape-edits", "version": 1, "scene": "cloth.toml", "units": "m"}
    edits.write_text("\n".join(json.dumps(line) for line in (head, {"t": 0.1, **first}, {"t": 0.2, **then})))
    request = Request(scene, load_script(edits, scene), application("cloth"), policy("auto"), Calibration.load())
    replay, found, usual = Replay(request, PETSc.COMM_SELF), [], binding.drag_frame
    before = first.get("frames", 1)
    for k, _ in enumerate(replay.frames()):
        state = replay.analysis.state
        found.append((state, state.problem.energy(state.x)))
        monkeypatch.setattr(binding, "drag_frame", usual if by_newton and k >= before else lambda *_: None)
    monkeypatch.setattr(binding, "drag_frame", usual)
    return found[1 + before :]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("parts", "first", "then", "most", "near"),
    [((UPRIGHT,), {"do": "idle"}, DRAG, 3, 1e-7), ((UPRIGHT, CONTACT, PUSHED), TOUCH, PUSH, 6, 1e-4)],
)
def test_small_drags_take_few_steps_of_newton_to_the_rest_that_descents_find(
    tmp_path, monkeypatch, parts, first, then, most, near
):
    found = rests(tmp_path, monkeypatch, *parts, first=first, then=then)
    others = rests(tmp_path, monkeypatch, *parts, first=first, then=then, by_newton=False)
    for (state, energy), (other, expected) in zip(found, others, strict=True):
        report = state.report
        assert report.converged and report.stable
        assert report.steps == report.newton <= most and report.factors <= most
        assert other.report.steps > 10
        assert energy == pytest.approx(expected, rel=near)
        assert state.x == pytest.approx(other.x, abs=100.0 * near)


@pytest.mark.slow
def test_a_frame_that_newton_does_not_solve_leaves_nothing_behind(tmp_path, monkeypatch):
    given = {"first": TOUCH, "then": PUSH}
    others = rests(tmp_path, monkeypatch, UPRIGHT, CONTACT, PUSHED, **given, by_newton=False)
    # It goes along the derivative, and gives up after that.
    monkeypatch.setattr(MixedNewton, "converge", lambda *_: None)
    found = rests(tmp_path, monkeypatch, UPRIGHT, CONTACT, PUSHED, **given)
    for (state, energy), (other, expected) in zip(found, others, strict=True):
        assert energy == expected
        np.testing.assert_array_equal(state.x, other.x)
        np.testing.assert_array_equal(state.friction.anchors, other.friction.anchors)


def test_tension_is_what_is_left_without_negative_principal_values():
    """Against a spectral decomposition."""
    tensions = np.random.default_rng(0).uniform(-1.0, 1.0, (50, 3))
    for (xx, yy, xy), found in zip(tensions, stretching(tensions)):
        values, axes = np.linalg.eigh([[xx, xy], [xy, yy]])
        left = (axes * np.maximum(values, 0.0)) @ axes.T
        assert found == pytest.approx([left[0, 0], left[1, 1], left[0, 1]], abs=1e-14)
    assert stretching(np.zeros((1, 3))) == pytest.approx(np.zeros((1, 3)))
