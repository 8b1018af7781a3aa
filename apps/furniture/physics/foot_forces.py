"""The force of each foot, where its pressure has its middle."""

import numpy as np
from restshape_apps.furniture.physics.furniture import Forces, Geometry

LEAST = 1e-3
"""Of the largest force of a foot, below which one counts as none."""


def foot_forces(geometry: Geometry, forces: Forces) -> tuple[np.ndarray, np.ndarray]:
    """Places (k, 3) [m] and forces (k, 3) [N] on the planks, of the feet that push.

    Args:
        geometry: of the piece; forces: of one case.
    """
    points, pushed = geometry.contacts.reshape(-1, 4, 3), forces.contacts.reshape(-1, 4, 3)
    whole = pushed.sum(axis=1)
    sizes = np.sqrt((whole**2).sum(axis=1))
    pushing = (sizes > 0.0) & (sizes >= LEAST * sizes.max(initial=0.0))
    weights = np.maximum(np.sqrt((pushed[pushing] ** 2).sum(axis=2)), 1e-300)
    places = (weights[:, :, None] * points[pushing]).sum(axis=1) / weights.sum(axis=1)[:, None]
    return places, whole[pushing]
