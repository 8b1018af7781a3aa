"""The nearest places of triangles beside those of their planes, sides and corners; rays beside closed forms."""

import numpy as np
import pytest

from restshape import _kernels


def of_segment(y, a, b):
    """The nearest place of a segment."""
    share = np.dot(y - a, b - a) / np.dot(b - a, b - a)
    return a + np.clip(share, 0.0, 1.0) * (b - a)


def of_triangle(y, corners):
    """The nearest place of a triangle: within its plane where that is inside, else of a side."""
    a, b, c = corners
    sides = np.column_stack([b - a, c - a])
    u, v = np.linalg.lstsq(sides, y - a, rcond=None)[0]
    places = [of_segment(y, *side) for side in ((a, b), (b, c), (c, a))]
    if min(u, v, 1.0 - u - v) >= 0.0:
        places.append(a + sides @ (u, v))
    return min(places, key=lambda place: np.linalg.norm(y - place))


@pytest.mark.parametrize("count", [1, 8, 40])
@pytest.mark.parametrize("thin", [1.0, 1e-3])
def test_nearest_places_are_those_of_planes_sides_and_corners(count, thin):
    rng = np.random.default_rng(5)
    X = rng.uniform(-1.0, 1.0, (3 * count, 3)) * [1.0, thin, 1.0]
    cells = np.arange(3 * count, dtype=np.int32).reshape(-1, 3)
    x = rng.uniform(-1.5, 1.5, (30, 3)) * [1.0, thin, 1.0]
    distance, found = _kernels.SurfaceSearch(X, cells).nearest(x)
    for y, place, size in zip(x, found, np.abs(distance)):
        away = min(np.linalg.norm(y - of_triangle(y, X[cell])) for cell in cells)
        assert size == pytest.approx(away, abs=1e-11)
        assert np.linalg.norm(y - place) == pytest.approx(away, abs=1e-11)


def test_each_part_of_a_triangle_can_be_the_nearest():
    X, cells = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), np.array([[0, 1, 2]], dtype=np.int32)
    x = [[-1, -1, 0.5], [3, 0, 0.5], [0, 2, 0.5], [1, -1, 0.5], [-1, 0.5, 0.5], [2, 2, 0.5], [0.5, 0.25, 0.5]]
    at = [[0, 0, 0], [2, 0, 0], [0, 1, 0], [1, 0, 0], [0, 0.5, 0], [1.2, 0.4, 0], [0.5, 0.25, 0]]
    _, found = _kernels.SurfaceSearch(X, cells).nearest(np.array(x, dtype=float))
    np.testing.assert_allclose(found, at, atol=1e-15)
