"""Distances from closed surfaces on grids: exact ones beside them, smoothness, the cache, and what is far."""

import os

import numpy as np
import pytest
from body_meshes import ball, box, torus, write

from restshape import _kernels
from restshape.errors import UserError
from restshape.mesh import surface_distance
from restshape.mesh.closed_surface import read_closed_surface
from restshape.mesh.surface_distance import cache_folder, distance_of_file

pytestmark = pytest.mark.skipif(not _kernels.has_cgal, reason="bodies of triangles need CGAL")


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    surface_distance._loaded.cache_clear()
    yield
    surface_distance._loaded.cache_clear()


@pytest.fixture(scope="module")
def ring(tmp_path_factory):
    """A ring, its distance, and places about it with their distances from a round one."""
    path = write(tmp_path_factory.mktemp("ring") / "ring.ply", torus(100, 50, 0.3, 0.1))
    u, v, r = np.random.default_rng(3).random((3, 400)) * [[2 * np.pi], [2 * np.pi], [0.03]] + [[0], [0], [0.085]]
    out = 0.3 + r * np.cos(v)
    x = np.column_stack([out * np.cos(u), out * np.sin(u), r * np.sin(v)])
    made = surface_distance.make_distance(read_closed_surface(path), 8e-3, 16e-3)
    return surface_distance._restored(made), x, r - 0.1


def test_winding_numbers_are_those_of_the_solid_angle(tmp_path):
    X, cells = torus(60, 30, 0.3, 0.1)
    search, x = _kernels.SurfaceSearch(X, cells), np.random.default_rng(0).uniform(-0.5, 0.5, (500, 3))
    exact, fast = search.winding(x, np.inf), search.winding(x)
    tube = np.hypot(np.hypot(x[:, 0], x[:, 1]) - 0.3, x[:, 2])
    sure = np.abs(tube - 0.1) > 2e-3
    np.testing.assert_allclose(exact[sure], tube[sure] < 0.1, atol=1e-12)
    assert np.abs(fast - exact).max() < 0.2


def test_two_bodies_in_one_another_are_one(tmp_path):
    (X, cells), n = ball(6, 0.2), len(ball(6, 0.2)[0])
    search = _kernels.SurfaceSearch(np.vstack([X, X + np.array([0.2, 0.0, 0.0])]), np.vstack([cells, cells + n]))
    distance, _ = search.nearest(np.array([[0.1, 0.0, 0.0], [0.1, 0.0, 0.3], [0.35, 0.0, 0.0]]))
    assert (distance < 0.0).tolist() == [True, False, True]


def test_the_distance_is_the_exact_one_of_a_ring(ring):
    body, x, exact = ring
    value, gradient, _ = body.grid.at(x)
    # Its chords are 0.2 mm deep across, and 0.2 mm along.
    assert np.abs(value - exact).max() < 6e-4
    assert np.abs(np.linalg.norm(gradient, axis=1) - 1.0).max() < 0.05
    assert body.facts.error < 5e-4 and body.facts.thin == pytest.approx(0.1, rel=0.1)


def test_second_derivatives_are_continuous_and_those_of_the_values(ring):
    body, x, _ = ring
    value, gradient, hessian = body.grid.at(x)
    assert np.isfinite(value).all()
    step, full = 1e-6, hessian[:, [0, 5, 4, 5, 1, 3, 4, 3, 2]].reshape(-1, 3, 3)
    for a in range(3):
        way = step * np.eye(3)[a]
        up, down = body.grid.at(x + way), body.grid.at(x - way)
        np.testing.assert_allclose((up[0] - down[0]) / (2.0 * step), gradient[:, a], atol=1e-7)
        np.testing.assert_allclose((up[1] - down[1]) / (2.0 * step), full[:, a], atol=1e-3 * np.abs(full).max())
    # Across faces of cells and of bricks, which lie on the lattice about the middle of the box.
    faces = np.round(x / 8e-3) * 8e-3
    low, high = body.grid.at(faces - 1e-9), body.grid.at(faces + 1e-9)
    inner = np.abs(low[0]) < body.facts.band
    for before, after in zip(low, high):
        assert np.abs(before - after)[inner].max() < 1e-5 * np.abs(before).max()


def test_beyond_the_band_the_body_still_pushes_out(ring):
    body, _, _ = ring
    at = np.linspace(0.0, 2.0 * np.pi, 7)
    deep = np.column_stack([0.31 * np.cos(at), 0.31 * np.sin(at), 0.0 * at])
    value, gradient, _ = body.grid.at(deep)
    assert (value < -0.05).all()
    outwards = np.column_stack([np.cos(at), np.sin(at), 0.0 * at])
    assert (np.einsum("ij,ij->i", gradient, outwards) > 0.0).all()
    far = np.array([[3.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.4]])
    assert (body.grid.values(far) >= [2.5, body.facts.band, 0.25]).all()


