"""The line along which a valid range is shown: the way of what moves most."""

import numpy as np
from restshape_apps.furniture.physics.furniture import Furniture

STEP = 1e-3
"""Change of the parameter [m or rad] by which it is found how things move."""


def way_of(furniture: Furniture, direction: np.ndarray, t: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Of the plank that changes most the side that moves most: its middle (3,) [m], and how far a unit brings it (3,).

    The model is left with its geometry a step away.

    Args:
        furniture: model of the piece; direction: (n, 8) change of its design parameters by a unit.
        t: how far it has been changed.
    """
    before, after = furniture.moved(t * direction), furniture.moved((t + STEP) * direction)
    plank = int(np.argmax(np.abs(direction).max(axis=1)))
    starts, ends = (np.array([piece.planks[plank].end(side) for side in range(6)]) for piece in (before, after))
    speeds = (ends - starts) / STEP
    side = int(np.argmax(np.linalg.norm(speeds, axis=1)))
    return starts[side], speeds[side]
