"""The place along a nodal line at which other modes move least, by fields that are smooth there."""

from __future__ import annotations

import numpy as np

from restshape.analysis.modal.quadratic_patch import QuadraticPatch

STEPS = 20
"""Of Newton's method at most."""
STEADY = 1e-9
"""Share of a patch's reach below which a step ends it."""


def line_minimum(patch: QuadraticPatch, line: int, weights: np.ndarray) -> np.ndarray | None:
    """The place (2,) near a patch's own where a field is 0 and the weighted squares of all are least along that line.

    Newton's method on the condition that the energy's gradient is a multiple of the line's, with the line's curvature.

    Args:
        patch: of fields (k,).
        line: index of the field whose line it is.
        weights: (k,) of their squares.

    Returns:
        None: there is no such place within half of the patch's reach.
    """
    place = patch.place.copy()
    for _ in range(STEPS):
        value, gradient, second = patch.values(place)
        slope, size = gradient[:, line], float(gradient[:, line] @ gradient[:, line])
        if size == 0.0:
            return None
        along = np.array([-slope[1], slope[0]]) / np.sqrt(size)
        pull = gradient @ (weights * value)
        bend = np.einsum("ik,jk,k->ij", gradient, gradient, weights) + second @ (weights * value)
        # Per unit of the line's field, by which the energy changes across the line.
        multiplier = float(pull @ slope) / size
        curvature = float(along @ (bend - multiplier * second[:, :, line]) @ along)
        if curvature <= 0.0:
            return None
        step = -float(along @ pull) / curvature * along - value[line] / size * slope
        place = place + step
        if np.hypot(*(place - patch.place)) > 0.5 * patch.reach:
            return None
        if np.hypot(*step) <= STEADY * patch.reach:
            return place
    return None
