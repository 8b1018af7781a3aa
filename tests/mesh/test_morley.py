"""Nodes of Morley's triangle: numbers, signs, places, and what flips and ranks change."""

import numpy as np
import pytest
from mesh_samples import SQUARE, grid, mesh_of, polygon_outline

from restshape import _kernels as k
from restshape.mesh.hinges import hinges
from restshape.mesh.morley import MorleySpace

D = np.array([1.0, 0.3, 1.0, 0.0, 0.0, 0.35])


def square(node_offsets=None):
    mesh = mesh_of(polygon_outline(SQUARE), *grid(4, 4, 1.0, 1.0))
    if node_offsets is not None:
        mesh.node_offsets = np.array(node_offsets, dtype=np.int32)
    return mesh


def energy(space: MorleySpace, x: np.ndarray) -> float:
    params = np.column_stack([np.tile(D, (len(space.cells), 1)), space.signs])
    return k.Element("morley_tri6").energy(space.X, x, space.cells, params).sum()


def saddle(X: np.ndarray) -> np.ndarray:
    return np.column_stack([X, X[:, 0] * X[:, 1] - X[:, 1] ** 2])


def saddle_slopes(X: np.ndarray) -> np.ndarray:
    n = len(X)
    slopes = np.zeros((n, 3, 2))
    slopes[:, 0, 0] = slopes[:, 1, 1] = 1.0
    slopes[:, 2] = np.column_stack([X[:, 1], X[:, 0] - 2 * X[:, 1]])
    return slopes


# Second derivatives 0, -2 and 1 of the saddle: D22 4/2 + 4 D66 1/2.
SADDLE = 2.0 + 2 * 0.35


@pytest.mark.parametrize("offsets", [None, [0, 9, 25], [0, 5, 5, 17, 25]])
def test_a_quadratic_surface_has_its_energy(offsets):
    space = MorleySpace(square(offsets))
    np.testing.assert_allclose(energy(space, space.placed(saddle, saddle_slopes)), SADDLE, rtol=1e-12)


def test_corners_come_first_on_one_rank():
    mesh = square()
    space = MorleySpace(mesh)
    np.testing.assert_array_equal(space.corners, mesh.cells)
    np.testing.assert_array_equal(space.X[: len(mesh.X)], mesh.X)
    np.testing.assert_array_equal(space.side_number, len(mesh.X) + np.arange(len(mesh.edge_nodes)))


def test_each_rank_has_its_corners_and_the_edges_that_begin_there():
    mesh = square([0, 9, 25])
    space = MorleySpace(mesh)
    assert sorted([*space.corner_number, *space.side_number]) == list(range(space.n_nodes))
    assert space.node_offsets[-1] == space.n_nodes
    first = space.node_offsets[1]
    np.testing.assert_array_equal(space.corner_number < first, np.arange(25) < 9)
    np.testing.assert_array_equal(space.side_number < first, mesh.edge_nodes.min(axis=1) < 9)


def test_both_triangles_of_an_edge_see_it_from_opposite_sides():
    mesh = square()
    space = MorleySpace(mesh)
    total = np.zeros(space.n_nodes)
    np.add.at(total, space.cells[:, 3:], space.signs)
    inner = np.bincount(mesh.cell_edges.ravel()) == 2
    np.testing.assert_array_equal(total[space.side_number[inner]], 0.0)


def test_spanned_surfaces_are_exact_where_flat():
    mesh = square()
    space = MorleySpace(mesh)
    slope = np.random.default_rng(2).normal(size=(3, 2))
    flat = space.spanned(mesh.X @ slope.T + 1.0)
    expected = space.placed(lambda X: X @ slope.T + 1.0, lambda X: np.broadcast_to(slope, (len(X), 3, 2)))
    np.testing.assert_allclose(flat, expected, atol=1e-14)
    assert energy(space, flat) < 1e-24


def test_moved_nodes_keep_the_energy_of_a_quadratic():
    mesh = square()
    space = MorleySpace(mesh)
    inner = np.all((mesh.X > 1e-9) & (mesh.X < 1 - 1e-9), axis=1)
    mesh.X[inner] += np.random.default_rng(3).uniform(-0.05, 0.05, (inner.sum(), 2))
    space.place()
    np.testing.assert_allclose(energy(space, space.placed(saddle, saddle_slopes)), SADDLE, rtol=1e-12)


def test_hinges_are_the_inner_edges_with_their_corners_left_and_right():
    mesh = square()
    found = hinges(mesh.cells, mesh.cell_edges)
    assert len(found) == 56 - 16
    inner = {tuple(sorted(pair)) for pair in mesh.edge_nodes[np.bincount(mesh.cell_edges.ravel()) == 2]}
    assert {tuple(sorted(pair)) for pair in found[:, :2].tolist()} == inner
    a, b, left, right = mesh.X[found].swapaxes(0, 1)

    def doubled_area(p, q, r):
        return (q - p)[:, 0] * (r - p)[:, 1] - (q - p)[:, 1] * (r - p)[:, 0]

    assert (doubled_area(a, b, left) > 0).all() and (doubled_area(a, b, right) < 0).all()
