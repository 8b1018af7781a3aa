"""A hole dragged as a whole: it keeps its form, and stays where it was rather than leave the plate."""

import numpy as np
import pytest
from plain_check import fault
from shape_scenes import scene_and_script

from restshape.shape.session import EditSession


@pytest.mark.slow
def test_a_hole_moves_as_a_whole_and_does_not_leave_the_plate(tmp_path):
    path = [[0.6 + 0.1 * i, 0.5] for i in range(20)]
    events = [
        {"do": "press", "on": "window", "at": [0.5, 0.5]},
        {"do": "drag", "path": path},
        {"do": "drag", "to": [1.2, 0.4]},
        {"do": "release"},
    ]
    frames = list(EditSession(*scene_and_script(tmp_path, events)).frames())
    inside = [f for f in frames if f.do == "drag" and f.refused is None]
    out = [f for f in frames if f.refused]
    for frame in inside:
        outline = frame.outline
        hole = outline.entity("window")
        np.testing.assert_allclose(outline.loop_area(hole.loops[0]), -np.pi * 0.04, rtol=1e-13)
        assert fault(outline) is None
    # The right side is an arc through (2.2, 0.5): a hole of radius 0.2 that stays in has its centre left of x = 2.
    assert all(0.5 + frame.c[0] < 2.0 for frame in inside)
    assert 0.5 + max(frame.c[0] for frame in inside) > 1.85
    assert any("would cross" in frame.refused for frame in out)
    assert "hole window would lie outside the outline" in {frame.refused for frame in out}
    centre = frames[-1].outline.centroid(frames[-1].outline.entity("window"))
    np.testing.assert_allclose(centre, [1.2, 0.4], atol=1e-14)
