"""What is in the openings of cloth: bodies through rings, whichever way these lie."""

import numpy as np
import pytest
from cloths_recorded import grid
from restshape_studies.bench.openings import axis, borders, inside, kept, length, normal, passages

from restshape.scene.bodies import Body
from restshape.shape.placement import rotation

AROUND = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
RING = np.column_stack([np.cos(AROUND), np.sin(AROUND), 0.0 * AROUND])


def framed(pieces: int = 9) -> tuple[np.ndarray, np.ndarray]:
    """The unit square with a square hole in its middle third."""
    X, cells = grid(pieces)
    middles = X[cells].mean(axis=1)
    return X, cells[(np.abs(middles - 0.5) > 1 / 6).any(axis=1)]


def post(x: float, y: float, low: float = -0.5, high: float = 0.5) -> Body:
    return Body(capsule={"start": [x, y, low], "end": [x, y, high], "radius": 0.05})


def test_borders_are_those_of_the_square_and_of_its_hole():
    X, cells = framed()
    loops = sorted((length(X[loop]) for loop in borders(cells)), reverse=True)
    assert loops == pytest.approx([4.0, 4.0 / 3.0])


@pytest.mark.parametrize("turn", [(0.0, 0.0, 0.0), (0.4, -1.1, 2.0)])
@pytest.mark.parametrize(("x", "hits"), [(0.0, 1), (0.97, 1), (1.03, 0), (5.0, 0)])
def test_a_way_through_a_ring_passes_it_once_and_one_beside_it_never(turn, x, hits):
    matrix = rotation(turn)
    ends = [matrix @ (x, 0.01, z) for z in (-0.3, 0.2)]
    assert abs(passages(RING @ matrix.T, *ends)) == hits
    assert passages(RING @ matrix.T, *ends) == -passages(RING @ matrix.T, *ends[::-1])
    # A way that ends before the ring.
    assert passages(RING @ matrix.T, *(matrix @ (x, 0.01, z) for z in (-0.3, -0.1))) == 0


@pytest.mark.parametrize("pieces", [3, 4, 23, 24])
def test_a_way_through_the_very_middle_or_a_spoke_is_counted_once(pieces):
    """Bodies of scenes stand where the holes of their patterns have their centres."""
    around = np.linspace(0.0, 2.0 * np.pi, pieces, endpoint=False)
    ring = np.column_stack([np.cos(around), np.sin(around), 0.0 * around])
    for x in (0.0, 0.25):
        assert abs(passages(ring, np.array([x, 0.0, -0.3]), np.array([x, 0.0, 0.2]))) == 1


def test_there_and_back_is_no_passage_in_all():
    """A ring that bulges: a way in and out of its fan counts nothing."""
    bulging = RING + np.column_stack([0 * AROUND, 0 * AROUND, 0.4 * np.cos(2 * AROUND)])
    assert passages(bulging, np.array([-3.0, 0.0, 0.1]), np.array([3.0, 0.0, 0.1])) == 0


def test_what_is_in_a_hole_is_found_and_lost():
    X, cells = framed()
    flat = np.column_stack([X, 0.0 * X[:, 0]])
    bodies = {
        "post": post(0.5, 0.5),
        "beside": post(0.1, 0.5),
        "floor": Body(plane={"point": [0, 0, 0], "normal": [0, 0, 1]}),
    }
    found = inside(X, cells, flat, bodies)
    # What pierces the cloth itself is in no opening.
    assert found == {"1 around post": 1}
    assert kept(found, inside(X, cells, flat + np.array([0, 0, 0.4]), bodies)) is True
    assert kept(found, inside(X, cells, flat + np.array([0, 0, 0.6]), bodies)) is False
    assert kept({}, found) is None


@pytest.mark.parametrize(
    ("body", "ends"),
    [
        (Body(sphere={"center": [0, 0, 1], "radius": 0.5}), ([0, 0, 0.5], [0, 0, 1.5])),
        (Body(cylinder={"start": [0, 0, 1], "end": [2, 0, 1], "radius": 0.5}), ([0, 0, 1], [2, 0, 1])),
        (Body(capsule={"start": [0, 0, 1], "end": [2, 0, 1], "radius": 0.5}), ([-0.5, 0, 1], [2.5, 0, 1])),
        (Body(box={"center": [1, 0, 0], "half": [1, 4, 2], "rotate": [0, 0, np.pi / 2]}), ([5, 0, 0], [-3, 0, 0])),
    ],
)
def test_axes_of_bodies(body, ends):
    assert np.array(axis(body, normal(RING))) == pytest.approx(np.array(ends, float), abs=1e-12)
