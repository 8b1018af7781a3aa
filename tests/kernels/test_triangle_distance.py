"""Distances over triangles against dense samples, and shares of ways against small steps along them."""

import numpy as np
import pytest
from test_contact import BODIES

from restshape import _kernels as k

TOLERANCE = 1e-4


def triangles(count: int, size: float, seed: int = 3) -> tuple[np.ndarray, np.ndarray]:
    """Corners (3 count, 3) and cells (count, 3) of triangles at random."""
    rng = np.random.default_rng(seed)
    x = np.repeat(rng.uniform(-0.8, 0.8, (count, 3)), 3, axis=0) + rng.uniform(-size, size, (3 * count, 3))
    return x, np.arange(3 * count, dtype=np.int32).reshape(-1, 3)


def lattice(n: int) -> np.ndarray:
    """Barycentric coordinates (m, 3) of a lattice with n parts along a side."""
    i, j = (part.ravel() for part in np.mgrid[: n + 1, : n + 1])
    return np.column_stack([i, j, n - i - j])[i + j <= n] / n


def sampled(body: k.Body, x: np.ndarray, n: int = 60) -> np.ndarray:
    """The least distance (ne,) over triangles x (ne, 3, 3) among samples of each."""
    inside = lattice(n)
    return np.array([body.distance(inside @ corners)[0].min() for corners in x])


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("size", [0.05, 0.6])
def test_the_least_distance_over_a_triangle_is_that_of_samples(name, size):
    x, cells = triangles(60, size)
    found, _ = BODIES[name].lowest_each(x, cells, TOLERANCE)
    expected = sampled(BODIES[name], x[cells])
    # Samples miss the lowest place by less than their distance, and none is below what is found.
    assert (found <= expected + TOLERANCE).all()
    assert (found >= expected - size / 20).all()
    lowest, cell, place = BODIES[name].lowest(x, cells, TOLERANCE)
    assert abs(lowest - found.min()) <= TOLERANCE and found[cell] - lowest <= TOLERANCE
    at = np.array(place) @ x[cells[cell]]
    assert BODIES[name].distance(at[None])[0][0] == pytest.approx(lowest, abs=1e-12)


def test_the_lowest_place_of_a_triangle_over_a_ball_is_below_its_middle():
    """A ball of 0.1 below the middle of a triangle whose corners are 0.3 away: nodes see 0.2, the triangle 0.05."""
    x = np.array([[0.3 * np.cos(a), 0.3 * np.sin(a), 0.15] for a in (0.0, 2 * np.pi / 3, 4 * np.pi / 3)])
    ball = k.Body.sphere(np.zeros(3), 0.1)
    lowest, _, place = ball.lowest(x, np.array([[0, 1, 2]]), 1e-6)
    assert lowest == pytest.approx(0.05, abs=1e-6) and place == pytest.approx([1 / 3] * 3, abs=1e-3)


@pytest.mark.parametrize("name", BODIES)
def test_a_share_of_a_way_lets_no_triangle_below_the_floor(name):
    body, floor, deeper = BODIES[name], -0.01, 0.02
    x, cells = triangles(40, 0.3, seed=8)
    outside = np.flatnonzero(body.lowest_each(x, cells, TOLERANCE)[0] > floor + deeper + TOLERANCE)
    far = np.random.default_rng(2).uniform(-2.0, 2.0, x.shape)
    stopped = 0
    for e in outside:
        share = body.step_share(x, far, cells[e : e + 1], floor, deeper, TOLERANCE)
        depths = [body.lowest(x + t * far, cells[e : e + 1], TOLERANCE)[0] for t in np.linspace(0.0, share, 40)]
        assert min(depths) >= floor - 2 * TOLERANCE
        if share < 1.0:
            stopped += 1
            # It goes until it is there; along kinks inside of sharp bodies somewhat less.
            assert depths[-1] < 0.25 * floor if "box" in name or name == "cylinder" else depths[-1] < 0.95 * floor
    assert stopped > len(outside) / 8
    # Together they go as far as the first of them.
    each = [body.step_share(x, far, cells[e : e + 1], floor, deeper, TOLERANCE) for e in outside]
    assert body.step_share(x, far, cells[outside], floor, deeper, TOLERANCE) == pytest.approx(min(each), rel=0.1)


def short_ways(x: np.ndarray, seed: int) -> np.ndarray:
    """Ways (n, 3) at random, no longer than 0.2: most triangles are seen to stay clear, some are not."""
    rng = np.random.default_rng(seed)
    ways = rng.normal(size=x.shape)
    return ways * rng.uniform(0.0, 0.2, (len(x), 1)) / np.linalg.norm(ways, axis=1)[:, None]


