"""Cloth on cylinders: tension over a side and a rim in closed form, and a bar as a capsule and as a cylinder."""

import numpy as np
import pytest
from small_scenes import block, head, meshed, write_scene

from restshape.interface.first_frame import first_frame

WIDTH, LENGTH = 0.02, 0.4
STRIP = """
[material.ribbon]
E = "20 MPa"
nu = 0
rho = "500 kg/m^3"
thickness = "0.3 mm"
[effects.cloth]
bending = "none"
[effects.gravity]
[effects.contact]
thickness = "0.5 mm"
stiffness = "500 kN/m^3"
[effects.drape]
tolerance = 1e-5
[supports.end]
on = "left"
fix = ["x", "y", "z"]
[quantities]
pull_x = { reaction = "x", at = "left" }
pull_z = { reaction = "z", at = "left" }
free = { position = "z", at = "right" }
side = { position = "x", at = "right" }
"""
SIDE = "cylinder = { start = [0.1, -0.1, -0.0505], end = [0.1, 0.12, -0.0505], radius = 0.05 }"
RIM = "cylinder = { start = [0, 0.01, -0.4], end = [0, 0.01, -0.0005], radius = 0.15, rounded = 0.04 }"
CAPSULE = SIDE.replace("cylinder", "capsule")


@pytest.mark.parametrize(("form", "edge"), [(SIDE, 0.15), (RIM, 0.15)], ids=["side", "rim"])
def test_a_smooth_body_takes_no_tension(tmp_path, form, edge):
    """Without friction T - w z is constant along a strip: what holds its upper end bears w b times the whole drop."""
    text = head("couture") + block(LENGTH, WIDTH) + STRIP + f"[bodies.drum]\n{form}\n" + meshed(0.005)
    row = first_frame(write_scene(tmp_path, text)).row
    weight = 500 * 0.3e-3 * 9.81 * WIDTH
    assert row["converged"] == 1 and row["q_free"] < -0.15
    assert np.hypot(row["q_pull_x"], row["q_pull_z"]) == pytest.approx(-weight * row["q_free"], rel=0.01)
    # It hangs straight down beside the body.
    assert row["q_side"] == pytest.approx(edge + 0.0005, abs=1e-3)


def test_a_bar_is_a_capsule_as_long_as_nothing_lies_on_its_ends(tmp_path):
    # Without friction: where a strip that sticks comes to rest depends on the way there.
    text = head("couture") + block(LENGTH, WIDTH) + STRIP + "[bodies.drum]\nFORM\n" + meshed(0.01)
    rows = [first_frame(write_scene(tmp_path, text.replace("FORM", form))).row for form in (SIDE, CAPSULE)]
    for key in ("q_pull_x", "q_pull_z", "q_free", "q_side"):
        assert rows[0][key] == pytest.approx(rows[1][key], rel=1e-3), key
