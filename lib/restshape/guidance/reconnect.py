"""Suggestions that bring a lost joint back (figure 6.7a of the thesis)."""

from dataclasses import dataclass

import numpy as np

from restshape.guidance.ranges import bisected
from restshape.physics.furniture import LOST, Furniture
from restshape.shape.design_modes import DesignModes

LONGEST = 0.5
SAMPLES = 41
INSIDE = 0.1
"""Where in its range a suggestion is shown."""

FULL = 31


@dataclass(frozen=True)
class Reconnection:
    """One mode that closes all joints again.

    Args:
        mode: what it does, in words.
        direction: (n, 8) change of the design parameters by a unit of t.
        t: where it is shown.
        span: range of t where all joints are closed.
        flaws: what the full test still finds there, besides.
    """

    mode: str
    direction: np.ndarray
    t: float
    span: tuple[float, float]
    flaws: int


def reconnections(furniture: Furniture, shown: int = 8) -> tuple[Reconnection, ...]:
    """Ways to bring lost joints back by a move, turn or length of one of their planks, the shortest first.

    A way may leave other flaws, which its `flaws` tell; those with none come before the others.
    """
    geometry, piece = furniture.geometry(), furniture.piece
    lost = [k for k, fault in enumerate(geometry.joint_faults) if fault]
    planks = sorted({plank for k in lost for plank in (piece.joints[k].i, piece.joints[k].j)})
    modes = DesignModes.of(piece, [(plank, freedom) for plank in planks for freedom in range(8)])
    found = []
    for number in range(len(modes)):
        direction = modes.direction(np.array([number]), np.array([1.0]))
        for way in (direction, -direction):
            if one := _along(furniture, way, modes.names(np.array([number]))[0]):
                found.append(one)
    furniture.test()
    return tuple(sorted(found, key=lambda one: (one.flaws != 0, one.t))[:shown])


def _along(furniture: Furniture, direction: np.ndarray, mode: str) -> Reconnection | None:
    t = np.linspace(0.0, LONGEST, SAMPLES)
    good = furniture.kernel.scan(direction, t, LOST)[0] == 0
    if good[0] or not good.any():
        return None
    first = int(np.argmax(good))
    last = first + int(np.argmin(np.append(good[first:], False))) - 1
    left = bisected(furniture, direction, t[[first - 1]], t[[first]], np.array([False]), 1e-6, LOST)[0][0]
    right = t[last]
    if last + 1 < SAMPLES:
        right = bisected(furniture, direction, t[[last]], t[[last + 1]], np.array([True]), 1e-6, LOST)[0][0]
    shown = float(left + INSIDE * (right - left))
    flaws = furniture.test(shown * direction, FULL).flaws
    return Reconnection(mode, direction, shown, (float(left), float(right)), flaws)
