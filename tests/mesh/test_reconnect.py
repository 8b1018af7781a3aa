"""Delaunay flips: area, the empty circle, kept edges, edge numbers."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mesh_samples import holed_mesh, random_square, shaken

from restshape import _kernels
from restshape.mesh.mesh import Mesh, cells_left_of
from restshape.mesh.quality import areas
from restshape.mesh.reconnect import Reconnection, edges_between


def circle_violations(mesh: Mesh, X: np.ndarray) -> list[int]:
    """Edges that are no facet and whose circle through one triangle holds the other's corner: from the determinant."""
    facets = {frozenset(pair) for pair in mesh.facets.tolist()}
    sides: dict[int, list[int]] = {}
    for cell, edges in enumerate(mesh.cell_edges):
        for edge in edges:
            sides.setdefault(int(edge), []).append(cell)
    found = []
    for edge, pair in sides.items():
        if len(pair) < 2 or frozenset(mesh.edge_nodes[edge].tolist()) in facets:
            continue
        left, right = mesh.cells[pair[0]], mesh.cells[pair[1]]
        d = next(n for n in right if n not in left)
        rows = X[left] - X[d]
        size = np.abs(rows).max()
        rows = rows / size
        if np.linalg.det(np.column_stack([rows, (rows**2).sum(axis=1)])) > 1e-8:
            found.append(edge)
    return found


def check_consistency(mesh: Mesh) -> None:
    """The edge opposite to each corner joins the other two, and every facet knows the cell on its left."""
    for i in range(3):
        others = np.sort(mesh.cells[:, [(i + 1) % 3, (i + 2) % 3]], axis=1)
        assert np.array_equal(others, mesh.edge_nodes[mesh.cell_edges[:, i]])
    assert len(np.unique(mesh.edge_nodes, axis=0)) == len(mesh.edge_nodes)
    assert np.array_equal(mesh.facet_cell, cells_left_of(mesh.facets, mesh.cells, len(mesh.X)))


def stretched(mesh: Mesh, seed: int = 2) -> np.ndarray:
    """Positions sheared and shaken, so that many edges are not Delaunay but no triangle is inverted."""
    X = mesh.X @ np.array([[1.0, 0.0], [0.9, 0.35]])
    assert areas(X, mesh.cells).min() > 0
    return X


def test_flips_make_a_holed_plate_delaunay_and_keep_its_area_and_interfaces():
    mesh = holed_mesh()
    X = stretched(mesh)
    before, total = mesh.cells.copy(), areas(X, mesh.cells).sum()
    assert circle_violations(mesh, X)
    flips, changed = Reconnection(mesh).flip(X)
    assert flips > 0 and not circle_violations(mesh, X)
    assert areas(X, mesh.cells).min() > 0
    assert areas(X, mesh.cells).sum() == pytest.approx(total, rel=1e-14)
    check_consistency(mesh)
    assert np.array_equal(np.sort(mesh.facets, axis=1), mesh.edge_nodes[edges_between(mesh.edge_nodes, mesh.facets)])
    differ = np.flatnonzero((np.sort(before, axis=1) != np.sort(mesh.cells, axis=1)).any(axis=1))
    assert changed.dtype == np.int32 and np.isin(differ, changed).all() and (np.diff(changed) > 0).all()


def test_a_flipped_edge_keeps_its_number_and_the_others_keep_their_ends():
    mesh = random_square([[0.3, 0.5], [0.7, 0.5]])
    X = mesh.X.copy()
    inner = [i for i, p in enumerate(X) if 0 < p[0] < 1 and 0 < p[1] < 1]
    X[inner] = [[0.5, 0.25], [0.5, 0.75]]
    edges = mesh.edge_nodes.copy()
    flips, _ = Reconnection(mesh).flip(X)
    different = (edges != mesh.edge_nodes).any(axis=1)
    assert 1 <= different.sum() <= flips
    check_consistency(mesh)


def test_one_quadrilateral_flips_by_hand():
    X = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.3], [0.0, 0.3]]) @ np.array([[1.0, 0.0], [1.5, 1.0]])
    cells = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)
    edge_nodes = np.array([[0, 1], [0, 2], [0, 3], [1, 2], [2, 3]], dtype=np.int32)
    cell_edges = np.array([[3, 1, 0], [4, 2, 1]], dtype=np.int32)
    free, fixed = np.zeros(5, dtype=np.uint8), np.ones(5, dtype=np.uint8)
    held = _kernels.Triangulation(cells.copy(), cell_edges.copy(), edge_nodes.copy(), fixed)
    assert held.flip_delaunay(X, 5)[0] == 0
    flips, changed = _kernels.Triangulation(cells, cell_edges, edge_nodes, free).flip_delaunay(X, 5)
    assert flips == 1 and changed.tolist() == [0, 1]
    assert edge_nodes.tolist() == [[0, 1], [1, 3], [0, 3], [1, 2], [2, 3]]
    assert {frozenset(c) for c in cells.tolist()} == {frozenset({0, 1, 3}), frozenset({1, 2, 3})}


def test_cocircular_points_do_not_flip_forever():
    mesh = holed_mesh()
    mesh.X[...] = np.round(mesh.X * 16) / 16
    assert Reconnection(mesh).flip(mesh.X)[0] == 0


@given(st.integers(0, 10**6), st.integers(2, 60))
@settings(max_examples=40, deadline=None)
def test_random_meshes_become_delaunay(seed, count):
    rng = np.random.default_rng(seed)
    mesh = random_square(rng.uniform(0.02, 0.98, (count, 2)))
    free = mesh.node_edge < 0
    X = mesh.X.copy()
    for scale in (0.3, 0.1, 0.03, 0.01, 0.0):
        X[free] = mesh.X[free] + scale * rng.uniform(-1, 1, (int(free.sum()), 2))
        if areas(X, mesh.cells).min() > 1e-7:
            break
    Reconnection(mesh).flip(X)
    assert not circle_violations(mesh, X)
    assert areas(X, mesh.cells).sum() == pytest.approx(1.0, rel=1e-12)
    assert areas(X, mesh.cells).min() > 0
    check_consistency(mesh)


def test_flips_repeat_bit_for_bit():
    results = []
    for _ in range(2):
        mesh = shaken(holed_mesh(), 0.004, seed=5)
        results.append((*Reconnection(mesh).flip(stretched(mesh)), mesh.cells.copy(), mesh.cell_edges.copy()))
    assert results[0][0] == results[1][0]
    assert all(np.array_equal(a, b) for a, b in zip(results[0][1:], results[1][1:]))
