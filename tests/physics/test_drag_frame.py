"""Frames of a drag of cloth: few steps of Newton's method from the last rest, to the rest that descents find too."""

import json
import re

import numpy as np
import pytest
from cloths import CONTACT, write_cloth
from petsc4py import PETSc

from restshape.algebra.reuse.tries import Tries
from restshape.application import application
from restshape.calibration import Calibration
from restshape.physics.cloth.contact.tunnelling import penetrations
from restshape.physics.cloth.relaxation import binding
from restshape.physics.cloth.relaxation.mixed_newton import MixedNewton
from restshape.physics.cloth.sheet.membrane import stretching
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

HUNG = """
[supports.left]
on = "left"
fix = ["x", "y", "z"]
[supports.right]
on = "right"
fix = { x = "-0.2 m", y = 0, z = 0 }
[bodies.ball]
sphere = { center = [0.4, 0.5, 0.3], radius = 0.08 }
friction = 0.3
"""


def untried(state, _):
    return state, False


def rests(folder, monkeypatch, *parts, first, then, by_newton=True, size=0.1):
    """The states, and their energies, after each frame of the second of two edits; descents follow the first."""
    scene = load_scene(write_cloth(folder, *parts), (f"mesh.size={size}",))
    edits = folder / "edits.jsonl"
    head = {"format": "restshape-edits", "version": 1, "scene": "cloth.toml", "units": "m"}
    edits.write_text("\n".join(json.dumps(line) for line in (head, {"t": 0.1, **first}, {"t": 0.2, **then})))
    request = Request(scene, load_script(edits, scene), application("cloth"), policy("auto"), Calibration.load())
    replay, found, usual = Replay(request, PETSc.COMM_SELF), [], binding.drag_frame
    before = first.get("frames", 1)
    for k, _ in enumerate(replay.frames()):
        state = replay.analysis.state
        found.append((state, state.problem.energy(state.x)))
        monkeypatch.setattr(
            binding, "drag_frame", usual if by_newton and k >= before else lambda state, _: (state, False)
        )
    monkeypatch.setattr(binding, "drag_frame", usual)
    return found[1 + before :]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("parts", "first", "then", "most", "near", "size"),
    [((UPRIGHT,), {"do": "idle"}, DRAG, 3, 1e-7, 0.1), ((UPRIGHT, CONTACT, PUSHED), TOUCH, PUSH, 6, 1e-4, 0.11)],
)
def test_small_drags_take_few_steps_of_newton_to_the_rest_that_descents_find(
    tmp_path, monkeypatch, parts, first, then, most, near, size
):
    # On the mesh of 0.1 m rounding says whether the pushed cloth buckles.
    found = rests(tmp_path, monkeypatch, *parts, first=first, then=then, size=size)
    others = rests(tmp_path, monkeypatch, *parts, first=first, then=then, size=size, by_newton=False)
    for (state, energy), (other, expected) in zip(found, others, strict=True):
        report = state.report
        assert report.converged and report.stable
        assert report.steps == report.newton <= most and report.factors <= most
        assert other.report.steps > 10
        assert energy == pytest.approx(expected, rel=near)
        assert state.x == pytest.approx(other.x, abs=100.0 * near)


@pytest.mark.slow
def test_newton_leaves_a_saddle_from_which_it_would_creep_away(tmp_path, monkeypatch):
    found = rests(tmp_path, monkeypatch, UPRIGHT, CONTACT, PUSHED, first={"do": "idle"}, then=TOUCH, size=0.08)
    # Forces are 0.01 to 0.05 of the weight where a branch ends there, and fall no more.
    for frame, saddles in ((2, True), (6, False)):
        report = found[frame][0].report
        assert report.converged and report.stable
        assert report.steps == report.newton <= 20
        assert bool(report.saddles) == saddles


def test_a_body_that_rests_deeper_than_contact_is_thick_is_dragged_by_newton(tmp_path, monkeypatch):
    soft = f"{CONTACT}stiffness = 1e4\nthickness = '0.05 mm'\n"
    back = {**PUSH, "value": -0.1398, "frames": 1}
    ((state, _),) = rests(tmp_path, monkeypatch, UPRIGHT, soft, PUSHED, first={**TOUCH, "frames": 1}, then=back)
    depths = penetrations(state.problem.contact, state.problem.corners(state.x))
    assert max(depths) > 1.2 * state.problem.contact.thickness
    assert state.report.converged and state.report.steps == state.report.newton <= 4


