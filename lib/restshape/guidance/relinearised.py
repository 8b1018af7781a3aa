"""A combination of design modes that is followed where forces bend away from their first derivative."""

import numpy as np

from restshape.guidance.force_space import LONGEST, durability_space, stability_space
from restshape.physics.furniture import LOST, OVERLAPPING, UNSTABLE, Furniture
from restshape.shape.design_modes import DesignModes

STEPS = 3
AIM = 0.6
"""How far inside the box of durability a step aims, in parts of it; the middle would be far more than is asked for."""

SPARE = 0.02
"""What a step leaves to the rows of stability."""


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
    y = start
    for _ in range(STEPS):
        gamma = modes.direction(numbers, y)
        moved = Furniture(furniture.moved(gamma), furniture.compliance)
        flaws = moved.test().flaws
        if flaws & (LOST | OVERLAPPING):
            return None
        if not flaws & wanted:
            return y
        few = DesignModes(moved.piece, modes.freedoms[numbers], modes.unit)
        if flaws & UNSTABLE:
            space = stability_space(moved, few)
            outside = np.minimum(space.h - SPARE, 0.0)
        else:
            space = durability_space(moved, few)
            outside = space.h - np.clip(space.h, -AIM, AIM)
        y = y - np.linalg.lstsq(space.K.T, outside, rcond=1e-6)[0]
        if not np.linalg.norm(y) <= LONGEST:
            return None
    return y if furniture.test(modes.direction(numbers, y), wanted, True).flaws & wanted == 0 else None
