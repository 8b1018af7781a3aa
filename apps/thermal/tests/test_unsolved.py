"""Answers that rounding keeps from their tolerance say so: a wall of two layers whose conductivities differ by 1e14."""

import pytest
from small_scenes import head, make_replay, write_scene

WALL = """
[shape]
outline = ["b1", "b2", "right", "t2", "t1", "left"]
vertices = { a = [0, 0], m = [1, 0], b = [2, 0], c = [2, 1], n = [1, 1], d = [0, 1] }
[shape.edges]
b1 = { line = ["a", "m"] }
b2 = { line = ["m", "b"] }
right = { line = ["b", "c"] }
t2 = { line = ["c", "n"] }
t1 = { line = ["n", "d"] }
left = { line = ["d", "a"] }
mid = { line = ["m", "n"] }
[shape.regions]
inner = { loop = ["b2", "right", "t2", "mid"] }
[material.one]
conductivity = 1
[material.two]
conductivity = K
region = "inner"
[supports.room]
on = "left"
fix = { temperature = 293.15 }
[loads.air]
on = "right"
convection = { film = 1, ambient = 263.15 }
[mesh]
size = 0.1
[quantities]
loss = { heat_flow = true, at = "right" }
"""


@pytest.mark.parametrize(("conductivity", "warned"), [(1e3, False), (1e14, True)])
def test_a_residual_far_beyond_the_tolerance_is_reported(tmp_path, conductivity, warned):
    scene = write_scene(tmp_path, head("thermal") + WALL.replace("= K", f"= {conductivity:g}"))
    row = next(make_replay(scene).frames())
    assert (row["residual"] > 1e-3) is warned
    assert ("not to be trusted: the residual is" in row["note"]) is warned
    assert warned or row["q_loss"] == pytest.approx(30.0 / (1.0 + 1.0 / conductivity + 1.0), rel=1e-6)
