"""Strains of plane solids, from the displacement of the cells."""

import numpy as np

from restshape.mesh.quadratic_basis import quadratic_basis

CENTROID = np.full((1, 2), 1.0 / 3.0)
CORNERS = np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]])
"""Slopes of the basis of first-order triangles in reference coordinates."""


def displacement_gradients(X: np.ndarray, x: np.ndarray, cells: np.ndarray, points: np.ndarray | None) -> np.ndarray:
    """du_i/dX_j (ne, m, 2, 2) of the cells at reference points.

    Args:
        X: (n, 2) rest positions [m].
        x: (n, 2) displacements [m].
        cells: (ne, 3 or 6) nodes.
        points: (m, 2) reference coordinates; None: the centroid, m = 1.
    """
    at = CENTROID if points is None else points
    slopes = np.broadcast_to(CORNERS, (len(at), 3, 2)) if cells.shape[1] == 3 else quadratic_basis(at)[1]
    jacobian = np.einsum("eki,qkj->eqij", X[cells], slopes)
    return np.einsum("eki,qkj->eqij", x[cells], slopes) @ np.linalg.inv(jacobian)


def plane_strains(
    X: np.ndarray, x: np.ndarray, cells: np.ndarray, points: np.ndarray | None, large: bool, ratio: np.ndarray | None
) -> np.ndarray:
    """Strains [1] of the cells: xx, yy, xy, zz; small ones, or Green's; xy is the component of the tensor.

    Args:
        X, x, cells, points: as of `displacement_gradients`.
        large: Green's strain.
        ratio: nu / (1 - nu) of plane stress, one or (ne,), which thins the body; None: plane strain.

    Returns:
        (ne, m, 4), or (ne, 4) at centroids.
    """
    H = displacement_gradients(X, x, cells, points)
    strain = 0.5 * (H + np.swapaxes(H, -1, -2))
    if large:
        strain += 0.5 * np.swapaxes(H, -1, -2) @ H
    out = np.zeros((*strain.shape[:2], 4))
    out[..., 0], out[..., 1], out[..., 2] = strain[..., 0, 0], strain[..., 1, 1], strain[..., 0, 1]
    if ratio is not None:
        out[..., 3] = -np.reshape(ratio, (-1, 1)) * (out[..., 0] + out[..., 1])
    return out[:, 0] if points is None else out