@pytest.mark.parametrize("name", BODIES)
def test_no_triangle_that_comes_nearer_is_left_out(name):
    """Random places and short ways against samples of all triangles along the whole way."""
    body = BODIES[name]
    floor, deeper, inside = -0.005, 0.01, lattice(8)
    x, cells = triangles(400, 0.1, seed=11)
    d = short_ways(x, seed=12)
    x, d = (values[cells[body.distances(x)[cells].min(axis=1) < 0.3]].reshape(-1, 3) for values in (x, d))
    cells = np.arange(len(x), dtype=np.int32).reshape(-1, 3)
    cells = cells[body.lowest_each(x, cells, TOLERANCE)[0] > floor + deeper + TOLERANCE]
    shares = np.array([body.step_share(x, d, cells[e : e + 1], floor, deeper, TOLERANCE) for e in range(len(cells))])
    times = np.linspace(0.0, 1.0, 5)
    gone = x[cells] + times[:, None, None, None] * shares[:, None, None] * d[cells]
    lowest = body.distances((inside @ gone).reshape(-1, 3)).reshape(len(times), len(cells), -1).min(axis=(0, 2))
    assert lowest.min() >= floor - 2 * TOLERANCE
    # Neither are all of them kept, nor stopped.
    assert (shares == 1.0).sum() > len(cells) / 4 and (shares < 1.0).any()


@pytest.mark.parametrize("name", BODIES)
def test_what_is_enough_changes_no_distance_below_it(name):
    body, (x, cells) = BODIES[name], triangles(200, 0.3, seed=5)
    enough = np.random.default_rng(6).uniform(-0.3, 0.5, len(cells))
    exact, radius = body.lowest_each(x, cells, TOLERANCE)
    found, own = body.lowest_each(x, cells, TOLERANCE, enough)
    below = found < enough
    assert below.any() and not below.all()
    assert (exact[~below] >= enough[~below] - TOLERANCE).all()
    np.testing.assert_allclose(found[below], exact[below], atol=TOLERANCE, rtol=0)
    assert np.isinf(own[~below]).all()
    same = below & (found == exact)
    assert same.sum() > 0.9 * below.sum()
    np.testing.assert_array_equal(own[same], radius[same])


def test_nothing_passes_a_needle_between_the_corners_of_a_triangle():
    """A needle of 1 mm across, a triangle of 100 mm, a way of 10 m: it stops at the needle."""
    needle = k.Body.capsule((-1.0, 0.01, 0.0), (1.0, 0.01, 0.0), 5e-4)
    x = np.array([[-0.05, -0.05, 5.0], [0.05, -0.05, 5.0], [0.0, 0.05, 5.0]])
    share = needle.step_share(x, np.tile([0.0, 0.0, -10.0], (3, 1)), np.array([[0, 1, 2]]), -1e-4, 2e-4, 1e-5)
    assert 5.0 - 10.0 * share == pytest.approx(5e-4 - 1e-4, abs=5e-5)


def test_what_is_below_the_floor_goes_no_deeper_than_allowed_and_may_leave():
    ball = k.Body.sphere(np.zeros(3), 0.1)
    x, cells = np.array([[0.0, 0, 0.05], [0.01, 0, 0.05], [0, 0.01, 0.05]]), np.array([[0, 1, 2]])
    down, up = np.tile([0.0, 0, -0.2], (3, 1)), np.tile([0.0, 0, 0.2], (3, 1))
    assert ball.step_share(x, down, cells, -0.01, 0.02, 1e-5) == pytest.approx(0.1, abs=1e-3)
    assert ball.step_share(x, down, cells, -0.01, 0.02, 1e-5, -0.06) == pytest.approx(0.025, abs=1e-3)
    assert ball.step_share(x, down, cells, -0.01, 0.02, 1e-5, -0.04) < 1e-3
    assert ball.step_share(x, up, cells, -0.01, 0.02, 1e-5) == 1.0


def test_the_radius_of_curvature_is_that_of_the_nearest_feature():
    """Of a cylinder of 0.4 with a rounding of 0.1: its side, its rim, its flat end."""
    drum = k.Body.cylinder((0, 0, -1), (0, 0, 1), 0.4, 0.1)
    for place, radius in (((0.45, 0, 0), 0.4), ((0.4, 0, 1.0), 0.1), ((0.1, 0, 1.05), np.inf)):
        x = np.array(place) + 1e-6 * np.array([[0, 1.0, 0], [0, -1, 0], [1, 0, 0]])
        _, found = drum.lowest_each(x, np.array([[0, 1, 2]]), 1e-8)
        # At the rim two principal radii add up: the other one is that of the rim's circle.
        assert found[0] == radius or found[0] == pytest.approx(radius, rel=0.15)
