"""Fairing of a curve: its control points give up short waves and keep long ones."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from restshape.arrays import Reals
from restshape.errors import UserError
from restshape.shape.chain import Chain, chain_of, control_of
from restshape.shape.hand.gesture import Gesture, extend_to_controls
from restshape.shape.outline import Outline

ZIGZAG = 16.0
"""What the fourth difference makes of a zigzag 1, -1, 1, ..."""


def smooth(
    outline: Outline, on: str, strength: float, pins: Sequence[str | tuple[float, float]] | None = None
) -> Gesture:
    """The gesture that fairs a curve at c = (1, 0): control points minimise its bending and their own way together.

    Straight curves stay as they are. The ends of an open curve stay, and what is pinned.

    Args:
        outline: the shape.
        on: an edge, hole, or group of edges that join.
        strength: share of a zigzag of evenly spaced control points that goes away, between 0 and 1; longer waves keep
            more, as the fourth power of their length.
        pins: vertices by name, or places [m] of which the nearest control point stays.

    Raises:
        UserError: not a curve, a pin that is not on it, or no control point that may move.
    """
    chain = chain_of(outline, on)
    fixed = np.zeros(len(chain.controls), dtype=bool)
    fixed[[control_of(outline, chain, pin) for pin in pins or ()]] = True
    if not chain.closed:
        fixed[[0, -1]] = True
    if fixed.all():
        raise UserError(f"{on} has no control point between its ends that could be smoothed")
    own = outline.points[chain.controls]
    weight = strength / (ZIGZAG * (1.0 - strength))
    matrix = np.eye(len(own)) + weight * bending(chain)
    # The unknown is how far points go, so that pinned ones drop out.
    free = ~fixed
    step = np.zeros_like(own)
    step[free] = np.linalg.solve(matrix[np.ix_(free, free)], -weight * (bending(chain) @ own)[free])
    displacement = np.zeros_like(outline.points)
    displacement[chain.controls] = step
    chosen = np.zeros(len(outline.points), dtype=bool)
    chosen[chain.controls] = True
    moved = extend_to_controls(outline, chosen, displacement)
    none = np.zeros(len(outline.points), dtype=bool)
    return Gesture("smooth", np.stack([moved, np.zeros_like(moved)]), True, outline.points, none)


def bending(chain: Chain) -> Reals:
    """Matrix (n, n) of the squared second differences along a chain, in units of the mean distance of its points."""
    n = len(chain.controls)
    steps = np.diff(np.append(chain.places, chain.length) if chain.closed else chain.places)
    steps = steps / steps.mean()
    inner = range(n) if chain.closed else range(1, n - 1)
    rows = np.zeros((len(inner), n))
    for row, j in zip(rows, inner, strict=True):
        before, after = steps[j - 1], steps[j % len(steps)]
        scale = np.sqrt(2.0 / (before + after))
        # Two neighbours may be one point of a very small closed curve.
        np.add.at(
            row, [(j - 1) % n, j, (j + 1) % n], scale * np.array([1 / before, -1 / before - 1 / after, 1 / after])
        )
    return rows.T @ rows
