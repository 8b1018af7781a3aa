"""A combination of design modes that is followed where forces bend away from their first derivative."""

import numpy as np
from restshape_apps.furniture.guidance.force_space import durability_space, stability_space
from restshape_apps.furniture.physics.furniture import LOST, OVERLAPPING, UNSTABLE, Furniture
from restshape_apps.furniture.shape.design_modes import DesignModes

from restshape.guidance.force_space import LONGEST

STEPS = 3
AIM = 0.6
"""How far inside the box of durability a step aims, in parts of it; the middle would be far more than is asked for."""

SPARE = 0.02
"""What a step leaves to the rows of stability."""

SLOWEST = 0.8
"""What lies outside must fall to this part of it in each step."""


def relinearised(
    furniture: Furniture, modes: DesignModes, numbers: np.ndarray, start: np.ndarray, wanted: int
) -> np.ndarray | None:
    """A valid change (k,) of the modes `numbers`, or None: least squares steps, each from where the last one led.

    Args:
        furniture: the model of the piece as it is.
        modes: of the piece.
        numbers: (k,) of the modes that are combined.
        start: (k,) change from which the first step is taken, such as where a ray enters the box.
        wanted: flaws that count.

    Source: (6.19) and (6.21) of the thesis, each repeated as by Gauss and Newton.
    """
    y, before = start, np.inf
    stands = not furniture.test(None, UNSTABLE).flaws & UNSTABLE
    for step in range(STEPS + 1):
        gamma = modes.direction(numbers, y)
        flaws = furniture.test(gamma, wanted).flaws
        if not flaws & wanted:
            return y
        if flaws & (LOST | OVERLAPPING) or step == STEPS:
            return None
        stands = stands and not flaws & UNSTABLE
        moved = Furniture(furniture.moved(gamma), furniture.compliance)
        moved.test()
        few = modes.some(numbers).after(gamma, moved.piece)
        K, outside = _outside(moved, few, stands)
        size = float(np.linalg.norm(outside))
        # A piece that an edit has blown up has derivatives that are no numbers.
        if not (size <= SLOWEST * before and np.isfinite(K).all()):
            return None
        y, before = y - np.linalg.lstsq(K.T, outside, rcond=1e-6)[0], size
        if not np.linalg.norm(y) <= LONGEST:
            return None
    return None


def _outside(moved: Furniture, few: DesignModes, stands: bool) -> tuple[np.ndarray, np.ndarray]:
    """The change (k, r) of forces by a few modes, and what of them (r,) a step is to take away.

    What makes a piece stable may overload a joint, and the reverse: where one fell, both count at once.
    """
    durability = durability_space(moved, few)
    outside = durability.h - np.clip(durability.h, -AIM, AIM)
    if stands:
        return durability.K, outside
    stability = stability_space(moved, few)
    spare = np.minimum(stability.h - SPARE, 0.0)
    return np.concatenate([stability.K, durability.K], axis=1), np.concatenate([spare, outside])