def test_no_gradient_is_longer_than_its_bound(tmp_path):
    """Also in the coarse grid deep within a cube, across whose medial planes it is steepest."""
    surface = read_closed_surface(write(tmp_path / "cube.ply", box((0.5, 0.5, 0.5))))
    made = surface_distance.make_distance(surface, 0.02)
    x = np.random.default_rng(0).uniform(-0.5, 0.5, (20000, 3))
    longest = surface_distance._grid(made).shapes(x)[:, 1].max()
    assert 1.5 < longest < made["numbers"][0] < 1.2 * longest


def test_what_the_filter_takes_from_beyond_exact_places_is_small():
    """The filter of cubic B-splines has the pole sqrt 3 - 2."""
    from scipy.ndimage import spline_filter1d

    one = np.zeros(101)
    one[50] = 1.0
    found = spline_filter1d(one, order=3)
    share = abs(found[50 + surface_distance.AROUND] / found[50])
    assert share == pytest.approx((2.0 - np.sqrt(3.0)) ** 6, rel=1e-6) and share < 4e-4


def test_triangles_in_a_line_do_not_change_the_distance(tmp_path):
    X, cells = box((0.5, 0.5, 0.5))
    a, b, c = cells[0].tolist()
    cut = [[a, len(X), c], [len(X), b, c], [a, b, len(X)]]
    joint = np.vstack([X, 0.5 * (X[a] + X[b])]), np.vstack([cells[1:], cut])
    x = np.random.default_rng(0).uniform(-0.55, 0.55, (500, 3))
    both = [read_closed_surface(write(tmp_path / "a.ply", one)) for one in (joint, (X, cells))]
    first, second = (surface_distance._grid(surface_distance.make_distance(one, 0.05)).values(x) for one in both)
    np.testing.assert_allclose(first, second, atol=1e-6)


def test_a_grid_of_the_cache_is_the_one_that_was_made(tmp_path, monkeypatch):
    path = write(tmp_path / "ball.ply", ball(8, 0.2))
    x = np.random.default_rng(1).uniform(-0.3, 0.3, (200, 3))
    made = distance_of_file(path, spacing=0.01)
    assert len(list(cache_folder().iterdir())) == 1
    surface_distance._loaded.cache_clear()
    monkeypatch.setattr(surface_distance, "make_distance", None)
    kept = distance_of_file(path, spacing=0.01)
    assert kept.facts == made.facts and np.array_equal(kept.grid.values(x), made.grid.values(x))
    monkeypatch.undo()


def test_the_cache_keeps_what_was_of_use_last(tmp_path, monkeypatch):
    names = [write(tmp_path / f"{k}.ply", ball(4, 0.2 + 0.1 * k)) for k in range(3)]
    distance_of_file(names[0], spacing=0.06)
    (first,) = cache_folder().iterdir()
    os.utime(first, (1.0, 1.0))
    distance_of_file(names[1], spacing=0.06)
    surface_distance._loaded.cache_clear()
    # It is of use again, before a third one takes the room of one of both.
    distance_of_file(names[0], spacing=0.06)
    assert first.stat().st_mtime > 1.0
    (second,) = set(cache_folder().iterdir()) - {first}
    os.utime(second, (2.0, 2.0))
    monkeypatch.setattr(surface_distance, "KEPT", 2.5 * max(first.stat().st_size, second.stat().st_size))
    # Another process takes one out between its being listed and looked at, which keeps none of the others.
    (gone := cache_folder() / "gone.npz").symlink_to("nowhere")
    distance_of_file(names[2], spacing=0.06)
    gone.unlink()
    assert first.exists() and not second.exists() and len(list(cache_folder().iterdir())) == 2


def test_another_file_of_the_name_has_another_grid(tmp_path):
    path = write(tmp_path / "ball.ply", ball(6, 0.2))
    first = distance_of_file(path, spacing=0.05).grid.values(np.zeros((1, 3)))
    write(path, ball(6, 0.4))
    assert distance_of_file(path, spacing=0.05).grid.values(np.zeros((1, 3)))[0] < first[0] - 0.15


def test_a_torn_file_of_the_cache_is_made_again(tmp_path):
    path = write(tmp_path / "ball.ply", ball(6, 0.2))
    distance_of_file(path, spacing=0.04)
    (kept,) = cache_folder().iterdir()
    kept.write_bytes(kept.read_bytes()[:2000])
    surface_distance._loaded.cache_clear()
    assert distance_of_file(path, spacing=0.04).facts.spacing == 0.04


@pytest.mark.parametrize("half", [0.005, 50.0])
def test_bodies_of_a_centimetre_and_of_100_metres(tmp_path, half):
    path = write(tmp_path / "cube.ply", box((half, half, half)))
    body = distance_of_file(path, 1.0, spacing=half / 10.0)
    x = half * np.array([[0.0, 0.0, 1.1], [0.0, 0.9, 0.0], [1.05, 0.3, 0.2]])
    np.testing.assert_allclose(body.grid.values(x), half * np.array([0.1, -0.1, 0.05]), atol=1e-2 * half)


@pytest.mark.parametrize("spacing", [1e-3, 1e-25, 1e-310])
def test_a_grid_too_large_is_refused(tmp_path, spacing):
    path = write(tmp_path / "cube.ply", box((1.0, 1.0, 1.0)))
    with pytest.raises(UserError, match="write a larger spacing"):
        distance_of_file(path, spacing=spacing)
