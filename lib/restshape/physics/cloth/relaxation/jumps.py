"""Whether a frame's rest is another branch than that of the last one: what was expected of it, and what came."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from restshape.physics.cloth.cloth_problem import ClothProblem

OUT = 3.0
"""Way of the cloth, over those of the hand and of the derivative of the last rest, beyond which it has jumped."""
STILL = 1e-3
"""Way, over the size of the cloth, below which it has not."""


@dataclass(frozen=True, eq=False)
class Expected:
    """What the last rest, and its derivative, lead to expect of a frame.

    Args:
        x: (n, 3) unknowns at the last rest, in the material of the frame [m].
        hand: the farthest way of supports, bodies and material in the edit [m].
        way: the farthest one of the cloth along the derivative [m]; 0 where there is none.
        energy: of the cloth there [J], by the first two derivatives along its way, or the first one alone.
        work: the same by the first one alone [J], where that is known: the other one is none of a long way.
        derive: where there is no derivative yet, what makes it after the frame: none where there cannot be one.
        dropped: the cloth does not come from the last rest at all, but was dropped again.
    """

    x: np.ndarray
    hand: float
    way: float
    energy: float
    work: float
    derive: Callable[[np.ndarray], Expected | None] | None = None
    dropped: bool = False


def jump_note(problem: ClothProblem, expected: Expected, x: np.ndarray, lost: bool) -> list[str]:
    """What there is to say of a rest x (n, 3) that is out of proportion to the edit, as cloth that buckles or slips is.

    Cloth that was dropped again is said to have jumped wherever it is not where it was.

    Args:
        problem: of the frame, at rest.
        expected: of the frame.
        lost: the tangent was not positive definite on the way; the derivative shows no proportion then.
    """
    way = farthest(problem, x - expected.x)
    if not _out_of_proportion(problem, expected, way, lost):
        return []
    if expected.derive and (found := expected.derive(x)):
        expected = replace(found, x=expected.x)
        if not _out_of_proportion(problem, expected, way, lost):
            return []
    fell = expected.energy - problem.energy(x)
    energy = f"energy {'fell' if fell > 0.0 else 'rose'} by {1e3 * abs(fell):.3g} mJ"
    return [f"cloth jumped {1e3 * way:.0f} mm where the hand went {1e3 * expected.hand:.3g} mm; {energy}"]


def _out_of_proportion(problem: ClothProblem, expected: Expected, way: float, lost: bool) -> bool:
    """Whether cloth has gone farther [m] than an edit leads to expect."""
    if expected.dropped:
        return way > STILL * problem.size
    usual = expected.hand if lost else max(expected.hand, expected.way)
    return expected.hand > 0.0 and way > max(OUT * usual, STILL * problem.size)


def farthest(problem: ClothProblem, d: np.ndarray) -> float:
    """The longest way [m] of a node of the mesh in a step d (n, 3) [m]."""
    return float(np.linalg.norm(problem.corners(d), axis=1).max())
