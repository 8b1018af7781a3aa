"""Normals of free faces go with the nodes of a body: tractions are taken out of its walls as they lie."""

from types import SimpleNamespace

import numpy as np
import pytest
from mesh_samples import SQUARE, grid, mesh_of, polygon_outline

from restshape.mesh.extrude import Extrusion
from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.physics.elasticity.free_faces import FreeFaces

TENSOR = [[0, 2, 5], [2, 1, 4], [5, 4, 3]]


@pytest.mark.parametrize("order", [1, 2])
def test_walls_that_have_been_sheared_are_without_tractions(order):
    X, cells = grid(4, 4, 1.0, 1.0)
    mesh = mesh_of(polygon_outline(SQUARE), X, cells)
    plane = mesh if order == 1 else LagrangeSpace(mesh)
    body = Extrusion(plane, 2, 0.1)
    faces = FreeFaces(body, SimpleNamespace(mask=np.zeros(body.X.shape, dtype=np.uint8)))
    left, right = (np.flatnonzero(np.abs(plane.X[:, 0] - x) < 1e-12) for x in (0.0, 1.0))
    corner = np.abs(plane.X[:, 1] - 0.5) > 0.499
    plane.X[:, 0] += 0.5 * plane.X[:, 1]
    body.follow()
    nodal = np.random.default_rng(0).normal(size=(1, len(body.X), 6))
    faces.remove_tractions(nodal)
    columns = nodal[0, :, TENSOR].transpose(2, 0, 1).reshape(len(plane.X), body.levels, 3, 3)
    normal = np.array([1.0, -0.5, 0.0]) / np.hypot(1.0, 0.5)
    for side in (left, right):
        np.testing.assert_allclose(columns[side] @ normal, 0.0, atol=1e-14)
        assert np.abs(columns[side[~corner[side]]]).max() > 0.1
    # Two walls that meet at a corner and the face above leave nothing.
    np.testing.assert_allclose(columns[left[corner[left]]][:, [0, -1]], 0.0, atol=1e-14)
    assert np.abs(columns[:, 1:-1] @ [0.0, 0.0, 1.0]).max() > 0.1
