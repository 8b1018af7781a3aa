"""Which supports leave a body in the plane free to move."""

import itertools

import numpy as np
import pytest

from restshape.errors import UserError
from restshape.physics.elasticity.rigid_body_modes import check_rigid_body_modes
from restshape.scene.model import Scene

SQUARE = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], dtype=float)


@pytest.mark.parametrize("chosen", list(itertools.product([0, 1], repeat=4)))
@pytest.mark.parametrize("kind", [np.uint8, float])
@pytest.mark.parametrize("axes", [(1, 1), (1, 0), (0, 1)])
def test_a_body_is_refused_where_translations_or_the_rotation_stay_free(chosen, axes, kind):
    """Against the rank of the three motions at the constrained unknowns, wherever the body is."""
    mask = np.outer(chosen, axes).astype(kind)
    x, y = SQUARE.T
    motions = np.stack([np.stack([x**0, 0 * x, -y]), np.stack([0 * x, x**0, x])], axis=1).transpose(2, 1, 0)
    free = not any(chosen) or np.linalg.matrix_rank(motions[mask.astype(bool)].reshape(-1, 3)) < 3
    for shift in (0.0, 1e4):
        X = SQUARE + np.array([shift, 0.0])
        if free:
            with pytest.raises(UserError, match="free to move"):
                check_rigid_body_modes(X, mask, Scene.model_construct(path="a.toml"))
        else:
            check_rigid_body_modes(X, mask, Scene.model_construct(path="a.toml"))
