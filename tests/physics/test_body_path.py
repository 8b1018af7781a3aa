"""The way of bodies through a frame: speeds by differences, and where they stop at cloth."""

import numpy as np
import pytest

from restshape.physics.cloth.body_path import BodyPath, between, speed_of
from restshape.physics.cloth.contact.contact import Contact
from restshape.physics.cloth.scene import kernel_body
from restshape.scene.bodies import Body

WAYS = {
    "sphere": ({"center": (0, 0, 0), "radius": 0.1}, {"center": (0.2, 0, 0.1), "radius": 0.3}),
    "box": (
        {"center": (0, 0, 0), "half": (0.2, 0.1, 0.1), "radius": 0.01},
        {"center": (0, 0.1, 0), "half": (0.1, 0.2, 0.1), "rotate": (0.5, 1.0, -0.7), "radius": 0.05},
    ),
    "capsule": (
        {"start": (0, 0, 0), "end": (0.3, 0, 0), "radius": 0.1},
        {"start": (0, 0.1, 0), "end": (0, 0.3, 0.2), "radius": 0.05},
    ),
    "cylinder": (
        {"start": (0, 0, 0), "end": (0.3, 0, 0), "radius": 0.1, "rounded": 0.0},
        {"start": (0, 0.1, 0), "end": (0.1, 0.3, 0.2), "radius": 0.15, "rounded": 0.04},
    ),
    "plane": ({"point": (0, 0, 0), "normal": (0, 0, 1)}, {"point": (0, 0, 0.1), "normal": (1.0, 0, 1)}),
}


def bodies(kind: str) -> tuple[Body, Body]:
    return tuple(Body.model_validate({kind: form}) for form in WAYS[kind])


@pytest.mark.parametrize("kind", WAYS)
def test_no_distance_changes_faster_than_the_speed(kind):
    old, new = bodies(kind)
    assert between(old, new, 0.0) == old and between(old, new, 1.0) == new
    x = np.random.default_rng(0).uniform(-0.6, 0.6, (300, 3))
    speed, shares = speed_of(old, new, x), np.linspace(0.0, 1.0, 101)
    # Seen from what goes with the body.
    moved = [kernel_body(between(old, new, s)).distances(x + s * speed.shift) for s in shares]
    fastest = np.abs(np.diff(moved, axis=0)).max() / (shares[1] - shares[0])
    assert 0.1 * speed.rest <= fastest <= speed.rest * (1 + 1e-6)


def sheet(z: float) -> tuple[Contact, np.ndarray]:
    """One large triangle at a height, and contact with nothing yet."""
    x, cells = np.array([[-1.0, -1, z], [1.0, -1, z], [0.0, 1, z]]), np.array([[0, 1, 2]], dtype=np.int32)
    return Contact([], np.ones(3), 1e5, 2e-3, cells=cells, cell_area=np.ones(1)), x


@pytest.mark.parametrize("length", [0.5, 5.0, 1000.0])
def test_a_ball_stops_at_a_triangle_however_far_it_goes(length):
    """It is a quarter of its radius deep then, and where it does not come near it goes all its way."""
    contact, x = sheet(0.2)
    old = Body.model_validate({"sphere": {"center": (0, -0.2, -0.1), "radius": 0.08}})
    up, aside = (
        old.model_copy(update={"sphere": old.sphere.model_copy(update={"center": end})})
        for end in ((0, -0.2, length - 0.1), (0, -0.2 - length, -0.1))
    )
    path = BodyPath([old], [up], contact)
    reached = path.farthest(0.0, x, np.zeros_like(x))
    assert -0.1 + length * reached + 0.08 == pytest.approx(0.2 + 0.02, abs=2e-3)
    assert BodyPath([old], [aside], contact).farthest(0.0, x, np.zeros_like(x)) == 1.0
    # Cloth that goes along is not passed.
    assert path.farthest(0.0, x, np.tile([0, 0, length], (3, 1))) == 1.0


def test_bodies_that_close_upon_cloth_stop_at_it():
    contact, x = sheet(0.0)
    places = [((0, 0, 0.1), (0, 0, -0.3)), ((0, 0, -0.1), (0, 0, 0.3))]
    ways = [
        [Body.model_validate({"box": {"center": c, "half": (0.5, 0.5, 0.05)}}) for c in ends] for ends in zip(*places)
    ]
    path = BodyPath(*ways, contact)
    reached = path.farthest(0.0, x, np.zeros_like(x))
    assert 0.05 - 0.4 * reached == pytest.approx(-0.25 * 0.05, abs=2e-3)


def test_a_body_that_is_in_the_cloth_already_goes_on():
    """As the point of a needle that bears all of it: it stops a quarter of what is left to its middle deeper."""
    contact, x = sheet(0.0)
    old, new = (Body.model_validate({"sphere": {"center": (0, 0, z), "radius": 0.1}}) for z in (-0.05, 0.5))
    assert BodyPath([old], [new], contact).farthest(0.0, x, np.zeros_like(x)) == 0.0
    reached = BodyPath([old], [new], contact, x).farthest(0.0, x, np.zeros_like(x))
    assert 0.55 * reached == pytest.approx(0.25 * 0.05, abs=2e-3)


def test_a_half_space_gets_no_deeper_into_cloth_than_a_part_of_the_smallest_body():
    contact, x = sheet(-1e-3)
    pin = Body.model_validate({"sphere": {"center": (0, 0, 5.0), "radius": 2e-3}})
    floors = [Body.model_validate({"plane": {"point": (0, 0, z), "normal": (0, 0, 1)}}) for z in (0.0, 0.5)]
    path = BodyPath([pin, floors[0]], [pin, floors[1]], contact, x)
    np.testing.assert_allclose(path.depths, [0.5e-3, 1.25e-3], rtol=1e-6)
    assert 0.5 * path.farthest(0.0, x, np.zeros_like(x)) == pytest.approx(0.25e-3, abs=1e-4)


@pytest.mark.parametrize(("there", "depth"), [(0.01, 0.0125), (0.04, 0.005)])
def test_a_body_that_shrinks_gets_no_deeper_than_its_last_size(there, depth):
    contact, x = sheet(0.0)
    ways = [
        Body.model_validate({"sphere": {"center": (0, 0, there - 0.1), "radius": radius}}) for radius in (0.1, 0.02)
    ]
    assert BodyPath(*([one] for one in ways), contact, x).depths == pytest.approx([depth], abs=5e-4)
