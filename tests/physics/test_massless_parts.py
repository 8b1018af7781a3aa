"""Gravity on a body a part of which is said to weigh nothing, such as the rock under a dam."""

import pytest
from small_scenes import HEAD, block, make_replay, meshed, rows_of, write_scene, write_script

from restshape.errors import UserError

PARTS = (
    HEAD
    + block()
    + "[shape.regions.core]\npolygon = [[0.3, 0.3], [0.7, 0.3], [0.7, 0.7], [0.3, 0.7]]\n"
    + '[material.m]\nE = 1e9\nnu = 0.3\nLIGHT\n[material.core]\nregion = "core"\nE = 1e9\nnu = 0.3\nHEAVY\n'
    + '[effects.solid]\nmodel = "plane_strain"\n[effects.gravity]\ng = [0, -10]\n'
    + '[supports.below]\non = "bottom"\nfix = ["x", "y"]\n'
    + '[quantities]\nweight = { reaction = "y", at = "bottom" }\ncore = { area = true, at = "core" }\n'
    + meshed(0.2)
)


def parts(light, heavy):
    """The block and its core with these lines for their densities."""
    return PARTS.replace("LIGHT", light).replace("HEAVY", heavy)


def test_a_part_without_weight_stands(tmp_path):
    """Below stands the weight of the core alone."""
    found = write_scene(tmp_path, parts("rho = 0", "rho = 2000"))
    (row,) = rows_of(make_replay(found, write_script(tmp_path, [])))
    assert row["q_weight"] == pytest.approx(2000.0 * 10.0 * row["q_core"], rel=1e-6)


@pytest.mark.parametrize("densities", [("", "rho = 2000"), ("rho = 0", "rho = 0")])
def test_a_density_left_out_is_refused_and_so_are_none_at_all(tmp_path, densities):
    found = write_scene(tmp_path, parts(*densities))
    with pytest.raises(UserError, match="no density"):
        rows_of(make_replay(found, write_script(tmp_path, [])))
