"""Lines of fields on triangles, smooth fields around them, and the pair of places that is chosen on them."""

import itertools

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.spatial import Delaunay

from restshape.analysis.modal.line_minimum import line_minimum
from restshape.analysis.modal.nodal_lines import inside, linear_triangles, nodal_lines
from restshape.analysis.modal.pair_choice import best_pair, hold
from restshape.analysis.modal.quadratic_patch import quadratic_patch


def scattered(count=200):
    X = np.random.default_rng(4).random((count, 2))
    return X, Delaunay(X).simplices


def test_lines_of_a_linear_field_are_exact():
    X, triangles = scattered()
    lines = nodal_lines(triangles, 2.0 * X[:, 0] - X[:, 1] - 0.3)
    places = lines.ends(X)
    assert len(places) > 10
    np.testing.assert_allclose(2.0 * places[..., 0] - places[..., 1], 0.3, atol=1e-12)
    # They cover the line once, as far as the triangles go.
    length = np.hypot(*(places[:, 1] - places[:, 0]).T).sum()
    assert length == pytest.approx(np.hypot(*np.ptp(places.reshape(-1, 2), axis=0)), rel=1e-12)
    assert length > 0.9 * np.hypot(1.0, 0.5)


def test_a_line_through_nodes_is_found_once_and_where_all_is_still_there_is_none():
    X = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [2.0, 0.0], [2.0, 1.0]])
    triangles = np.array([[0, 1, 2], [0, 2, 3], [1, 4, 5], [1, 5, 2]])
    places = nodal_lines(triangles, X[:, 0] - 1.0).ends(X)
    whole = np.hypot(*(places[:, 1] - places[:, 0]).T)
    np.testing.assert_allclose(whole.sum(), 1.0)
    assert len(nodal_lines(triangles, np.zeros(6)).sides) == 0


def test_triangles_of_second_order_are_four_each():
    cells = np.array([[0, 1, 2, 3, 4, 5]])
    X = np.array([[0, 0], [2, 0], [0, 2], [1, 0], [1, 1], [0, 1]], dtype=float)
    parts = X[linear_triangles(cells)]
    areas = 0.5 * np.cross(parts[:, 1] - parts[:, 0], parts[:, 2] - parts[:, 0])
    np.testing.assert_allclose(areas, 0.5)
    assert inside(parts, np.array([0.9, 0.9])) and not inside(parts, np.array([1.1, 1.1]))


def test_the_least_place_along_a_curved_line_is_that_of_a_constrained_search():
    X, triangles = scattered(400)
    place = X[triangles[0]].mean(axis=0)
    centre = X[np.argmin(np.hypot(*(X - 0.5).T))]
    x, y = (X - centre).T
    line, other = x - 0.8 * y**2 + 0.01, 1.0 + 3.0 * (y - 0.02) ** 2 - 0.5 * x
    start = np.flatnonzero(np.hypot(x, y) < 0.06)
    patch = quadratic_patch(X, triangles, np.stack([line, other], axis=1), centre, start)
    found = line_minimum(patch, 0, np.array([1.0, 2.0])) - centre
    wanted = minimize(
        lambda p: (1.0 + 3.0 * (p[1] - 0.02) ** 2 - 0.5 * p[0]) ** 2,
        [0.0, 0.0],
        constraints={"type": "eq", "fun": lambda p: p[0] - 0.8 * p[1] ** 2 + 0.01},
        tol=1e-14,
    ).x
    np.testing.assert_allclose(found, wanted, atol=1e-7)
    assert quadratic_patch(X, triangles[:1], X, place, triangles[0]) is None


def test_along_a_line_without_a_least_place_there_is_none():
    X, triangles = scattered(400)
    x, y = X.T - 0.5
    start = np.flatnonzero(np.hypot(x, y) < 0.06)
    patch = quadratic_patch(X, triangles, np.stack([x, 1.0 + y], axis=1), np.array([0.5, 0.5]), start)
    assert line_minimum(patch, 0, np.array([1.0, 1.0])) is None


@pytest.mark.parametrize("seed", range(5))
def test_the_best_pair_is_that_of_all_pairs(seed):
    rng = np.random.default_rng(seed)
    places, cost, apart, level = rng.normal(size=(40, 2)), rng.random(40), 1.5, 0.3

    def both(i, k):
        (x, y), (u, v) = places[i], places[k]
        offset = (x * v - y * u) / np.hypot(u - x, v - y)
        return cost[i] + cost[k] + level * offset**2

    pairs = [pair for pair in itertools.combinations(range(40), 2) if hold(*places[list(pair)], apart)]
    found = best_pair(places, cost, apart, level)
    assert both(*found) == pytest.approx(min(both(*pair) for pair in pairs), rel=1e-12)
    assert places[found[0], 0] <= places[found[1], 0]


def test_places_on_one_side_of_the_centre_of_mass_hold_nothing():
    places = np.array([[1.0, 0.1], [2.0, 0.0], [1.5, 0.3]])
    assert best_pair(places, np.ones(3), 0.0, 1.0) is None
