"""Cloth that bodies take along as it lies, against Newton's method from the last rest."""

import json

import numpy as np
import pytest
from cloths import BALL, CONTACT, PIN, write_cloth
from petsc4py import PETSc

from restshape.application import application
from restshape.calibration import Calibration
from restshape.physics.cloth.contact.tunnelling import penetrations
from restshape.physics.cloth.relaxation import binding
from restshape.physics.cloth.relaxation.saddle_escape import SaddleEscape
from restshape.physics.cloth.relaxation.taken_along import common_shift
from restshape.physics.cloth.trust import largest_stretch
from restshape.policy import policy
from restshape.replay.loop import Replay
from restshape.replay.request import Request
from restshape.scene.bodies import Body
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

MOVED = {"do": "set", "key": "bodies.ball.sphere.center.2", "value": -0.28}
GROWN = {"do": "set", "key": "bodies.ball.sphere.radius", "value": 0.251}
HEAVIER = {"do": "set", "key": "material.cotton.rho", "value": 401}


def last_frames(folder, *parts, edit):
    """The states of the first frame and of that of an edit, and the last frame's row."""
    scene = load_scene(write_cloth(folder, CONTACT, BALL, *parts))
    edits = folder / "edits.jsonl"
    head = {"format": "restshape-edits", "version": 1, "scene": "cloth.toml", "units": "m"}
    edits.write_text("\n".join(json.dumps(line) for line in (head, {"t": 0.1, **edit})))
    replay = Replay(
        Request(scene, load_script(edits, scene), application("cloth"), policy("auto"), Calibration.load()),
        PETSc.COMM_SELF,
    )
    frames = replay.frames()
    next(frames)
    first = replay.analysis.state
    row = list(frames)[-1]
    return first, replay.analysis.state, row


def test_a_ball_that_goes_straight_takes_its_cloth_along(tmp_path, monkeypatch):
    first, state, row = last_frames(tmp_path, edit=MOVED)
    shift = np.array([0.0, 0.0, 0.02])
    corners = state.problem.corners
    assert corners(state.x) == pytest.approx(corners(first.x) + shift, abs=1e-12)
    assert (state.report.steps, state.report.stable, state.report.converged) == (0, True, True)
    assert row["tangent_positive_definite"] == 1 and row["factorisations"] == 0
    assert SaddleEscape(state.solver).is_stable(state.x)
    assert state.energy == pytest.approx(first.energy + 9.81 * 0.2 * shift[2], rel=1e-10)
    assert state.friction.anchors == pytest.approx(first.friction.anchors + shift, abs=1e-12)
    monkeypatch.setattr(binding, "taken_along", lambda *_: None)
    _, other, _ = last_frames(tmp_path, edit=MOVED)
    assert other.report.newton > 0
    assert state.x == pytest.approx(other.x, abs=1e-5)
    assert state.energy == pytest.approx(other.energy, rel=1e-6)


@pytest.mark.parametrize("edit", [MOVED, GROWN])
def test_what_lasts_is_what_a_look_at_the_cloth_finds(tmp_path, edit):
    first, state, row = last_frames(tmp_path, edit=edit)
    problem, depths = state.problem, penetrations(state.problem.contact, state.problem.corners(state.x))
    assert row["max_strain"] == pytest.approx(largest_stretch(problem, state.x)[0], rel=1e-9)
    assert row["max_penetration"] == pytest.approx(max(depths), rel=1e-9)
    assert row["crossings"] == len(problem.surface.crossed(problem.corners(state.x))) == 0
    assert row["estimate"] == pytest.approx(problem.error_estimate().relative(state.x), rel=1e-9)
    # Cloth that lies otherwise has an estimate of its own, and no other positions have that of these.
    assert (row["estimate"] == first.lasting(first.x, "estimate", lambda: None)) == (edit is MOVED)
    assert state.lasting(state.x.copy(), "estimate", lambda: None) is None


@pytest.mark.parametrize(("parts", "edit"), [((), GROWN), ((), HEAVIER), ((PIN,), MOVED)])
def test_cloth_is_not_taken_along_where_more_than_places_of_bodies_changes(tmp_path, monkeypatch, parts, edit):
    found = []
    usual = binding.taken_along
    monkeypatch.setattr(binding, "taken_along", lambda *given: found.append(usual(*given)))
    last_frames(tmp_path, *parts, edit=edit)
    assert found == [None]


def body(**form):
    return Body.model_validate(form)


BAR = {"start": [0, 0, 0], "end": [1, 0, 0], "radius": 0.1}
FLOOR = {"point": [0, 0, 0], "normal": [0, 0, 1]}


@pytest.mark.parametrize(
    ("before", "after", "shift"),
    [
        ([{"capsule": BAR}], [{"capsule": BAR | {"start": [0, 1, 0], "end": [1, 1, 0]}}], [0, 1, 0]),
        ([{"capsule": BAR}], [{"capsule": BAR | {"end": [1, 1, 0]}}], None),
        ([{"capsule": BAR}], [{"capsule": BAR}], None),
        ([{"capsule": BAR}, {"plane": FLOOR}], [{"capsule": BAR}, {"plane": FLOOR | {"point": [0, 0, 1]}}], None),
        ([{"plane": FLOOR}], [{"plane": FLOOR | {"point": [0, 0, 1]}}], [0, 0, 1]),
        ([{"plane": FLOOR}], [{"capsule": BAR}], None),
    ],
)
def test_bodies_go_the_same_way_or_have_none_in_common(before, after, shift):
    found = common_shift(*(tuple(body(**form) for form in forms) for forms in (before, after)), np.zeros((1, 3)), 1e-12)
    assert (found is None) == (shift is None)
    assert shift is None or found == pytest.approx(np.array(shift), abs=1e-12)
