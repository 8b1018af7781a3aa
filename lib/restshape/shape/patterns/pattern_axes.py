"""Patterns in axes of space in which another one goes up."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from restshape.arrays import Reals
from restshape.shape.patterns.pattern import Pattern, Triple
from restshape.shape.placement import rotation

QUARTER = 0.5 * np.pi
LOCKED = 1e-9
"""Cosine of the angle about y below which that is a right one."""
UPRIGHT: Triple = (QUARTER, 0.0, 0.0)
"""Turns what goes up along y so that it goes up along z."""


def turned_up(pattern: Pattern, up: str) -> Pattern:
    """The same pattern in axes of which another one, "y" or "z", goes up."""
    if pattern.up == up:
        return pattern
    turn = rotation(UPRIGHT if up == "z" else (-QUARTER, 0.0, 0.0))
    pieces = tuple(
        replace(piece, move=_triple(turn @ piece.move), turn=angles_of(turn @ rotation(piece.turn)))
        for piece in pattern.pieces
    )
    return replace(pattern, pieces=pieces, up=up)


def angles_of(turn: Reals) -> Triple:
    """The angles [rad] about x, then y, then z of a rotation (3, 3)."""
    across = float(np.hypot(turn[0, 0], turn[1, 0]))
    y = float(np.arctan2(-turn[2, 0], across))
    if across < LOCKED:
        # Turned by a right angle about y, the axes of the other two are one.
        return float(np.arctan2(-turn[1, 2], turn[1, 1])), y, 0.0
    return float(np.arctan2(turn[2, 1], turn[2, 2])), y, float(np.arctan2(turn[1, 0], turn[0, 0]))


def _triple(values: Reals) -> Triple:
    x, y, z = (float(value) for value in values)
    return x, y, z
