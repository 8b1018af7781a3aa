"""Rotations in space, and where the flat pattern lies before any load."""

from __future__ import annotations

import numpy as np

from restshape.arrays import Reals
from restshape.scene.bodies import Start
from restshape.scene.space_values import Angles


def rotation(angles: Angles) -> Reals:
    """The matrix (3, 3) that turns about x, then y, then z by angles of numbers alone [rad]."""
    R = np.eye(3)
    for axis, angle in enumerate(np.array(angles, dtype=float)):
        c, s = np.cos(angle), np.sin(angle)
        turn = np.eye(3)
        i, j = (axis + 1) % 3, (axis + 2) % 3
        turn[i, i], turn[i, j], turn[j, i], turn[j, j] = c, -s, s, c
        R = turn @ R
    return R


def rotation_rates(angles: Angles, rates: Reals) -> Reals:
    """The rate (3, 3) of `rotation` when its angles [rad] have rates (3,)."""
    numbers = np.diag(np.array(angles, dtype=float))
    turns = [rotation((row[0], row[1], row[2])) for row in numbers.tolist()]
    found = np.zeros((3, 3))
    for axis, rate in enumerate(rates):
        # About one axis the rate of a turn is the cross product with it.
        spin = np.cross(np.eye(3)[axis], np.eye(3)).T
        changed = [spin @ turn if k == axis else turn for k, turn in enumerate(turns)]
        found += rate * (changed[2] @ changed[1] @ changed[0])
    return found


def placed(start: Start, X: Reals) -> Reals:
    """Places (n, 3) [m] of the flat pattern's points X (n, 2), or others (n, 3) [m], under a start of numbers alone."""
    flat, about = X if X.shape[1] == 3 else np.column_stack([X, np.zeros(len(X))]), np.array(start.about)
    return (flat - about) @ rotation(start.turn).T + about + start.move
