"""Triangle quality: closed forms, and the compiled check against numpy."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from mesh_samples import author_ratios, l_mesh, qualities

from restshape import _kernels
from restshape.mesh.quality import thresholds

ONE = np.array([[0, 1, 2]], dtype=np.int32)
EQUILATERAL = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, np.sqrt(3) / 2]])


def test_the_equilateral_triangle_has_quality_one_and_the_authors_ratio():
    assert qualities(EQUILATERAL, ONE)[0] == pytest.approx(1.0, abs=1e-15)
    assert author_ratios(EQUILATERAL, ONE)[0] == pytest.approx(2 * np.sqrt(3), abs=1e-14)
    assert _kernels.check_cells(EQUILATERAL, ONE, 0.0, 0.3)[0] == pytest.approx(1.0, abs=1e-14)


def test_the_right_isosceles_triangle():
    X = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    inscribed = 1 - 1 / np.sqrt(2)
    assert author_ratios(X, ONE)[0] == pytest.approx(np.sqrt(2) / inscribed, rel=1e-14)
    assert qualities(X, ONE)[0] == pytest.approx(2 * np.sqrt(3) * inscribed / np.sqrt(2), rel=1e-14)


def test_quality_ignores_size_and_place_and_changes_sign_with_orientation():
    X = np.random.default_rng(0).normal(size=(3, 2))
    assert qualities(1e-3 * X + 7, ONE) == pytest.approx(qualities(X, ONE), rel=1e-9)
    assert qualities(X[::-1], ONE) == pytest.approx(-qualities(X, ONE), rel=1e-12)


@given(arrays(float, (12, 2), elements=st.floats(-1, 1, width=32)))
@settings(max_examples=60, deadline=None)
def test_the_compiled_check_agrees_with_numpy(X):
    cells = np.random.default_rng(1).permuted(np.tile(np.arange(12, dtype=np.int32), (150, 1)), axis=1)[:, :3].copy()
    with np.errstate(invalid="ignore", divide="ignore"):
        expected = qualities(X, cells)
    u, v = X[cells[:, 1]] - X[cells[:, 0]], X[cells[:, 2]] - X[cells[:, 0]]
    areas = 0.5 * (u[:, 0] * v[:, 1] - v[:, 0] * u[:, 1])
    clear = (np.abs(areas - 1e-3) > 1e-12) & ~(np.abs(expected - 0.3) < 1e-9)
    cells, expected, areas = cells[clear], expected[clear], areas[clear]
    lowest, inverted, distorted = _kernels.check_cells(X, cells, 1e-3, 0.3)
    assert inverted == np.sum(~(areas > 1e-3))
    assert distorted == np.sum(~(expected >= 0.3))
    if np.isfinite(expected).all():
        assert lowest == pytest.approx(min(expected.min(initial=1.0), 1.0), abs=1e-9)


@pytest.mark.parametrize("height", [0.8, 0.3, 1e-9, 0.0, -0.2])
def test_one_triangle_among_many_good_ones_is_found(height):
    """Wherever it is: where others are passed over without a root, and among the last that fill no register."""
    good = EQUILATERAL * 1.1 ** np.random.default_rng(2).uniform(size=(3, 2))
    worse = EQUILATERAL * (1.0, height / EQUILATERAL[2, 1])
    for place in (0, 1, 7, 8, 29, 98):
        X = np.tile(good, (99, 1))
        X[3 * place : 3 * place + 3] = worse
        cells = np.arange(297, dtype=np.int32).reshape(-1, 3)
        expected = qualities(X, cells)
        for floor in (-1.0, 0.0, 0.3, 0.95, 2.0):
            found = _kernels.check_cells(X, cells, 0.0, floor)
            assert found[0] == pytest.approx(expected.min(), abs=1e-14)
            assert found[1:] == (int(height <= 0.0), np.sum(~(expected >= floor)))


@pytest.mark.parametrize("lower", [1e-6, 1e-3, 0.03])
def test_a_triangle_that_is_hardly_worse_than_those_before_is_the_worst(lower):
    """Of nearly equilateral ones the quality from below is the quality itself: a looser one would pass them over."""
    X = np.tile(EQUILATERAL, (24, 1))
    X[3 * 17 : 3 * 18] *= (1.0, 1.0 - lower)
    cells = np.arange(72, dtype=np.int32).reshape(-1, 3)
    expected = qualities(X, cells)
    found = _kernels.check_cells(X, cells, 0.0, 0.5 * (1.0 + expected.min()))
    assert expected.min() < 1.0 - 0.1 * lower
    assert found[0] == pytest.approx(expected.min(), abs=1e-14) and found[1:] == (0, 1)


def test_a_coordinate_that_is_no_number_counts_as_inverted():
    X = EQUILATERAL.copy()
    X[1, 0] = np.nan
    assert _kernels.check_cells(X, ONE, 0.0, 0.3)[1:] == (1, 1)


def test_moving_and_checking_is_the_linear_map_and_the_check():
    mesh = l_mesh()
    rng = np.random.default_rng(4)
    Psi = rng.normal(size=(2, *mesh.X.shape)) * 0.01
    X = np.empty_like(mesh.X)
    found = _kernels.move_and_check(mesh.X, Psi, 0.3, -1.2, X, mesh.cells, 0.0, 0.5)
    assert np.allclose(X, mesh.X + 0.3 * Psi[0] - 1.2 * Psi[1], rtol=0, atol=1e-15)
    assert found[0] == pytest.approx(qualities(X, mesh.cells).min(), rel=1e-12)
    assert found[2] == np.sum(qualities(X, mesh.cells) < 0.5)


def test_the_authors_thresholds_are_his_ratio_and_his_area():
    mesh = l_mesh()
    floor, area = thresholds("author", 0.3, mesh.X, mesh.edge_nodes)
    assert 2 * np.sqrt(3) / floor == pytest.approx(15.0)
    mean_edge = np.mean([np.linalg.norm(mesh.X[a] - mesh.X[b]) for a, b in mesh.edge_nodes])
    assert area == pytest.approx(1e-5 * mean_edge**2)
    assert thresholds("quality", 0.4, mesh.X, mesh.edge_nodes) == (0.4, 0.0)


def test_springs_go_to_the_mean_of_their_neighbours():
    mesh = l_mesh(3)
    fixed = (mesh.node_edge >= 0).astype(np.uint8)
    still = np.zeros((2, *mesh.X.shape))
    X = mesh.X.copy()
    _kernels.relax_and_check(X.copy(), still, 0.0, 0.0, X, mesh.cells, mesh.edge_nodes, fixed, 2, 0.0, 0.3)
    expected = mesh.X.copy()
    for _ in range(2):
        before = expected.copy()
        for i in np.flatnonzero(fixed == 0):
            around = [b if a == i else a for a, b in mesh.edge_nodes if i in (a, b)]
            expected[i] = before[around].mean(axis=0)
    assert np.allclose(X, expected, rtol=0, atol=1e-15)
