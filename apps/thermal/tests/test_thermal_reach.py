"""Heat that a drag with a reach moves a part of: condensed equals whole, with convection and sources on both parts."""

import numpy as np
import pytest
from small_scenes import HOLE, across, block, drag, make_replay, meshed, write_scene, write_script

HEATED = (
    """
format = "restshape-scene"
version = 1
app = "thermal"
"""
    + block(2.0, 1.0)
    + HOLE
    + """
[material.iron]
conductivity = 50
thickness = 0.01
[supports.cold]
on = "left"
fix = { temperature = "20 degC" }
[loads.air]
on = ["top", "window"]
convection = { film = 40, ambient = "10 degC" }
[loads.core]
on = "all"
source = "1e4 + 1e4*x"
"""
)


@pytest.mark.parametrize(("size", "order"), [(0.12, 1), (0.2, 2)])
def test_condensed_equals_whole(tmp_path, size, order):
    text = HEATED + meshed(size, order) + "reach = 0.12\n[solve]\ntolerance = 1e-12\n"
    script = write_script(tmp_path, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.56, 0.53), 4)))
    made, count = make_replay(write_scene(tmp_path, text), script), 0
    for row in made.frames():
        if row["level"] == 1:
            assert made.analysis.parts.solved is made.analysis.state
            cold = made.analysis.cold_unknowns()
            np.testing.assert_allclose(made.analysis.x, cold, rtol=1e-10)
            count += 1
    assert count == 4
