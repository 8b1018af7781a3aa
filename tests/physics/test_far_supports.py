"""A support that goes far in one frame takes the cloth along, which would be stretched without measure else."""

import numpy as np
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
