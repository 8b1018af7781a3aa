"""Distances of points from sides, against those of many points on the sides."""

import numpy as np
import pytest

from restshape.shape import nearness


def test_distances_are_those_of_the_nearest_point_of_a_side():
    draw = np.random.default_rng(3)
    points, starts, ends = (draw.random((9, 2)) for _ in range(3))
    on_them = starts + np.linspace(0.0, 1.0, 20_001)[:, None, None] * (ends - starts)
    tried = [np.hypot(*np.moveaxis(on_them - point, -1, 0)).min() for point in points]
    assert nearness.distances(points, starts, ends) == pytest.approx(tried, abs=1e-4)


def test_many_points_are_looked_at_in_parts(monkeypatch):
    points, at = np.random.default_rng(1).random((50, 2)), np.array([[0.3, 0.3], [0.7, 0.1]])
    whole = nearness.distances(points, at, at)
    assert whole == pytest.approx(np.hypot(*np.moveaxis(points[:, None] - at, -1, 0)).min(axis=1))
    monkeypatch.setattr(nearness, "AT_ONCE", 16)
    assert np.array_equal(nearness.distances(points, at, at), whole)
