"""How many functions a frame of level 1 calls, of Python and of compiled modules: what it costs without a clock."""

import numpy as np
import pytest
from counted_calls import called
from restshape_studies.stability import scenery
from small_scenes import across, drag, make_replay, write_scene, write_script

EVENTS = drag("window", (0.5, 0.5), across((0.5, 0.5), (0.53, 0.51), 12))
STEPS = ["effects.dynamics={time_step='0.1 ms',steps=1}", "material.steel.rho='7850 kg/m^3'"]


def calls(tmp_path, application, overrides, estimating):
    """Median calls of frames of level 1 that keep their preconditioner."""
    scene, script = write_scene(tmp_path, scenery.plate(application, 0.1)), write_script(tmp_path, EVENTS)
    replay = make_replay(scene, script, overrides=["mesh.order=1", *overrides])
    replay.errors.estimating = estimating
    frames, found = replay.frames(), []
    for _ in range(14):
        count = called(lambda: next(frames))
        if replay.row["level"] == 1 and not replay.row["pc_rebuilt"]:
            found.append(count)
    assert len(found) >= 3
    return float(np.median(found))


@pytest.mark.parametrize(
    ("application", "overrides", "estimating", "most"),
    [("plane", [], False, 300), ("moving", STEPS, False, 430), ("moving", STEPS, True, 560)],
    ids=["static", "in time", "in time, estimated"],
)
def test_a_frame_of_level_1_calls_few_functions(tmp_path, application, overrides, estimating, most):
    assert calls(tmp_path, application, overrides, estimating) <= most
