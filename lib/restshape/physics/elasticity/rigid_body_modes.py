"""Whether supports leave a rigid motion of a body in the plane free."""

import numpy as np

from restshape.errors import UserError
from restshape.scene.model import Scene


def check_rigid_body_modes(X: np.ndarray, mask: np.ndarray, scene: Scene) -> None:
    """Refuse supports that leave a rigid motion free.

    Args:
        X: (n, 2) points of the body [m].
        mask: (n, 2) nonzero where a support constrains the axis of a point.
        scene: whose supports they are.

    Raises:
        UserError: the body can move or turn as a whole.
    """
    # Two points that are constrained in both directions are enough.
    both = X[np.flatnonzero(np.logical_and(mask[:, 0], mask[:, 1]))]
    if len(both) > 1 and np.ptp(both, axis=0).max() > 1e-3 * (X.max() - X.min()):
        return
    X = X - X.mean(axis=0)
    size = np.abs(X).max()
    rigid = np.zeros((len(X), 2, 3))
    rigid[:, 0, 0] = rigid[:, 1, 1] = 1.0
    rigid[:, 0, 2], rigid[:, 1, 2] = -X[:, 1] / size, X[:, 0] / size
    constrained = rigid[mask.astype(bool)]
    if len(constrained) == 0 or np.linalg.matrix_rank(constrained, tol=1e-9 * max(1.0, np.sqrt(len(constrained)))) < 3:
        raise UserError(
            "the supports leave the body free to move as a rigid body",
            f"{scene.path}: supports",
            'fix both axes on an edge, e.g. wall = { on = "left", fix = ["x", "y"] }',
        )
