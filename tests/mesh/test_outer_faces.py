"""Bodies of several parts: faces inside of them do not count; and distances that end without a jump."""

import numpy as np
import pytest
from body_meshes import Surface, ball, box

from restshape import _kernels
from restshape.mesh import surface_distance
from restshape.mesh.closed_surface import ClosedSurface

pytestmark = pytest.mark.skipif(not _kernels.has_cgal, reason="bodies of triangles need CGAL")
BLOCK = (0.05, 0.1, 0.04)


def both(first: Surface, second: Surface, way: float) -> ClosedSurface:
    """Two surfaces as one, the second moved along x [m]."""
    (X, cells), (Y, others) = first, second
    corners, faces = np.vstack([X, Y + np.array([way, 0.0, 0.0])]), np.vstack([cells, others + len(X)])
    return ClosedSurface(corners, faces.astype(np.int32), 1.0)


def test_a_face_that_two_blocks_share_bounds_neither():
    from restshape.mesh.outer_faces import body_search

    x = np.array([[0.05, 0.0, 0.0], [0.04, 0.02, 0.01], [0.05, 0.0, 0.038], [0.05, 0.0, 0.05], [0.2, 0.0, 0.0]])
    distance, _ = body_search(both(box(BLOCK), box(BLOCK), 0.1), 0.004).nearest(x)
    np.testing.assert_allclose(distance, [-0.04, -0.03, -0.002, 0.01, 0.05], atol=1e-12)


def test_of_balls_that_meet_only_what_is_outside_of_the_other_bounds():
    from restshape.mesh.outer_faces import body_search

    surface = both(ball(8, 0.2), ball(8, 0.2), 0.2)
    search = body_search(surface, 0.004)
    distance, _ = search.nearest(np.array([[0.1, 0.0, 0.0], [0.2, 0.0, 0.0], [0.1, 0.0, 0.16], [0.1, 0.0, 0.2]]))
    rim = np.sqrt(0.03)
    away = np.hypot(0.1, 0.2) - 0.2
    # Facets and the smallest pieces at the rim are a few millimetres.
    np.testing.assert_allclose(distance, [-rim, -0.2, 0.16 - rim, away], atol=6e-3)
    # All faces together would be near to the middle of either ball.
    (distance,), _ = _kernels.SurfaceSearch(surface.X, surface.cells).nearest(np.array([[0.2, 0.0, 0.0]]))
    assert abs(distance) < 4e-3


@pytest.mark.parametrize("way", [0.2, 0.5])
@pytest.mark.parametrize("spacing", [2e-3, 0.013, 0.09])
def test_a_lattice_holds_the_distances_of_its_places(way, spacing):
    """Of two balls that meet, or not; beside the surface, far inside, far outside; where nothing is wanted, nothing."""
    from restshape.mesh.outer_faces import body_search

    search = body_search(both(ball(8, 0.2), ball(8, 0.2), way), 0.004)
    counts, rng = (18, 21, 11), np.random.default_rng(0)
    origin = np.array([0.1, 0.17, 0.03]) - spacing * np.array([9.1, 10.2, 5.3])
    wanted, values = rng.random(counts) < 0.7, np.full(counts, np.nan)
    wanted[:, :6] = False
    search.fill_lattice(origin, spacing, wanted.view(np.uint8), values)
    assert np.isnan(values[~wanted]).all()
    exact, _ = search.nearest(origin + spacing * np.argwhere(wanted))
    np.testing.assert_allclose(values[wanted], exact, rtol=0.0, atol=1e-15)
    assert (exact < 0.0).any() and (exact > 0.0).any()


@pytest.mark.parametrize("spacing", [0.02, 0.04, 0.1])
def test_a_lattice_finds_the_nearest_of_many_small_bodies(spacing):
    """As far apart as blocks are wide: what is nearest to a corner of one is far from its middle."""
    rng = np.random.default_rng(3)
    corners = 0.01 * np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    X = (rng.random((60, 1, 3)) + corners).reshape(-1, 3)
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    cells = (4 * np.arange(60)[:, None, None] + faces).reshape(-1, 3).astype(np.int32)
    search, counts = _kernels.SurfaceSearch(X, cells), np.full(3, round(1.0 / spacing))
    values = np.full(counts, np.nan)
    search.fill_lattice(np.full(3, 0.003), spacing, np.ones(counts, np.uint8), values)
    exact = search.nearest(0.003 + spacing * np.argwhere(np.ones(counts)))[0]
    np.testing.assert_allclose(values.ravel(), exact, rtol=0.0, atol=1e-15)


def test_contact_ends_without_a_jump():
    """The spline is rounder than edges: beside them it is below the way beyond the box of the surface."""
    surface = ClosedSurface(*box(BLOCK), 1.0)
    made = surface_distance.make_distance(surface, 12e-3)
    body = _kernels.Body.mesh(surface_distance._grid(made), np.zeros(3), np.eye(3))
    low, high = surface.box
    x = np.random.default_rng(0).uniform(low - 0.02, high + 0.02, (20000, 3))
    beyond = np.maximum(low - x, x - high).max(axis=1)
    distance = body.distances(x)
    near = beyond > 0.0
    assert (distance - beyond)[near].min() < -1e-5
    for thickness in (1e-3, 2e-3, 5e-3):
        for own in x[near & (distance < thickness)][:2000:20]:
            found = np.zeros((1, 12))
            assert body.add_contact(own[None], np.ones(1), 1.0, thickness, found, False) > 0.0
