"""Participation and combinations of modes, against closed forms of a chain of masses and of published coefficients."""

import numpy as np
import pytest
import scipy.sparse as sp

from restshape.analysis.modal.base_modes import base_modes, correlation, cqc, srss
from restshape.fem.time_integration import Rayleigh


def shear_building(storeys=6, k=4e6, m=2e3):
    """Stiffness and mass of equal storeys, the lowest on the ground."""
    stiffness = k * (2 * np.eye(storeys) - np.eye(storeys, k=1) - np.eye(storeys, k=-1))
    stiffness[-1, -1] = k
    return sp.csr_matrix(stiffness), sp.csr_matrix(m * np.eye(storeys))


def test_a_shear_building_has_the_closed_form():
    """w_j = 2 sqrt(k/m) sin(theta_j/2), theta_j = (2 j - 1) pi / (2 n + 1), modes sin(i theta_j)."""
    n, k, m = 6, 4e6, 2e3
    found = base_modes(*shear_building(n, k, m), m * np.ones(n), n * m, n - 1)
    theta = (2 * np.arange(1, n) - 1) * np.pi / (2 * n + 1)
    np.testing.assert_allclose(found.omega, 2 * np.sqrt(k / m) * np.sin(theta / 2), rtol=1e-10)
    modes = np.sin(np.outer(np.arange(1, n + 1), theta))
    shares = modes.sum(axis=0) ** 2 / (modes**2).sum(axis=0) / n
    np.testing.assert_allclose(found.effective_mass, shares, rtol=1e-9)
    np.testing.assert_allclose(found.frequencies, found.omega / 2 / np.pi)
    assert np.all(found.participation > 0)


def test_damping_is_that_of_rayleigh():
    found = base_modes(*shear_building(), 2e3 * np.ones(6), 12e3, 3)
    np.testing.assert_allclose(found.damping(Rayleigh(0.8, 2e-3)), 0.4 / found.omega + 1e-3 * found.omega)


def test_far_modes_add_as_squares_and_equal_ones_as_numbers():
    peaks, ratio = np.array([[3.0, 1.0], [4.0, -1.0]]), np.array([0.05, 0.05])
    np.testing.assert_allclose(srss(peaks), [5.0, np.sqrt(2)])
    np.testing.assert_allclose(cqc(peaks, np.array([1.0, 1e4]), ratio), srss(peaks), rtol=1e-6)
    np.testing.assert_allclose(cqc(peaks, np.array([2.0, 2.0]), ratio), [7.0, 0.0], atol=1e-7)


def test_coefficients_are_those_of_white_noise():
    """rho = E[u_i u_j] / sqrt(E[u_i^2] E[u_j^2]) of stationary motions, by Lyapunov's equation for both oscillators."""
    from scipy.linalg import solve_continuous_lyapunov

    omega, ratio = np.array([5.0, 6.0]), np.array([0.05, 0.12])
    rates, load = np.zeros((4, 4)), np.zeros((4, 1))
    for k in (0, 1):
        rates[2 * k, 2 * k + 1] = 1.0
        rates[2 * k + 1, 2 * k : 2 * k + 2] = -(omega[k] ** 2), -2 * ratio[k] * omega[k]
        load[2 * k + 1] = -1.0
    covariance = solve_continuous_lyapunov(rates, -load @ load.T)
    expected = covariance[0, 2] / np.sqrt(covariance[0, 0] * covariance[2, 2])
    found = correlation(omega, ratio)
    assert found[0, 1] == pytest.approx(expected, rel=1e-10)
    np.testing.assert_allclose(found, found.T)
    np.testing.assert_allclose(np.diag(found), 1.0)


def test_modes_without_damping_are_apart_unless_they_are_one():
    np.testing.assert_array_equal(correlation(np.array([1.0, 1.1]), np.zeros(2)), np.eye(2))
