"""Bodies that an edit brings deep into cloth: it comes to rest, and friction knows frames that begin at a rest."""

from dataclasses import replace

import numpy as np
import pytest
from small_scenes import block, head, make_replay, meshed, write_scene, write_script

from restshape.physics.cloth.contact.tunnelling import deepened, penetrations
from restshape.physics.cloth.relaxation.binding import brought_deep
from restshape.physics.cloth.relaxation.follow_bodies import follow_bodies

CURTAIN = f"""
{head("cloth")}{block(0.06, 0.3)}
[material.linen]
E = "1 MPa"
nu = 0.3
rho = "500 kg/m^3"
thickness = "0.4 mm"
bending = "1e-5 N m"
[supports.rail]
on = "top"
fix = ["x", "y", "z"]
[effects.gravity]
[effects.contact]
[start]
turn = ["90 deg", 0, 0]
{meshed(0.03)}
"""
FLOOR = "[bodies.floor]\nplane = { point = [0, 0, -0.01], normal = [0, 0, 1] }\nfriction = 0.3\n"
BALL = "[bodies.ball]\nsphere = { center = [0.03, 0.05, 0.1], radius = 0.02 }\nfriction = 0.3\n"


def test_a_curtain_rests_on_a_floor_that_has_come_deep_into_it(tmp_path):
    raised = {"t": 0.1, "do": "set", "key": "bodies.floor.plane.point.2", "value": 0.03}
    replay = make_replay(write_scene(tmp_path, CURTAIN + FLOOR), write_script(tmp_path, [raised]))
    frames = replay.frames()
    next(frames)
    hung = replay.analysis.state
    problem, way = hung.problem, np.array([0.0, 0.0, -0.03])
    sunk = replace(hung, x=hung.x + problem.boundary.free * way)
    thickness = problem.contact.thickness
    assert 5.0 * thickness < max(penetrations(problem.contact, problem.corners(sunk.x)))
    # No body has moved where the cloth rested as deep.
    assert brought_deep(sunk, hung) and not brought_deep(sunk, sunk) and not brought_deep(hung, hung)
    (row,) = frames
    assert row["converged"] == 1 and row["max_strain"] < 0.01
    assert max(penetrations(problem.contact, problem.corners(replay.analysis.x))) < thickness


@pytest.mark.parametrize(
    "before, after, found", [(0.0, 0.9, False), (0.0, 1.1, True), (1.5, 1.55, False), (1.5, 2, True)]
)
def test_bodies_are_brought_deep_that_come_deeper_than_they_were(before, after, found):
    assert deepened([0.0, 2e-3 * before], [1e-3, 2e-3 * after], 2e-3) == found
    # A body that is new.
    assert deepened([1.0], [0.0, 2e-3 * after], 2e-3) == (after > 1.0)


@pytest.mark.parametrize("begun", [False, True])
def test_friction_of_a_body_that_goes_in_parts_drags_its_anchors(tmp_path, begun):
    replay = make_replay(write_scene(tmp_path, CURTAIN + BALL), write_script(tmp_path, []))
    next(replay.frames())
    state = replay.analysis.state
    ball = state.bodies[0]
    moved = ball.model_copy(update={"sphere": ball.form.model_copy(update={"center": (0.03, -0.05, 0.1)})})
    if begun:
        state.problem.begin_frame(state.x)
    assert (state.problem.contact.history.begin is not None) == begun
    found = follow_bodies(replace(state, bodies=(moved,)), state.bodies, state.x)
    assert any("parts" in note for note in found.notes)
    assert state.problem.contact.history.begin is None
