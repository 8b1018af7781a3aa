"""Crossings of cloth with itself, counted beside those that are known."""

import numpy as np
import pytest

from restshape.physics.cloth.contact.collision_surface import CollisionSurface


def grid(n):
    """Material coordinates and triangles of a unit square of n by n cells."""
    side = np.linspace(0.0, 1.0, n + 1)
    X = np.array([[a, b] for b in side for a in side])
    first = np.array([j * (n + 1) + i for j in range(n) for i in range(n)])
    cells = np.vstack([[first, first + 1, first + n + 2], [first, first + n + 2, first + n + 1]]).reshape(2, 3, -1)
    return X, np.concatenate(cells.transpose(0, 2, 1)).astype(np.int32)


def two_triangles(ends):
    """A surface of two, and its nodes in space: the second has an edge with these ends (2, 3), and is 0.1 wide."""
    X = np.array([[0.0, 0], [1, 0], [0, 1], [2, 0], [3, 0], [2, 1]])
    x = np.vstack([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]], ends, [np.add(ends[1], (0.1, 0.0, 0.0))]])
    return CollisionSurface(X, np.array([[0, 1, 2], [3, 4, 5]], dtype=np.int32)), x


@pytest.mark.parametrize(
    ("ends", "crosses"),
    [
        ([[0.2, 0.2, -1.0], [0.2, 0.2, 1.0]], True),
        ([[1.2, 0.2, -1.0], [1.2, 0.2, 1.0]], False),
        ([[0.2, 0.2, 1.0], [0.2, 0.2, 3.0]], False),
        # It ends in the triangle, and lies in its plane.
        ([[0.2, 0.2, 0.0], [0.2, 0.2, 1.0]], False),
        ([[0.2, -1.0, 0.0], [0.2, 1.0, 0.0]], False),
    ],
)
def test_two_triangles_cross_where_an_edge_goes_through_the_other(ends, crosses):
    surface, x = two_triangles(ends)
    assert surface.crossed(x).tolist() == ([0] if crosses else [])


def test_parts_that_are_sewn_together_do_not_cross():
    surface, x = two_triangles([[0.2, 0.2, -1.0], [0.2, 0.2, 1.0]])
    none = np.empty((0, 2), dtype=np.int32)
    # A node of the edge is one with a node of the triangle; then it is sewn to the middle of a side of it.
    assert surface.sew(np.array([0, 1, 2, 0, 3, 4]), none) and surface.crossed(x).tolist() == []
    assert not surface.sew(np.array([0, 1, 2, 0, 3, 4]), none)
    assert surface.sew(np.arange(6), np.array([[1, 3]], dtype=np.int32)) and not surface.crosses(x)
    assert surface.sew(np.arange(6), none) and surface.crosses(x)


@pytest.mark.parametrize(("height", "crosses"), [(0.05, False), (-0.05, True)])
def test_a_sheet_folded_over_crosses_where_its_flap_dips_below(height, crosses):
    """The flap stands over the sheet, or its free end is bent to below."""
    X, cells = grid(10)
    x = np.column_stack([X, np.zeros(len(X))])
    flap = X[:, 0] > 0.55
    x[flap, 0] = 1.1 - X[flap, 0] + 0.01
    x[flap, 1] += 0.013
    x[flap, 2] = 0.05
    x[X[:, 0] > 0.95, 2] = height
    surface = CollisionSurface(X, cells)
    crossed = surface.crossed(x)
    assert surface.crosses(x) is crosses and bool(len(crossed)) is crosses
    if crosses:
        # The row of edges that goes down passes through the row of triangles there: by a cell, 10 pairs along it.
        assert 10 <= len(crossed) <= 60
        # Nothing crosses away from it.
        assert x[cells[crossed], 0].max() < 0.4


def test_flat_cloth_has_no_crossings_and_no_numbers_none():
    X, cells = grid(4)
    x = np.column_stack([X, np.zeros(len(X))])
    assert len(CollisionSurface(X, cells).crossed(x)) == 0
    assert len(CollisionSurface(X, cells).crossed(x * np.nan)) == 0


def test_flat_cloth_that_is_turned_has_none_for_rounding():
    """Its triangles lie in one plane to rounding alone: an edge beside one of them does not pass through it."""
    X, cells = grid(20)
    surface = CollisionSurface(X, cells)
    for seed in range(5):
        random = np.random.default_rng(seed)
        x = np.column_stack([X, np.zeros(len(X))]) + np.pad(random.uniform(-0.01, 0.01, X.shape), ((0, 0), (0, 1)))
        turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
        assert len(surface.crossed(0.1 * x @ turn.T)) == 0


def test_what_crosses_does_so_no_more_where_a_place_is_no_number():
    surface, x = two_triangles([[0.2, 0.2, -1.0], [0.2, 0.2, 1.0]])
    assert surface.crosses(x)
    x[5, 0] = np.nan
    for _ in range(2):
        assert not surface.crosses(x) and len(surface.crossed(x)) == 0
        surface.sew(np.arange(6), np.empty((0, 2), dtype=np.int32))
