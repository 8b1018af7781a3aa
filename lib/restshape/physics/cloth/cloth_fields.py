"""What recordings of cloth hold besides where a scene asks for it: tensions and strains of the triangles."""

from collections.abc import Collection

import numpy as np

from restshape.physics.cloth.cloth_problem import ClothProblem

COMPONENTS = ("xx", "yy", "xy")


def membrane_strains(X: np.ndarray, x: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Green's strains (ne, 3) xx, yy, xy of triangles.

    Args:
        X: (n, 2) places in the flat pattern [m].
        x: (n, 3) positions [m].
        corners: (ne, 3) nodes.
    """
    flat, now = (values[corners[:, 1:]] - values[corners[:, :1]] for values in (X, x))
    # Rows are edges: now = flat F^T.
    gradient = np.linalg.solve(flat, now)
    green = 0.5 * (gradient @ np.swapaxes(gradient, 1, 2) - np.eye(2))
    return np.stack([green[:, 0, 0], green[:, 1, 1], green[:, 0, 1]], axis=1)


def requested_fields(problem: ClothProblem, x: np.ndarray, wanted: Collection[str]) -> dict[str, np.ndarray]:
    """Fields (ne,) of the triangles at positions x (n, 3) [m]; `wanted` names them as `recording.fields` does."""
    tensions, found = problem.tensions(x), {}
    xx, yy, xy = tensions.T
    if "stress" in wanted:
        found |= {f"tension_{name}": tensions[:, k] for k, name in enumerate(COMPONENTS)}
    if "principal" in wanted:
        found["min_tension"] = 0.5 * (xx + yy) - np.hypot(0.5 * (xx - yy), xy)
        found["tension_angle"] = 0.5 * np.arctan2(2.0 * xy, xx - yy)
    if "strain" in wanted:
        strains = membrane_strains(problem.X, x, problem.membrane.corners)
        found |= {f"strain_{name}": strains[:, k] for k, name in enumerate(COMPONENTS)}
    return found
