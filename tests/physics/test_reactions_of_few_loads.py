"""A reaction takes the loads that its nodes have, and no others."""

import pytest
from small_scenes import make_replay, plate, write_scene, write_script

from restshape import _kernels

TRACTION = "traction_edge2"


def passes(tmp_path, at):
    """Whether loaded facets are looked at for the quantities of a frame, and the reaction [N], once more and first."""
    scene, script = write_scene(tmp_path, plate(0.2)), write_script(tmp_path, [])
    given = [f"quantities.wall.at={at}", "supports.hinge={on='right',fix=['y']}"]
    replay = make_replay(scene, script, overrides=["mesh.order=1", *given])
    (row,) = replay.frames()
    analysis = replay.analysis
    before = _kernels.calls()[TRACTION]
    found = analysis.state.observer(analysis.x)
    return _kernels.calls()[TRACTION] != before, found["wall"], row["q_wall"]


def test_loads_elsewhere_are_left_out(tmp_path):
    looked, found, wanted = passes(tmp_path, "left")
    assert not looked and found == wanted == pytest.approx(-1e6, rel=1e-4)


def test_loads_at_the_support_are_taken(tmp_path):
    looked, found, wanted = passes(tmp_path, "right")
    assert looked and found == wanted and abs(found) < 1.0
