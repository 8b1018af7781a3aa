"""The bound on the Jacobian of curved triangles: closed forms, certainty, and cells that are known to be invalid."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sample_meshes import second_order, unit_box

from restshape import _kernels as k

UNIT = np.array([[0.0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5]])
CELL = np.arange(6, dtype=np.int32)[None]


def jacobian(X: np.ndarray, xi: np.ndarray) -> np.ndarray:
    """The determinant (m,) at reference coordinates xi (m, 2), from the monomials that interpolate the nodes."""

    def monomials(x, y):
        return np.column_stack([np.ones_like(x), x, y, x * x, x * y, y * y])

    c = np.linalg.solve(monomials(*UNIT.T), X)
    x, y = xi.T
    zero, one = np.zeros_like(x), np.ones_like(x)
    along = np.column_stack([zero, one, zero, 2 * x, y, zero]) @ c
    across = np.column_stack([zero, zero, one, zero, x, 2 * y]) @ c
    return along[:, 0] * across[:, 1] - along[:, 1] * across[:, 0]


def bound(X: np.ndarray) -> float:
    return float(k.curved_jacobian_bound(np.ascontiguousarray(X, dtype=float), CELL)[0])


def test_straight_cells_have_twice_their_area():
    X, cells, _ = second_order(*unit_box(2, 4))
    edges = X[cells[:, 1:3]] - X[cells[:, :1]]
    np.testing.assert_allclose(k.curved_jacobian_bound(X, cells), np.linalg.det(edges), rtol=1e-12)


def test_subset_is_in_its_own_order():
    X, cells, _ = second_order(*unit_box(2, 4), bend=0.02)
    some = np.array([5, 1, 1, 30], dtype=np.int32)
    assert np.array_equal(k.curved_jacobian_bound(X, cells, some), k.curved_jacobian_bound(X, cells)[some])
    with pytest.raises(ValueError, match="does not exist"):
        k.curved_jacobian_bound(X, cells, np.array([len(cells)], dtype=np.int32))
    with pytest.raises(ValueError, match="second-order"):
        k.curved_jacobian_bound(X, np.ascontiguousarray(cells[:, :3]))


@pytest.mark.parametrize("offset", [0.26, 0.4, 0.49])
def test_mid_side_node_within_the_middle_half_is_valid(offset):
    """A node at (t, 0) on a straight side: the Jacobian there is 4t - 1 at one end, 3 - 4t at the other."""
    X = UNIT.copy()
    X[3] = offset, 0
    assert bound(X) == pytest.approx(4 * offset - 1, abs=1e-14)
    X[3] = 1 - offset, 0
    assert bound(X) == pytest.approx(4 * offset - 1, abs=1e-14)


@pytest.mark.parametrize("offset", [0.25, 0.2, -0.1, 0.76])
def test_mid_side_node_outside_of_the_middle_half_is_invalid(offset):
    X = UNIT.copy()
    X[3] = offset, 0
    assert bound(X) <= 1e-14


@pytest.mark.parametrize(("sag", "valid"), [(-0.5, True), (0.0, True), (0.2, True), (0.24, True), (0.26, False)])
def test_side_bent_into_the_cell(sag, valid):
    """y = 4 s x (1 - x) at eta = 0: at the corners the angle of 90 degrees closes at s = 1/4 at the slanted side."""
    X = UNIT.copy()
    X[3] = 0.5, sag
    assert (bound(X) > 0) == valid


def test_turned_over_cell_is_invalid():
    assert bound(UNIT[[0, 2, 1, 5, 4, 3]]) == pytest.approx(-1.0)


def inverted(places: np.ndarray) -> bool:
    """Whether a displacement of the unit triangle to these places inverts it somewhere."""
    found = k.inverted_cells(UNIT, np.ascontiguousarray(places - UNIT), CELL)
    assert list(found) in ([], [0])
    return len(found) == 1


def test_inversion_between_the_nodes_is_seen():
    """x = r xi - xi^2 / 2, y = (s - xi) eta: the determinant (r - xi)(s - xi) is negative between r and s only."""
    xi, eta = UNIT.T

    def squeezed(r, s):
        return np.column_stack([r * xi - 0.5 * xi**2, (s - xi) * eta])

    for r, s in ((0.6, 0.9), (0.1, 0.4)):
        assert jacobian(squeezed(r, s), UNIT).min() > 0.03
        assert inverted(squeezed(r, s))
    assert not inverted(squeezed(1.1, 1.2)) and inverted(squeezed(1.1, 0.9))


def test_inversion_inside_is_seen():
    """x + i y = z - z^2 / (2 z0) - c (conjugate of z - z0) has the determinant |1 - z / z0|^2 - c^2, least at z0."""
    z = UNIT @ [1, 1j]
    z0 = 0.3 + 0.3j

    def folded(c):
        w = z - z * z / (2 * z0) - c * np.conj(z - z0)
        return np.column_stack([w.real, w.imag])

    # The nodes, all corners and the middles of all sides, are further from z0 than 0.2 |z0|.
    assert jacobian(folded(0.2), UNIT).min() > 0
    assert inverted(folded(0.2)) and inverted(folded(0.01))


def test_a_bound_that_is_too_low_inverts_nothing():
    """z - z^2 / (2 z0) has the determinant |1 - z / z0|^2, positive but at z0: just beside the middle of a side."""
    z, z0 = UNIT @ [1, 1j], 0.4 - 0.05j
    w = z - z * z / (2 * z0)
    places = np.column_stack([w.real, w.imag])
    assert bound(places) < -0.5
    assert not inverted(places)


@pytest.mark.slow
@settings(max_examples=300, deadline=None)
@given(st.lists(st.floats(-0.3, 0.3), min_size=12, max_size=12))
def test_a_cell_is_inverted_where_its_jacobian_is(moves):
    X = UNIT + np.reshape(moves, (6, 2))
    grid = np.array([(i / 60, j / 60) for i in range(61) for j in range(61 - i)])
    least = jacobian(X, grid).min()
    # A quadratic lies below its values at the points of a grid by an eighth of its curvature over a step at most.
    corners = jacobian(X, UNIT)
    curvature = 16 * np.abs(corners).sum()
    if least <= 0:
        assert inverted(X)
    elif least > curvature / 8 * (2 / 60**2):
        assert not inverted(X)


def test_what_has_no_number_is_inverted():
    for i in range(6):
        places = UNIT.copy()
        places[i, 1] = np.nan
        assert inverted(places)
    straight = np.ascontiguousarray(CELL[:, :3])
    assert list(k.inverted_cells(UNIT, np.zeros_like(UNIT), straight)) == []
    assert list(k.inverted_cells(UNIT, np.full_like(UNIT, np.nan), straight)) == [0]


@settings(max_examples=200, deadline=None)
@given(st.lists(st.floats(-0.3, 0.3), min_size=12, max_size=12))
def test_bound_is_below_the_jacobian_everywhere(moves):
    X = UNIT + np.reshape(moves, (6, 2))
    grid = np.array([(i / 20, j / 20) for i in range(21) for j in range(21 - i)])
    least = jacobian(X, grid).min()
    assert bound(X) <= least + 1e-12
    # ... and not far below: the coefficient of a side is its middle's value plus how far that is from the ends' mean.
    corners = jacobian(X, UNIT)
    bend = np.abs(corners[3:] - 0.5 * (corners[[0, 1, 2]] + corners[[1, 2, 0]])).max()
    assert bound(X) >= least - bend - 1e-12


def test_area_of_curved_triangles():
    """A side y = x (1 - x) below the unit right triangle adds its integral, 1/6."""
    X = UNIT.copy()
    X[3] = 0.5, -0.25
    assert k.total_area(X, CELL) == pytest.approx(1 / 2 + 1 / 6, rel=1e-14)
    assert k.total_area(X, np.ascontiguousarray(CELL[:, :3])) == pytest.approx(1 / 2, rel=1e-14)
