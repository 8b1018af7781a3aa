"""Edits of the keys of effects: what is set holds from that frame on, and gives what a fresh scene gives."""

import pytest
from large import beam, gravity, solid
from small_scenes import make_replay, rows_of, write_scene, write_script

STEPS, WEIGHT = "effects.large_deformation.load_steps", "effects.gravity.g"


def test_load_steps_are_set_within_a_session(tmp_path):
    sets = [(STEPS, 1), (WEIGHT, [0, -30]), (STEPS, 60), (WEIGHT, [0, -30])]
    edits = write_script(tmp_path, [{"do": "set", "key": key, "value": value} for key, value in sets])
    light, heavy = (beam(solid(), gravity(0, -g), height=0.1) for g in (1, 30))
    start, fewer, refused, more, found = rows_of(make_replay(write_scene(tmp_path, light), edits))
    # Thirty times the weight is too much for one step; what was there before stays.
    assert "raise effects.large_deformation.load_steps" in refused["refused"]
    assert {row["q_y"] for row in (start, fewer, more)} == {start["q_y"]} and refused["stale"]
    (fresh,) = rows_of(make_replay(write_scene(tmp_path, heavy, "heavy.toml")))
    assert not found["refused"] and found["q_y"] == pytest.approx(fresh["q_y"], rel=1e-5)
    # The whole weight hangs on the wall.
    assert found["q_wall_y"] == pytest.approx(1000 * 30 * 0.1, rel=1e-5)