@pytest.mark.slow
def test_a_frame_that_newton_does_not_solve_leaves_nothing_behind(tmp_path, monkeypatch):
    given = {"first": TOUCH, "then": PUSH}
    others = rests(tmp_path, monkeypatch, UPRIGHT, CONTACT, PUSHED, **given, by_newton=False)
    # It goes along the derivative, and gives up after that.
    monkeypatch.setattr(MixedNewton, "converge", lambda *_: (None, False))
    found = rests(tmp_path, monkeypatch, UPRIGHT, CONTACT, PUSHED, **given)
    for (state, energy), (other, expected) in zip(found, others, strict=True):
        # Patterns of contact, and with them rounding, may be others.
        assert energy == pytest.approx(expected, rel=1e-8)
        assert state.x == pytest.approx(other.x, abs=1e-5)
        assert state.friction.anchors == pytest.approx(other.friction.anchors, abs=1e-5)


@pytest.mark.slow
def test_cloth_that_nothing_touches_stays_where_it_is_to_the_last_bit(tmp_path, monkeypatch):
    far = {"do": "set", "key": "bodies.ball.sphere.center.1", "value": -0.8, "frames": 3}
    found = rests(
        tmp_path, monkeypatch, UPRIGHT, CONTACT, PUSHED.replace("-0.22", "-0.9"), first={"do": "idle"}, then=far
    )
    for state, _ in found:
        assert state.report.converged and state.report.newton == 0
        np.testing.assert_array_equal(state.x, found[0][0].x)


@pytest.mark.slow
@pytest.mark.parametrize("left_out", [False, True])
def test_cloth_that_jumps_says_how_far_and_by_how_much_its_energy_fell(tmp_path, monkeypatch, left_out):
    """Also in frames that Newton's method leaves out, whose derivative is made afterwards."""
    smooth = rests(tmp_path, monkeypatch, UPRIGHT, first={"do": "idle"}, then=DRAG)
    assert not any("jumped" in note for state, _ in smooth for note in state.notes)
    if left_out:
        monkeypatch.setattr(Tries, "left_out", lambda _: True)
    pushed = rests(tmp_path, monkeypatch, UPRIGHT, CONTACT, PUSHED, first={"do": "idle"}, then=TOUCH)
    jumps = [k for k, (state, _) in enumerate(pushed) if any("jumped" in note for note in state.notes)]
    assert len(jumps) == 1
    last, state = (pushed[k][0] for k in (jumps[0] - 1, jumps[0]))
    way = np.linalg.norm(state.problem.corners(state.x - last.x), axis=1).max()
    # The branch that has ended, by the parabola through the energies of three frames before.
    first, second, third = (pushed[jumps[0] - k][1] for k in (3, 2, 1))
    fell = 3.0 * (third - second) + first - pushed[jumps[0]][1]
    (note,) = state.notes
    found = re.fullmatch(r"cloth jumped (\d+) mm where the hand went 10 mm; energy fell by (\S+) mJ", note)
    assert float(found[1]) == pytest.approx(1e3 * way, abs=0.5)
    # Descents end at rests of other energies before it, which the parabola is through.
    assert float(found[2]) == pytest.approx(1e3 * fell, rel=0.25 if left_out else 0.1)


def test_frames_are_left_out_after_tries_in_vain():
    tries, done = Tries(), []
    for _ in range(30):
        done.append(not tries.left_out())
        if done[-1]:
            tries.count(good=False)
    assert np.flatnonzero(done).tolist() == [0, 2, 6, 14]
    tries.count(good=True)
    assert not tries.left_out()


def test_tension_is_what_is_left_without_negative_principal_values():
    """Against a spectral decomposition."""
    tensions = np.random.default_rng(0).uniform(-1.0, 1.0, (50, 3))
    for (xx, yy, xy), found in zip(tensions, stretching(tensions)):
        values, axes = np.linalg.eigh([[xx, xy], [xy, yy]])
        left = (axes * np.maximum(values, 0.0)) @ axes.T
        assert found == pytest.approx([left[0, 0], left[1, 1], left[0, 1]], abs=1e-14)
    assert stretching(np.zeros((1, 3))) == pytest.approx(np.zeros((1, 3)))


def test_cloth_that_a_body_has_pressed_hangs_as_before_once_it_is_away_in_one_frame(tmp_path, monkeypatch):
    """Newton's steps from there tear it: it goes on from where it was pressed, and not from places of more energy."""
    down = {"do": "set", "key": "bodies.ball.sphere.center.2", "value": -0.28, "frames": 1}
    ((state, energy),) = rests(tmp_path, monkeypatch, CONTACT, HUNG, first=down, then={**down, "value": 0.3})
    ((_, first),) = rests(tmp_path, monkeypatch, CONTACT, HUNG, first={"do": "idle"}, then={"do": "idle"})
    assert state.report.converged and state.report.stable
    assert energy == pytest.approx(first, rel=0.02)
