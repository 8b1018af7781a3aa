"""A new mesh on the shape before: in one map where that serves, in more where triangles would be of low quality."""

import numpy as np
import pytest
from mesh_samples import holed_mesh

from restshape import _kernels
from restshape.mesh import moved_meshes
from restshape.mesh.moved_meshes import moved_to
from restshape.mesh.relocate import BoundaryNodes, extension


@pytest.fixture
def maps(monkeypatch):
    """Counts the maps that are made."""
    made = []

    def counted(*arguments):
        made.append(arguments)
        return extension(*arguments)

    monkeypatch.setattr(moved_meshes, "extension", counted)
    return made


def test_a_linear_motion_takes_one_map_and_is_exact(maps):
    mesh = holed_mesh()
    stretch = np.array([[1.1, 0.05], [0.0, 0.9]])
    X = moved_to(mesh, mesh.outline.moved(mesh.outline.points @ stretch + 0.3))
    assert len(maps) == 1
    np.testing.assert_allclose(X, mesh.X @ stretch + 0.3, atol=1e-12)


def test_a_hole_that_goes_far_takes_more_maps_than_one_and_keeps_the_triangles(maps):
    mesh = holed_mesh()
    boundary, outline = BoundaryNodes(mesh), mesh.outline
    hole = np.unique([(outline.edges[e].start, outline.edges[e].end) for e, _ in outline.loops[1].edges])
    points = outline.points.copy()
    points[hole] += [0.15, 0.1]
    there = outline.moved(points)
    values = boundary.values(there, points) - mesh.X[boundary.nodes]
    at_once = mesh.X + extension(mesh, boundary.nodes, "harmonic")(values)
    X = moved_to(mesh, there)
    quality = [_kernels.check_cells(places, mesh.cells, 0.0, 0.0)[0] for places in (mesh.X, at_once, X)]
    assert len(maps) > 1
    assert quality[1] < 0.5 * quality[0] and quality[2] > quality[1]
    np.testing.assert_allclose(X[boundary.nodes], boundary.values(there, points), atol=1e-12)


def test_half_a_turn_of_a_hole_has_no_such_mesh(maps):
    """In the middle of the way all of the hole's points are in one place."""
    mesh = holed_mesh()
    outline = mesh.outline
    hole = np.unique([(outline.edges[e].start, outline.edges[e].end) for e, _ in outline.loops[1].edges])
    points = outline.points.copy()
    points[hole] = 2.0 * points[hole].mean(axis=0) - points[hole]
    X = moved_to(mesh, outline.moved(points))
    quality, invalid, _ = _kernels.check_cells(X, mesh.cells, 0.0, 0.0)
    assert invalid or quality < moved_meshes.LEAST
