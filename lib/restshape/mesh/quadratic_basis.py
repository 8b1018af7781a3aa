"""The basis of second-order triangles."""

import numpy as np


def quadratic_basis(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Values (m, 6) and slopes (m, 6, 2) of the basis of a second-order triangle at reference coordinates (m, 2)."""
    x, y = points.T
    l, d = np.stack([1.0 - x - y, x, y], axis=1), np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]])
    after = [1, 2, 0]
    values = np.concatenate([l * (2.0 * l - 1.0), 4.0 * l * l[:, after]], axis=1)
    corners = (4.0 * l - 1.0)[..., None] * d
    sides = 4.0 * (l[..., None] * d[after] + l[:, after, None] * d)
    return values, np.concatenate([corners, sides], axis=1)
