"""Bodies of triangles beside bodies in closed form: contact, friction, bounds over triangles, motion, derivatives."""

import numpy as np
import pytest
from body_meshes import ball, box, torus

from restshape import _kernels
from restshape.mesh.closed_surface import ClosedSurface
from restshape.mesh.surface_distance import _restored, make_distance
from restshape.physics.cloth.contact.contact import Contact
from restshape.shape.placement import rotation, rotation_rates

pytestmark = pytest.mark.skipif(not _kernels.has_cgal, reason="bodies of triangles need CGAL")


def grid_of(surface, spacing):
    X, cells = surface
    return _restored(make_distance(ClosedSurface(X, cells.astype(np.int32), 1.0), spacing)).grid


@pytest.fixture(scope="module")
def round_grid():
    return grid_of(ball(20, 0.2), 9e-3)


@pytest.fixture(scope="module")
def ring_grid():
    return grid_of(torus(48, 24, 0.3, 0.1), 12e-3)


def turned_ball(grid, scale=1.5):
    """A ball of triangles made larger, turned and moved, and the ball that it stands for."""
    place = np.array([0.1, -0.2, 0.3])
    return _kernels.Body.mesh(grid, place, rotation((0.3, -0.4, 0.5)).T, scale), _kernels.Body.sphere(
        place, 0.2 * scale
    )


def places_on(radius, count=300):
    way = np.random.default_rng(2).normal(size=(count, 3))
    return radius * way / np.linalg.norm(way, axis=1)[:, None] + np.array([0.1, -0.2, 0.3])


def test_distance_and_gradient_are_those_of_the_ball(round_grid):
    mesh, exact = turned_ball(round_grid)
    x = places_on(0.301)
    # Facets of 2 cm are turned by 2 degrees, and lie up to 0.3 mm within the ball.
    for found, wanted, most in zip(mesh.distance(x), exact.distance(x), (5e-4, 0.03)):
        assert np.abs(found - wanted).max() < most


def test_contact_force_and_tangent_are_the_derivatives_of_its_energy(ring_grid):
    body, step = _kernels.Body.mesh(ring_grid, np.zeros(3), np.eye(3)), 1e-6
    x, area = np.array([[0.4 + 5e-4, 0.0, 0.0], [0.3, 0.0, 0.1 - 2e-4], [0.21, 0.0, 0.03]]), np.ones(3)

    def found(x):
        table = np.zeros((3, 12))
        table[:, :3] = x
        return body.add_contact(x, area, 1e3, 2e-3, table), table

    _, table = found(x)
    for a in range(3):
        way = step * np.eye(3)[a]
        up, down = found(x + way), found(x - way)
        assert (up[0] - down[0]) / (2.0 * step) == pytest.approx(table[:, 3 + a].sum(), rel=1e-5, abs=1e-9)
        rates = (up[1][:, 3:6] - down[1][:, 3:6]) / (2.0 * step)
        own = table[:, 6:][:, [[0, 5, 4], [5, 1, 3], [4, 3, 2]][a]]
        np.testing.assert_allclose(rates, own, atol=1e-4 * np.abs(own).max())


def test_normals_of_friction_have_length_1_and_limits_are_the_normal_force(round_grid):
    mesh, _ = turned_ball(round_grid)
    x, area = places_on(0.3005), np.full(300, 1e-4)
    anchor, normal, limit, table = x.copy(), np.zeros((300, 3)), np.zeros(300), np.zeros((300, 12))
    mesh.add_contact(x, area, 1e6, 2e-3, table)
    _kernels.update_friction(x, table, 0.4, 1e-4, anchor, normal, limit)
    np.testing.assert_allclose(np.linalg.norm(normal, axis=1), 1.0, rtol=1e-12)
    np.testing.assert_allclose(limit, 0.4 * np.linalg.norm(table[:, 3:6], axis=1), rtol=1e-10)


