"""Bodies that go out of cloth's way at its cold start, and come back: a curtain that is too long for its floor."""

import numpy as np
import pytest
from small_scenes import write_scene

from restshape.interface.first_frame import first_frame
from restshape.physics.cloth.retreat import shifted
from restshape.scene.bodies import Body

CURTAIN = """
format = "restshape-scene"
version = 1
app = "cloth"
[shape]
outline = ["bottom", "right", "top", "left"]
vertices = { a = [0, 0], b = [0.1, 0], c = [0.1, 0.3], d = [0, 0.3] }
[shape.edges]
bottom = { line = ["a", "b"] }
right = { line = ["b", "c"] }
top = { line = ["c", "d"] }
left = { line = ["d", "a"] }
[material.linen]
E = "1 MPa"
nu = 0.3
rho = "500 kg/m^3"
thickness = "0.4 mm"
bending = "1e-4 N m"
[supports.rail]
on = "top"
fix = ["x", "y", "z"]
[start]
turn = ["90 deg", "0 deg", "0 deg"]
[bodies.floor]
plane = { point = [0, 0, 0.08], normal = [0, 0, 1] }
friction = 0.3
[effects.gravity]
[effects.contact]
[effects.cloth]
bending = "hinge"
[mesh]
size = 0.02
[quantities]
lowest = { displacement = "z", reduce = "min" }
"""


def test_a_curtain_too_long_for_its_floor_lies_on_it_without_crossing_itself(tmp_path):
    """The nearest way out presses all below the floor flat, into one line of layers that pass through each other."""
    replay = first_frame(write_scene(tmp_path, CURTAIN))
    row = replay.analysis.row()
    assert row["converged"] and row["tangent_positive_definite"] == 1
    assert row["crossings"] == 0 and row["max_strain"] < 0.05 and row["max_penetration"] < 1e-3 and not row["untrusted"]
    assert "bodies.floor: it goes back at first, and comes to its place again" in replay.row["note"]


@pytest.mark.parametrize(
    "form",
    [
        {"sphere": {"center": (1.0, 2.0, 3.0), "radius": 0.5}},
        {"capsule": {"start": (0.0, 0.0, 0.0), "end": (1.0, 0.0, 0.0), "radius": 0.1}},
        {"plane": {"point": (0.0, 0.0, 0.0), "normal": (0.0, 0.0, 1.0)}},
    ],
)
def test_a_body_is_shifted_with_all_of_its_places(form):
    before, way = Body(**form), np.array([0.1, -0.2, 0.3])
    after = shifted(before, way)
    for key, value in before.form:
        wanted = np.array(value) + way if key in ("center", "start", "end", "point") else value
        assert np.array(getattr(after.form, key)) == pytest.approx(wanted)
