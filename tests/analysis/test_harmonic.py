"""The steady response to a load that swings, against the closed form of one mass on a spring with a dashpot."""

import numpy as np
import pytest
import scipy.sparse as sp

from restshape.analysis.motion.harmonic import harmonic_response

K, M, C = 90.0, 0.4, 1.5
"""Stiffness [N/m], mass [kg] and damping [N s/m]."""


@pytest.mark.parametrize("ratio", [0.2, 1.0, 3.0])
def test_amplitude_and_phase_are_those_of_one_mass(ratio):
    """F/K / sqrt((1 - r^2)^2 + (2 z r)^2), behind the load by atan2(2 z r, 1 - r^2), z = C / (2 sqrt(K M))."""
    natural = np.sqrt(K / M)
    damping_ratio = C / (2 * np.sqrt(K * M))
    matrices = (sp.csc_matrix([[value]]) for value in (K, M, C))
    (found,) = harmonic_response(*matrices, ratio * natural, np.array([2.0]))
    swing = 2 * damping_ratio * ratio
    assert abs(found) == pytest.approx(2.0 / K / np.hypot(1 - ratio**2, swing), rel=1e-12)
    assert -np.angle(found) == pytest.approx(np.arctan2(swing, 1 - ratio**2), rel=1e-12)


def test_two_masses_swing_as_their_modes_do():
    """The response is the sum over modes of phi (phi . F) / (w_i^2 - w^2 + i w c_i), with damping alpha M + beta K."""
    stiffness, mass, load = np.array([[5.0, -2.0], [-2.0, 2.0]]), np.eye(2), np.array([0.3, 1.0 + 0.5j])
    damping = 0.1 * mass + 0.05 * stiffness
    values, modes = np.linalg.eigh(stiffness)
    omega = 1.3
    expected = modes @ ((modes.T @ load) / (values - omega**2 + 1j * omega * (0.1 + 0.05 * values)))
    found = harmonic_response(*map(sp.csc_matrix, (stiffness, mass, damping)), omega, load)
    np.testing.assert_allclose(found, expected, rtol=1e-12)
