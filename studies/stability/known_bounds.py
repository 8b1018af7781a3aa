"""Bounds of hard cases that follow from how numbers are computed: each is stated once, with its reason."""

from __future__ import annotations

from restshape.replay import parity


class Known(float):
    """A bound that a reason gives, whether or not what comes out on one machine is near it.

    Args:
        value: the largest number that holds.
        why: what it follows from.
    """

    why: str

    def __new__(cls, value: float, why: str) -> Known:
        """The bound; a number in all else."""
        made = super().__new__(cls, value)
        made.why = why
        return made


ENTRIES = Known(parity.ENTRIES, "entries of matrices are the same sums in another order")
EXACT = Known(1e-12, "equal but for the order of sums: 4,500 roundings of a double")
DIRECT = Known(1e-10, "solved by a complete factor: rounding times a condition of up to 1e6")
CONDITIONED = Known(1e-8, "solved by a complete factor: rounding times a condition of 1e8, as near a limit load")
LAPACK = Known(1e-7, "a dense solve leaves rounding times the largest over the smallest eigenvalue, up to 1e9")
TONES = Known(1e-6, "the tolerance of modes: frequencies that are apart differ by its square, those that meet by it")
TOLERANCE_WHY = "the tolerance of the scene: where a factor is complete and of the frame, rounding is left"
TOLERANCE = Known(1e-6, TOLERANCE_WHY)
STATIONARY = Known(1e-8, "energies at rest differ by the square of the residual, whose tolerance is 1e-4")
BALANCE = Known(1e-5, "the sum of residuals below 1e-4 that cancel, the more the larger the weight is beside stiffness")
MESHES = Known(5e-3, "another mesh of the same sizes where a place differs in its last digit; else rounding")
CONVERGED = 1e-8
"""Of two solves by Newton's method, whose last step squares what is left, at a tolerance of 1e-6."""
SOLVED = 1e-6
"""Of two solves to the default tolerance."""


def drifted(steps: int) -> Known:
    """What so many time steps may gather, each solved to 1e-12."""
    return Known(1e-12 * steps, "the tolerance of a time step, as many times as there are steps")
