"""Cloth that passes through itself in few places is moved apart there."""

import numpy as np
import pytest

from restshape import _kernels
from restshape.physics.cloth.contact.collision_surface import CollisionSurface
from restshape.physics.cloth.contact.out_of_bodies import Bodies
from restshape.physics.cloth.self_contact.untangling import Untangling


def folded(height, n=10):
    """A unit square whose flap stands over the rest, its free end bent to a height [m] there, and its places."""
    side = np.linspace(0.0, 1.0, n + 1)
    X = np.array([[a, b] for b in side for a in side])
    first = np.array([j * (n + 1) + i for j in range(n) for i in range(n)])
    cells = np.concatenate([np.column_stack([first, first + a, first + b]) for a, b in ((1, n + 2), (n + 2, n + 1))])
    x = np.column_stack([X, np.zeros(len(X))])
    flap = X[:, 0] > 0.55
    x[flap] = np.column_stack([1.11 - X[flap, 0], X[flap, 1] + 0.013, np.full(flap.sum(), 0.05)])
    x[X[:, 0] > 0.95, 2] = height
    return CollisionSurface(X, cells.astype(np.int32)), x


def two_triangles():
    """A triangle whose tip goes through another one, both of them without a right angle between them."""
    X = np.array([[0.0, 0], [1, 0], [0, 1], [2, 0], [3, 0], [2, 1]])
    x = np.array([[0.0, 0, 0], [1, 0, 0.1], [0, 1, -0.1], [0.3, 0.25, -0.2], [0.2, 0.2, 0.7], [0.5, 0.3, 0.6]])
    return CollisionSurface(X, np.array([[0, 1, 2], [3, 4, 5]], dtype=np.int32)), x


def test_nodes_move_against_the_derivative_of_the_length_of_the_contour():
    surface, x = two_triangles()
    cloth = Untangling(surface)

    def length(x):
        at = cloth.piercings(x, surface.crossed(x))
        assert len(at.edge) == 2
        ends = x[surface.edges[at.edge]]
        places = ends[:, 0] + at.share[:, None] * (ends[:, 1] - ends[:, 0])
        assert places == pytest.approx(np.einsum("kc,kca->ka", at.weights, x[surface.cells[at.cell]]))
        return np.linalg.norm(places[1] - places[0])

    numbers = np.zeros_like(x)
    for k in np.ndindex(*x.shape):
        way = np.zeros_like(x)
        way[k] = 1e-6
        numbers[k] = (length(x + way) - length(x - way)) / 2e-6
    found = cloth.shortening(x, cloth.piercings(x, surface.crossed(x)))
    assert found == pytest.approx(-numbers, abs=1e-8)


@pytest.mark.parametrize("height", [-0.02, -0.05])
def test_a_flap_that_dips_through_the_sheet_is_moved_out(height):
    surface, x = folded(height)
    assert surface.crosses(x)
    found = Untangling(surface).apart(x, np.ones(len(x), bool))
    assert not surface.crosses(found)
    # It moves by about what it has come through by, and nothing far from it moves.
    assert np.abs(found - x).max() < 4.0 * abs(height) + 0.02 and (found == x).all(axis=1).any()


def test_what_is_held_stays():
    surface, x = folded(-0.05)
    movable = surface.flat[:, 0] > 0.55
    found = Untangling(surface).apart(x, movable)
    assert not surface.crosses(found) and np.array_equal(found[~movable], x[~movable])
    assert Untangling(surface).apart(x, np.zeros(len(x), bool)) is None


def test_nothing_is_moved_into_a_body():
    """The border of the sheet would give way downwards, where there is a table."""
    surface, x = folded(-0.05)
    movable, border = np.ones(len(x), bool), surface.flat[:, 0] == 0.0
    assert Untangling(surface).apart(x, movable)[border, 2].min() < -0.01
    table = Bodies([_kernels.Body.box((-0.1, 0.5, -0.112), (0.15, 1.0, 0.1), None, 4e-3)])
    found = Untangling(surface, table, 0.01).apart(x, movable)
    assert not surface.crosses(found) and table.distance(found)[0].min() > 0.01 - 1e-3


def test_parts_that_are_sewn_together_move_as_one():
    surface, x = folded(-0.05)
    numbers = np.arange(len(x))
    lower, upper = (np.flatnonzero(surface.flat[:, 1] == side) for side in (0.0, 1.0))
    numbers[upper] = numbers[lower]
    surface.sew(numbers, np.empty((0, 2), np.int32))
    found = Untangling(surface).apart(x, np.ones(len(x), bool))
    assert not surface.crosses(found)
    assert (found - x)[upper] == pytest.approx((found - x)[lower], abs=1e-12)
