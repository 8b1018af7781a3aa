"""Transfer of fields between meshes: exact for linear ones, second order for smooth ones."""

import numpy as np
import pytest
from mesh_samples import holed_mesh, l_mesh, shaken

from restshape import _kernels
from restshape.mesh.extrude import Extrusion
from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.mesh.plate import PlateMesh
from restshape.mesh.quality import areas
from restshape.mesh.transfer import Transfer, transfer


def test_linear_fields_are_exact_between_meshes_of_one_shape():
    for make in (l_mesh, holed_mesh):
        old, new = make(4), shaken(make(7), 0.004, seed=9)
        plane = np.array([[1.0, -2.0], [0.5, 3.0]])
        found = transfer(old, new, old.X @ plane + 1.0)
        assert np.abs(found - (new.X @ plane + 1.0)).max() < 1e-11


def test_smooth_fields_converge_with_second_order():
    def field(mesh):
        return (np.sin(2 * mesh.X[:, 0]) * np.cos(mesh.X[:, 1]))[:, None]

    new = l_mesh(13)
    errors = [np.sqrt(np.mean((transfer(old, new, field(old)) - field(new)) ** 2)) for old in map(l_mesh, (4, 8, 16))]
    assert np.log2(errors[0] / errors[2]) / 2 > 1.8


def test_curvature_that_gradients_show_makes_errors_smaller():
    """Linear fields are exact still, also at points outside; of a parabola a fifth of the error is left inside."""
    old, new = shaken(l_mesh(16), 0.004, seed=5), l_mesh(13)
    plane = old.X @ np.array([[1.0, -2.0], [0.5, 3.0]])
    there = Transfer(old, new.X)
    np.testing.assert_allclose(there.curved(plane), there(plane), atol=1e-11)
    parabola, exact = (np.sum(mesh.X**2, axis=1, keepdims=True) for mesh in (old, new))
    inside = np.ones(len(new.X), dtype=bool)
    inside[new.facets] = False
    plain, curved = (
        np.sqrt(np.mean((found - exact)[inside] ** 2)) for found in (there(parabola), there.curved(parabola))
    )
    assert curved < 0.25 * plain


def test_points_are_found_in_the_triangle_that_holds_them():
    mesh = holed_mesh()
    rng = np.random.default_rng(2)
    cells = rng.integers(0, len(mesh.cells), 500)
    weights = rng.dirichlet([1, 1, 1], 500)
    points = np.einsum("ij,ijk->ik", weights, mesh.X[mesh.cells[cells]])
    found, coordinates = _kernels.locate(mesh.X, mesh.cells, points)
    assert np.array_equal(found, cells)
    assert np.allclose(coordinates, weights, atol=1e-9)


@pytest.mark.parametrize("order", [1, 2])
def test_points_that_follow_each_other_are_found_in_the_same_triangles(order):
    """None of them lies on a side, where either of two triangles holds it."""
    mesh = holed_mesh()
    space = mesh if order == 1 else LagrangeSpace(mesh)
    rng = np.random.default_rng(2)
    cells = np.repeat(np.arange(len(mesh.cells)), 3)
    points = np.einsum("ij,ijk->ik", rng.dirichlet([1, 1, 1], len(cells)), mesh.X[mesh.cells[cells]])
    points = np.concatenate([points, [[2.5, 0.4]], points[::-1]])
    plain, close = Transfer(space, points), Transfer(space, points, close=True)
    assert np.array_equal(close.cells, plain.cells)
    np.testing.assert_allclose(close.weights, plain.weights, atol=1e-12)


def test_a_point_outside_takes_the_nearest_boundary_value():
    mesh = holed_mesh()
    interpolated = Transfer(mesh, np.array([[2.5, 0.4], [-0.3, -0.4], [0.75, 0.74], [0.6, 0.5]]))(mesh.X)
    assert np.allclose(interpolated, [[2.0, 0.4], [0.0, 0.0], [0.75, 0.75], [0.5, 0.5]], atol=1e-12)


def test_old_nodes_give_old_values_back():
    mesh = l_mesh()
    field = np.random.default_rng(0).normal(size=(len(mesh.X), 3))
    assert np.allclose(transfer(mesh, mesh, field), field, atol=1e-12)
    assert areas(mesh.X, mesh.cells).min() > 0


def test_cells_of_another_dimension_are_refused():
    body = Extrusion(l_mesh(2), 1, 0.1)
    with pytest.raises(ValueError, match="triangles in the plane, not between cells 'tet4'"):
        transfer(body, body, body.X)


def test_points_of_another_dimension_are_refused():
    plane = l_mesh(2)
    body = Extrusion(plane, 1, 0.1)
    with pytest.raises(ValueError, match="2 and 3 coordinates"):
        transfer(plane, body, plane.X)
    sheet = PlateMesh(plane, 0.1)
    with pytest.raises(ValueError, match="3 and 2 coordinates"):
        transfer(sheet, plane, plane.X)


@pytest.mark.parametrize("width", [1, 2, 3, 5])
def test_many_fields_at_once_are_each_as_alone(width):
    old, new = holed_mesh(4), holed_mesh(5)
    rows = np.random.default_rng(2).normal(size=(7, len(old.X), width))
    found = Transfer(old, new.X)
    together = np.empty((7, len(new.X), width))
    found.rows(rows, together)
    np.testing.assert_allclose(together, [found(row) for row in rows], rtol=0, atol=1e-14)


def test_rows_of_another_mesh_are_refused():
    old = holed_mesh(4)
    with pytest.raises(ValueError, match="a row that is not there"):
        Transfer(old, old.X).rows(np.zeros((2, len(old.X) - 1, 3)), np.empty((2, len(old.X), 3)))
