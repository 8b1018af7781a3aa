"""Counts of what a linear solver has done."""

from dataclasses import dataclass


@dataclass
class SolveCounts:
    """Counts of linear solves.

    Args:
        matrices: that were solved with, each of them assembled.
        iterations: of the Krylov method; factors: preconditioners that were made.
    """

    matrices: int = 0
    iterations: int = 0
    factors: int = 0