def test_the_lowest_place_of_a_triangle_over_a_ring_is_found(ring_grid):
    body = _kernels.Body.mesh(ring_grid, np.zeros(3), np.eye(3))
    # It spans the hole, and lies on the ring with its corners and two of its sides.
    x = np.array([[0.45, 0.0, 0.098], [-0.25, 0.4, 0.098], [-0.25, -0.4, 0.098]])
    cells = np.array([[0, 1, 2]], dtype=np.int32)
    lowest, _, where = body.lowest(x, cells, 2e-4)
    b = np.random.default_rng(0).dirichlet(np.ones(3), 20000)
    sampled = body.distances(b @ x).min()
    assert sampled - 4e-4 < lowest < sampled + 4e-4
    assert body.distances(np.array([where]) @ x)[0] == pytest.approx(lowest, abs=1e-9)


@pytest.mark.parametrize("way", [(0.0, 0.0, -0.3), (0.3, 0.1, -0.3), (0.0, 0.0, 0.3)])
def test_no_step_leads_a_triangle_through_a_ring(ring_grid, way):
    body, floor = _kernels.Body.mesh(ring_grid, np.zeros(3), np.eye(3)), -1e-3
    x = np.array([[0.33, -0.02, 0.13], [0.33, 0.03, 0.13], [0.27, 0.0, 0.13]])
    cells, d = np.array([[0, 1, 2]], dtype=np.int32), np.tile(way, (3, 1))
    share = body.step_share(x, d, cells, floor, 1e-3, 4e-5)
    depths = [body.lowest(x + t * d, cells, 1e-5)[0] for t in np.linspace(0.0, share, 40)]
    assert min(depths) > floor - 1e-4
    assert share == 1.0 if way[2] > 0.0 else depths[-1] < floor + 5e-4


def test_no_triangle_that_comes_nearer_to_a_ring_is_left_out(ring_grid):
    """Random places and short ways around it against samples of all triangles along the whole way."""
    body, floor, rng = _kernels.Body.mesh(ring_grid, np.zeros(3), np.eye(3)), -1e-3, np.random.default_rng(4)
    u, v = rng.uniform(0.0, 2.0 * np.pi, (2, 600))
    out = 0.1 + rng.uniform(0.0, 0.06, 600)
    at = np.column_stack([(0.3 + out * np.cos(v)) * np.cos(u), (0.3 + out * np.cos(v)) * np.sin(u), out * np.sin(v)])
    x, d = at[:, None] + rng.uniform(-0.03, 0.03, (600, 3, 3)), rng.uniform(-0.02, 0.02, (600, 3, 3))
    b = np.vstack([np.eye(3), rng.dirichlet(np.ones(3), 40)])

    def lowest(x):
        return body.distances((b @ x).reshape(-1, 3)).reshape(len(x), -1).min(axis=1)

    clear = lowest(x) > 1e-3
    x, d, cells = x[clear], d[clear], np.array([[0, 1, 2]], dtype=np.int32)
    shares = np.array([body.step_share(at, way, cells, floor, 1e-3, 4e-5) for at, way in zip(x, d)])
    for part in np.linspace(0.0, 1.0, 6):
        assert lowest(x + part * shares[:, None, None] * d).min() > floor - 1e-4
    assert (shares == 1.0).sum() > len(x) / 4 and (shares < 1.0).sum() > len(x) / 20


def test_cloth_in_the_hole_of_a_ring_has_not_passed_it(ring_grid):
    x, cells = np.array([[0.0, 0.0, -0.05], [0.02, 0.0, -0.05], [0.0, 0.02, -0.05]]), np.array([[0, 1, 2]], np.int32)
    contact = Contact([_kernels.Body.mesh(ring_grid, np.zeros(3), np.eye(3))], np.ones(3), 1e3, 2e-3, cells=cells)
    down = np.array([0.0, 0.0, -1.0])
    assert not contact.passed(x, down)
    assert contact.passed(x - (0.0, 0.0, 0.1), down) and not contact.passed(x - (0.0, 0.0, 0.1), -down)


