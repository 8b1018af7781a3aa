"""A support that goes far in one frame takes the cloth along, which would be stretched without measure else."""

import numpy as np
import pytest
from cloths import write_cloth
from small_scenes import make_replay, write_script

from restshape.errors import ReplayProblem
from restshape.physics.cloth.relaxation import binding
from restshape.physics.cloth.relaxation.pull_supports import pull_supports

HUNG = """
[start]
turn = ["90 deg", 0, 0]
[supports.left]
on = "d"
fix = ["x", "y", "z"]
[effects.contact]
self = true
"""
LEFT = {"on": "d", "fix": ["x", "y", "z"]}
RIGHT = {"on": "c", "fix": {"x": "-0.3 m", "y": 0, "z": 0}}
FAR = [{"do": "set", "key": "supports", "value": {"left": LEFT, "right": RIGHT}}]

HELD = """
[start]
turn = ["90 deg", 0, 0]
[supports.held]
on = "patch"
fix = ["x", "y", "z"]
[effects.contact]
self = true
"""
INTO_ITSELF = {"held": {"on": "patch", "fix": ["x", "y", "z"]}}
INTO_ITSELF["corner"] = {"on": "c", "fix": {"x": "-0.5 m", "y": 0, "z": "-0.5 m"}}
TOGETHER = """
[start]
turn = ["90 deg", 0, 0]
[supports.left]
on = "d"
fix = ["x", "y", "z"]
[supports.right]
on = "c"
fix = { x = "half - 0.5", y = 0, z = 0 }
[bodies.ball]
sphere = { center = ["away", 2.0, 0.5], radius = "10 cm" }
[effects.contact]
"""


def test_the_cloth_follows_a_support_that_goes_far(tmp_path, monkeypatch):
    seen = {}

    def watched(state, bodies, last):
        problem = state.problem
        seen["alone"], seen["rest"] = problem.energy(problem.constrain(last)), problem.energy(last)
        pulled, known = pull_supports(state, bodies, last)
        seen["pulled"], seen["given"] = problem.energy(pulled.x), np.abs(problem.constrain(pulled.x) - pulled.x).max()
        seen["crosses"] = problem.surface.crosses(problem.corners(pulled.x))
        seen["way"] = np.abs(problem.constrain(last) - last).max()
        assert np.array_equal(known, pulled.x) and pulled.report.factors > 0
        raise ReplayProblem("seen")

    monkeypatch.setattr(binding, "pull_supports", watched)
    scene, script = write_cloth(tmp_path, HUNG), write_script(tmp_path, FAR)
    rows = [dict(row) for row in make_replay(scene, script, "auto", ["mesh.size=0.08"]).frames()]
    assert [bool(row["refused"]) for row in rows] == [False, True]
    assert seen["way"] > 0.5 and seen["given"] == 0.0 and not seen["crosses"]
    assert seen["alone"] > 100.0 * abs(seen["pulled"]) and seen["rest"] < seen["pulled"]


def pulled_in(folder, monkeypatch, tables: str, event: dict):
    """The state before and after supports have pulled in the frame of an event, and positions (n, 3) [m] likewise."""
    seen = []

    def watched(state, bodies, last):
        seen.extend((state, last, *pull_supports(state, bodies, last)))
        raise ReplayProblem("seen")

    monkeypatch.setattr(binding, "pull_supports", watched)
    scene, script = write_cloth(folder, tables), write_script(folder, [event])
    rows = [dict(row) for row in make_replay(scene, script, "auto", ["mesh.size=0.08"]).frames()]
    assert [bool(row["refused"]) for row in rows] == [False, True]
    return seen


def test_a_support_stays_where_something_is_in_its_way(tmp_path, monkeypatch):
    """A corner is to go into the middle of the cloth, which is held."""
    event = {"do": "set", "key": "supports", "value": INTO_ITSELF}
    before, last, after, known = pulled_in(tmp_path, monkeypatch, HELD, event)
    problem = after.problem
    left, way = (np.abs(problem.constrain(x) - x).max() for x in (known, last))
    assert 0.0 < left < 0.9 * way and not problem.surface.crosses(problem.corners(known))
    # The state still has supports where the frame has them.
    assert after.x is before.x and problem.surface.crosses(problem.corners(after.x))


@pytest.mark.parametrize("away", ["0.5", "half"])
def test_supports_that_go_together_with_bodies_are_left_to_these(tmp_path, monkeypatch, away):
    """A parameter moves a pin, and, where the place of a far ball is made from it, the ball as well."""
    event = {"do": "set", "key": "parameters.half", "value": 0.2}
    # What goes along the derivative of the last rest comes before either.
    monkeypatch.setattr(binding, "drag_frame", lambda state, last: (state, False))
    tables = TOGETHER.replace('"away"', f'"{away}"')
    before, last, after, known = pulled_in(tmp_path, monkeypatch, tables, event)
    alone = away != "half"
    assert (after is before and known is last) != alone
    assert (np.abs(after.problem.constrain(known) - known).max() == 0.0) == alone
