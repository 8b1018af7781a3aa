"""Strains and tensions of cloth that recordings hold on request."""

import numpy as np

from restshape.physics.cloth.cloth_fields import membrane_strains


def test_strains_are_those_of_a_linear_map_into_space():
    """Of x = F X all strains are (F^T F - I) / 2; a rotation in space has none."""
    X = np.array([[0, 0], [1, 0.2], [0.3, 0.9], [1.4, 1.1]])
    corners = np.array([[0, 1, 2], [1, 3, 2]], dtype=np.int32)
    F = np.array([[1.1, 0.2], [-0.1, 0.9], [0.3, 0.5]])
    green = 0.5 * (F.T @ F - np.eye(2))
    expected = [green[0, 0], green[1, 1], green[0, 1]]
    np.testing.assert_allclose(membrane_strains(X, X @ F.T + 3.0, corners), [expected] * 2, atol=1e-14)
    turned = np.linalg.qr(np.array([[1.0, 2, 3], [0, 1, 4], [5, 6, 0]]))[0][:, :2]
    np.testing.assert_allclose(membrane_strains(X, X @ turned.T, corners), 0.0, atol=1e-15)
