"""A floor that rises far below a curtain takes what lies on it along."""

import json

import numpy as np
import pytest
from petsc4py import PETSc
from small_scenes import head

from restshape.application import application
from restshape.calibration import Calibration
from restshape.physics.cloth.relaxation import follow_bodies
from restshape.physics.cloth.relaxation.follow_bodies import FAR, lifted
from restshape.policy import policy
from restshape.replay.loop import Replay
from restshape.replay.request import Request
from restshape.scene.bodies import Body
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

CURTAIN = f"""
{head("cloth")}[shape]
outline = ["bottom", "right", "top", "left"]
[shape.vertices]
a = [0, 0]
b = [0.3, 0]
c = [0.3, 0.6]
d = [0, 0.6]
[shape.edges]
bottom = {{ line = ["a", "b"] }}
right = {{ line = ["b", "c"] }}
top = {{ line = ["c", "d"] }}
left = {{ line = ["d", "a"] }}
[material.linen]
E = "1 MPa"
nu = 0.3
rho = "500 kg/m^3"
thickness = "0.4 mm"
bending = "1e-5 N m"
[supports.rail]
on = "top"
fix = ["x", "y", "z"]
[bodies.floor]
plane = {{ point = [0, 0, -0.01], normal = [0, 0, 2] }}
friction = 0.3
[effects.gravity]
[effects.contact]
[start]
turn = ["90 deg", 0, 0]
[mesh]
size = "50 mm"
"""


def states(folder, *heights):
    """The states after the first frame, and once the floor has come to each of some heights in a frame."""
    path = folder / "curtain.toml"
    path.write_text(CURTAIN)
    scene = load_scene(path)
    lines = [{"format": "restshape-edits", "version": 1, "scene": "curtain.toml", "units": "m"}]
    for k, height in enumerate(heights):
        lines.append({"t": 0.1 * (k + 1), "do": "set", "key": "bodies.floor.plane.point.2", "value": height})
    script = folder / "edits.jsonl"
    script.write_text("\n".join(map(json.dumps, lines)))
    request = Request(scene, load_script(script, scene), application("cloth"), policy("auto"), Calibration.load())
    replay, found = Replay(request, PETSc.COMM_SELF), []
    for _ in replay.frames():
        found.append(replay.analysis.state)
    return found


def raised(body, rise):
    point = [*body.form.point[:2], body.form.point[2] + rise]
    return Body.model_validate(
        {**body.model_dump(exclude_none=True), "plane": {**body.form.model_dump(), "point": point}}
    )


@pytest.mark.slow
def test_what_lies_on_the_floor_goes_along_and_nothing_crosses(tmp_path):
    state = states(tmp_path, 0.03)[-1]
    problem, (floor,) = state.problem, state.bodies
    least = FAR * problem.contact.thickness
    for rise in (1.01 * least, 0.1, 0.25):
        way = lifted(problem, state.x, (floor,), (raised(floor, rise),))
        before, after = problem.corners(state.x), problem.corners(state.x + way)
        heights = before[:, 2] - floor.form.point[2]
        np.testing.assert_allclose(after[:, 2] - before[:, 2], rise * (1.0 - heights / heights.max()), atol=1e-12)
        np.testing.assert_array_equal(after[:, :2], before[:, :2])
        assert not problem.surface.crosses(after)
        slopes = np.ones(len(way), bool)
        slopes[problem.corner_number] = False
        np.testing.assert_allclose(way[slopes], -rise / heights.max() * state.x[slopes] * (0.0, 0.0, 1.0), atol=1e-12)
    for rise in (0.99 * least, 0.4, -0.1):
        assert not lifted(problem, state.x, (floor,), (raised(floor, rise),)).any()


@pytest.mark.slow
def test_a_floor_that_rises_far_takes_less_work_than_one_that_cloth_must_get_out_of(tmp_path, monkeypatch):
    heights = 0.03 + 0.04 * np.arange(6)
    found = states(tmp_path, *heights)
    monkeypatch.setattr(follow_bodies, "lifted", lambda _, x, *__: np.zeros_like(x))
    others = states(tmp_path, *heights)
    for state in (*found, *others):
        assert state.report.converged and state.report.stable and not state.doubts
    steps, more = (sum(state.report.steps for state in some[3:]) for some in (found, others))
    energy, expected = (sum(state.energy for state in some[3:]) for some in (found, others))
    assert steps < 0.85 * more
    # Folds are others, as on any other way.
    assert energy == pytest.approx(expected, rel=0.04)