def test_rates_of_forces_are_those_of_moved_turned_and_larger_bodies(ring_grid):
    place, turn, scale = np.array([0.01, 0.02, 0.0]), np.array([0.1, 0.2, 0.3]), 1.1
    dplace, dturn, dscale, step = np.array([0.3, -0.2, 0.5]), np.array([0.4, 0.1, -0.3]), 0.7, 1e-6

    def made(t):
        turns = rotation(turn + t * dturn).T
        return _kernels.Body.mesh(ring_grid, place + t * dplace, turns, scale + t * dscale)

    rates = _kernels.BodyRates.mesh(
        ring_grid, place, rotation(turn).T, scale, dplace, rotation_rates(turn, dturn).T, dscale
    )
    u = np.linspace(0.0, 6.0, 20)
    local = np.column_stack([0.3 * np.cos(u), 0.3 * np.sin(u), 0.1 + 0.0 * u])
    x, area, zero = scale * local @ rotation(turn).T + place, np.full(20, 1e-3), np.zeros((20, 3))
    out = np.zeros((20, 3))
    constant = (1e5, 0.0), (5e-3, 0.0), (0.0, 0.0), (1e-4, 0.0)
    rates.add_force_rates(x, zero, area, 0.0 * area, *constant, x, zero, 0.0 * area, out)

    def force(body):
        table = np.zeros((20, 12))
        body.add_contact(x, area, 1e5, 5e-3, table)
        return table[:, 3:6]

    wanted = (force(made(step)) - force(made(-step))) / (2.0 * step)
    np.testing.assert_allclose(out, wanted, atol=1e-4 * np.abs(wanted).max())


def test_a_sharp_edge_holds_what_lies_on_it():
    body = _kernels.Body.mesh(grid_of(box((0.1, 0.1, 0.1)), 5e-3), np.zeros(3), np.eye(3))
    x = np.array([[0.1, 0.0, 0.1], [0.1, 0.1, 0.1], [0.05, 0.0, 0.1]])
    distance, gradient, _ = body.distance(x)
    # The edge is rounded by about one spacing, a corner by somewhat more.
    assert (np.abs(distance) < [1.5e-3, 4e-3, 2e-4]).all()
    assert gradient[0] @ (1.0, 0.0, 1.0) > 0.7 and gradient[1] @ (1.0, 1.0, 1.0) > 0.7


def test_least_distances_by_quadratics_are_those_of_dense_samples(ring_grid):
    """Triangles about a ring's grid, as large as its tube and smaller."""
    body, rng = _kernels.Body.mesh(ring_grid, np.zeros(3), np.eye(3)), np.random.default_rng(8)
    u, v = rng.uniform(0.0, 2.0 * np.pi, (2, 300))
    out = 0.1 + rng.uniform(-0.01, 0.03, 300)
    at = np.column_stack([(0.3 + out * np.cos(v)) * np.cos(u), (0.3 + out * np.cos(v)) * np.sin(u), out * np.sin(v)])
    size = rng.choice([0.005, 0.02, 0.06], (300, 1, 1))
    x = (at[:, None] + size * rng.uniform(-1.0, 1.0, (300, 3, 3))).reshape(-1, 3)
    found, _ = body.lowest_each(x, np.arange(900, dtype=np.int32).reshape(-1, 3), 1e-4)
    b = np.vstack([np.eye(3), rng.dirichlet(np.ones(3), 400)])
    sampled = body.distances((b @ x.reshape(300, 3, 3)).reshape(-1, 3)).reshape(300, -1).min(axis=1)
    # Samples miss the least distance by some of their spacing, but are never below it by more than the tolerance.
    assert (found - sampled).max() < 2e-4
    assert (sampled - found).max() < 5e-3


def test_cloth_that_moves_has_its_points_looked_at_once_it_has_gone_some_way(ring_grid):
    x, cells = (
        np.array([[0.28, 0.0, 0.1012], [0.33, 0.02, 0.1012], [0.33, -0.02, 0.1012]]),
        np.array([[0, 1, 2]], np.int32),
    )
    contact = Contact([_kernels.Body.mesh(ring_grid, np.zeros(3), np.eye(3))], np.ones(3), 1e3, 2e-3, cells=cells)
    far = x + np.array([0.0, 0.0, 0.05])
    contact.cut(far, moving=True)
    assert not len(contact.points.cut)
    contact.cut(far - 1e-4, moving=True)
    assert not len(contact.points.cut)
    contact.cut(x, moving=True)
    assert len(contact.points.cut) == 1
    kept = contact.points
    contact.cut(x + 1e-5, moving=True)
    assert contact.points is kept
