"""The displacements that the loads of the manufactured scenes are made for."""

from pathlib import Path

import numpy as np

SCENES = Path(__file__).parent / "scenes"


def displacement(X: np.ndarray) -> np.ndarray:
    """The manufactured displacements (n, 2) [m] at places X (n, 2) [m]."""
    x, y = X.T
    return 1e-3 * np.column_stack([np.sin(np.pi * x) * np.sin(np.pi * y), x * y * (1 - x) * (1 - y)])


def gradient(X: np.ndarray) -> np.ndarray:
    """Their gradients (n, 2, 2), [i, j] = d u_i / d X_j."""
    x, y = X.T
    sx, cx, sy, cy = np.sin(np.pi * x), np.cos(np.pi * x), np.sin(np.pi * y), np.cos(np.pi * y)
    rows = [[np.pi * cx * sy, np.pi * sx * cy], [(1 - 2 * x) * y * (1 - y), x * (1 - x) * (1 - 2 * y)]]
    return 1e-3 * np.array(rows).transpose(2, 0, 1)
