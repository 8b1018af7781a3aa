"""What is kept of how far triangles and points are from a body: no answer but that of a fresh look, and fewer looks."""

import numpy as np
import pytest

from restshape import _kernels as k

FLOOR, DEEPER, TOLERANCE, THICKNESS = -1e-3, 1e-3, 4e-5, 2e-3
BODIES = {
    "sphere": k.Body.sphere(np.zeros(3), 0.2),
    "box": k.Body.box(np.zeros(3), np.array([0.2, 0.15, 0.1]), None, 0.01),
    "capsule": k.Body.capsule((-0.1, 0.0, 0.0), (0.2, 0.0, 0.0), 0.05),
}


def cloth(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Triangles (300, 3), each with corners of its own, around a body."""
    middle = rng.uniform(-0.35, 0.35, (300, 1, 3))
    return (middle + rng.uniform(-0.02, 0.02, (300, 3, 3))).reshape(-1, 3), np.arange(900, dtype=np.int32).reshape(
        -1, 3
    )


@pytest.mark.parametrize("name", BODIES)
def test_shares_on_a_long_way_are_those_of_fresh_looks(name):
    """Steps of all lengths one after the other, each beside the share that no memory gives."""
    body, rng, stopped = BODIES[name], np.random.default_rng(1), 0
    x, cells = cloth(rng)
    x = x[cells[body.lowest_each(x, cells, TOLERANCE)[0] > DEEPER].ravel()]
    cells = np.arange(len(x), dtype=np.int32).reshape(-1, 3)
    room = k.TriangleRoom(body, len(cells), FLOOR, DEEPER, TOLERANCE)
    for size in (1e-4, 1e-3, 0.05, 1e-3, 0.2, 1e-4, 1e-4):
        way = np.repeat(rng.normal(scale=size, size=(len(cells), 3)), 3, axis=0)
        share = room.step_share(x, way, cells)
        assert share == pytest.approx(body.step_share(x, way, cells, FLOOR, DEEPER, TOLERANCE), rel=1e-12)
        stopped += share < 1.0
        x = x + share * way
    assert stopped >= 2


def test_triangles_within_their_room_are_not_looked_at_again():
    body, (x, cells) = BODIES["sphere"], cloth(np.random.default_rng(2))
    room = k.TriangleRoom(body, len(cells), FLOOR, DEEPER, TOLERANCE)
    room.step_share(x, np.zeros_like(x), cells)
    first = room.looks
    assert first == len(cells)
    assert room.step_share(x + 1e-4, np.full_like(x, 1e-4), cells) == 1.0
    assert room.looks - first < len(cells) / 2


def test_positions_that_are_no_numbers_are_looked_at():
    body, (x, cells) = BODIES["sphere"], cloth(np.random.default_rng(3))
    room = k.TriangleRoom(body, len(cells), FLOOR, DEEPER, TOLERANCE)
    room.step_share(x, np.zeros_like(x), cells)
    before = room.looks
    room.step_share(np.full_like(x, np.nan), np.zeros_like(x), cells)
    assert room.looks > before


@pytest.mark.parametrize("name", BODIES)
def test_contact_of_points_is_to_the_bit_that_of_fresh_looks(name):
    """Points that come, touch and go, one way after the other."""
    body, rng = BODIES[name], np.random.default_rng(4)
    x = rng.uniform(-0.3, 0.3, (2000, 3))
    x, touched = x[body.distances(x) > -THICKNESS], 0
    room, area = k.PointRoom(body, len(x)), np.ones(len(x))
    for size in (0.0, 1e-4, 1e-3, 0.02, 1e-3, 1e-4):
        x = x + rng.normal(scale=size, size=x.shape)
        own, fresh = np.zeros((len(x), 12)), np.zeros((len(x), 12))
        energy = room.add_contact(x, area, 1e5, THICKNESS, own)
        assert energy == body.add_contact(x, area, 1e5, THICKNESS, fresh)
        np.testing.assert_array_equal(own, fresh)
        touched += (fresh[:, 3:] != 0.0).any(axis=1).sum()
    assert touched > 20 and room.looks < 4 * len(x)


def test_rooms_refuse_other_numbers_of_points_and_triangles():
    body, (x, cells) = BODIES["sphere"], cloth(np.random.default_rng(5))
    with pytest.raises(ValueError, match="not as many as the room"):
        k.TriangleRoom(body, len(cells) - 1, FLOOR, DEEPER, TOLERANCE).step_share(x, x, cells)
    with pytest.raises(ValueError, match="not as many as the room"):
        k.PointRoom(body, 3).add_contact(x, np.ones(len(x)), 1.0, THICKNESS, np.zeros((len(x), 12)))


def test_triangles_that_have_hardly_moved_are_left_out():
    x, cells = cloth(np.random.default_rng(6))
    before = np.full((len(cells), 3, 3), np.inf)
    assert len(k.moved_cells(x, cells, 1e-3, before)) == len(cells)
    np.testing.assert_array_equal(before, x[cells])
    x[:30] += 2e-3
    np.testing.assert_array_equal(k.moved_cells(x, cells, 1e-3, before), np.arange(10))
