"""Stresses and energies of triangles in one loop: as by hand, and as the element gives them."""

import numpy as np
import pytest
from sample_meshes import second_order, unit_box

from restshape import _kernels

LAMBDA, MU, THICKNESS = 3.0, 5.0, 0.5
PARAMETERS = np.array([LAMBDA, MU, THICKNESS, 0.0, 0.0])
STRAIN = np.array([[2e-3, 7e-4], [7e-4, -1e-3]])


def strip(rng):
    """Places (12, 2) of two rows of six nodes, and the triangles (10, 3) between them."""
    X = np.array([(i, j) for j in range(2) for i in range(6)]) + rng.uniform(-0.2, 0.2, (12, 2))
    cells = [corners for i in range(5) for corners in ((i, i + 1, i + 7), (i, i + 7, i + 6))]
    return X, np.array(cells, dtype=np.int32)


def test_a_uniform_strain_has_its_stress_and_energy():
    """Sigma = lambda tr(eps) I + 2 mu eps, by hand; the energy is half of sigma : eps on area and thickness."""
    X, cells = strip(np.random.default_rng(1))
    turned = np.array([[0.0, -4e-3], [4e-3, 0.0]])
    x = np.ascontiguousarray(X @ (STRAIN + turned).T)
    sigma = LAMBDA * np.trace(STRAIN) * np.eye(2) + 2.0 * MU * STRAIN
    stress, energy = _kernels.triangle_stress(X, x, cells, PARAMETERS, False)
    expected = [sigma[0, 0], sigma[1, 1], sigma[0, 1], LAMBDA * np.trace(STRAIN)]
    np.testing.assert_allclose(stress, np.tile(expected, (len(cells), 1)), rtol=1e-10)
    work = 0.5 * (sigma * STRAIN).sum() * THICKNESS
    assert energy.sum() == pytest.approx(work * _kernels.total_area(X, cells), rel=1e-10)
    assert not _kernels.triangle_stress(X, x, cells, PARAMETERS, True)[0][:, 3].any()
    np.testing.assert_array_equal(_kernels.triangle_energies(X, x, cells, PARAMETERS), energy)


@pytest.mark.parametrize("each", [False, True])
def test_it_is_what_the_element_gives(each):
    rng = np.random.default_rng(2)
    X, cells = strip(rng)
    x = rng.normal(size=X.shape)
    parameters = PARAMETERS * rng.uniform(0.5, 2.0, (len(cells), 1)) if each else PARAMETERS
    element, expected = _kernels.Element("linear_elastic_tri3"), np.empty((len(cells), 4))
    element.stress(X, x, cells, parameters, expected)
    stress, energy = _kernels.triangle_stress(X, x, cells, parameters, False)
    np.testing.assert_allclose(stress, expected, rtol=0, atol=1e-14 * np.abs(expected).max())
    np.testing.assert_allclose(energy, element.energy(X, x, cells, parameters), rtol=1e-12)


@pytest.mark.parametrize("each", [False, True])
def test_stresses_of_second_order_are_what_the_element_gives(each):
    """On curved sides, of more cells than are taken at once, inside them and at their corners."""
    rng = np.random.default_rng(4)
    X, cells, inner = unit_box(2, 3)
    X, cells, _ = second_order(X, cells, inner, 0.02)
    x = rng.normal(size=X.shape)
    parameters = PARAMETERS * rng.uniform(0.5, 2.0, (len(cells), 1)) if each else PARAMETERS
    points = np.vstack([_kernels.recovery_points(), [[0.0, 0.0], [1.0, 0.0]]])
    element, expected = _kernels.Element("linear_elastic_tri6"), np.empty((len(cells), len(points), 4))
    element.stress(X, x, cells, parameters, expected, points)
    found = _kernels.quadratic_stress(X, x, cells, parameters, points)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-13 * np.abs(expected).max())


def test_what_does_not_fit_is_refused():
    X, cells = strip(np.random.default_rng(3))
    with pytest.raises(ValueError, match=r"cells \(ne, 6\)"):
        _kernels.quadratic_stress(X, np.zeros_like(X), cells, PARAMETERS, _kernels.recovery_points())
    for wrong in (cells + 1, cells - 1):
        with pytest.raises(ValueError, match="do not exist"):
            _kernels.triangle_stress(X, np.zeros_like(X), wrong, PARAMETERS, True)
    with pytest.raises(ValueError, match="params"):
        _kernels.triangle_stress(X, np.zeros_like(X), cells, PARAMETERS[:3].copy(), True)
    with pytest.raises(ValueError, match=r"\(n, 2\)"):
        _kernels.triangle_stress(X, np.zeros(len(X)), cells, PARAMETERS, True)


@pytest.mark.parametrize(
    ("state", "expected"),
    [((7, 0, 0, 0), 7), ((0, -7, 0, 0), 7), ((0, 0, 2, 0), 2 * np.sqrt(3)), ((3, 3, 0, 3), 0), ((0, 0, 0, 5), 5)],
)
def test_equivalent_stress(state, expected):
    """Tension on any axis is itself, shear sqrt(3) times it, pressure on all sides nothing."""
    assert _kernels.von_mises(np.array([state], dtype=float)) == pytest.approx([expected])


def test_the_same_bits():
    a = np.array([[1.0, np.nan], [0.0, 2.0]])
    assert _kernels.same_bits(a, a.copy())
    assert not _kernels.same_bits(a, a.ravel()[:3]) and not _kernels.same_bits(a, np.abs(a) * -1.0)
    assert not _kernels.same_bits(a, a + 1e-16 * np.array([[2.0, 0.0], [0.0, 2.0]]))


def test_the_largest_size():
    assert _kernels.largest_size(np.array([[1.0, -3.0], [2.0, 0.0]])) == 3.0
    assert _kernels.largest_size(np.empty(0)) == 0.0
    assert np.isnan(_kernels.largest_size(np.array([np.nan, 1.0])))
    assert _kernels.largest_size(np.array([-np.inf, 1.0])) == np.inf
    assert _kernels.largest_norm(np.array([[1.0, -2.0, 2.0], [2.0, 0.0, 0.0]])) == 3.0
    assert _kernels.largest_norm(np.empty((0, 2))) == 0.0
    assert np.isnan(_kernels.largest_norm(np.array([[np.nan, 1.0], [3.0, 4.0]])))
