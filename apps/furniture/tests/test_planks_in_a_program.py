"""A program edits planks by the events that scripts have, with the keys that furniture has besides."""

import pytest
from furniture_scenes import BENCH, write_bench

import restshape


def test_a_plank_is_lengthened_along_one_of_its_sides_and_turned_about_its_own_axis(tmp_path):
    scene = restshape.load(write_bench(tmp_path, BENCH + "[quantities]\nlong = { length = 'x', at = 'top' }\n"))
    with restshape.open(scene) as sim:
        before = sim.frame.quantities["long"]
        assert sim.scale("top", 1.1, along="x").quantities["long"] == pytest.approx(1.1 * before)
        turned = sim.rotate("left", "2 deg", about="y")
        assert not turned.refused and '"along": "x"' in sim.script.text and '"about": "y"' in sim.script.text
        sim.undo()
        assert sim.undo().quantities["long"] == before
        with pytest.raises(restshape.UserError, match="across"):
            sim.scale("top", 1.1, across="x")
