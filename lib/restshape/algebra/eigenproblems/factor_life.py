"""How long the factor of a pencil serves: until the substitutions that its age has cost would have paid for another."""

import logging

from restshape.algebra.eigenproblems.pencil import Pencil
from restshape.calibration import Calibration

log = logging.getLogger("restshape.algebra")


class FactorLife:
    """The refactorisation criterion of an eigensolver that lives on old factors.

    Args:
        pencil: whose factor it is.
        calibration: seconds a unit of counted work.
        kept: false gives each matrix a factor of its own.

    Attributes:
        age: frames since the factor was made.
        extra_iterations: substitutions since then beyond those that a new factor would have needed.
    """

    def __init__(self, pencil: Pencil, calibration: Calibration, kept: bool = True) -> None:
        self.pencil, self.calibration, self.kept = pencil, calibration, kept
        self.age, self.extra_iterations = 0, 0.0

    def begin(self, why: str) -> None:
        """Note that the factor is new; `why` is for the log."""
        self.age, self.extra_iterations = 0, 0.0
        log.info("ST factor rebuilt at shift %.3e: %s", self.pencil.shift, why)

    def stale(self, new_system: bool, price: float) -> str:
        """Why the factor no longer serves, for the log; empty where it does.

        Args:
            new_system: the unknowns are others than in the last solve.
            price: see `price`.
        """
        if new_system or not self.pencil.ready:
            return "another system"
        if not self.kept:
            return "another matrix"
        if self.extra_iterations < price:
            return ""
        extra = f"{self.extra_iterations:g} extra substitutions"
        return f"refactorisation criterion: {extra}, a factor is worth {price:.3g}"

    def spend(self, iterations: int, count: int) -> None:
        """Note a solve for `count` modes: with a new factor it would have taken one iteration."""
        self.extra_iterations += max(0, iterations - 1) * count

    def price(self) -> float:
        """Substitutions, each with its products, that cost as much as a new factor; 0 where none is kept."""
        if not self.kept:
            return 0.0
        known, pencil = self.calibration, self.pencil
        work = (pencil.size, pencil.entries, pencil.nonzeros or 3.0 * pencil.entries)
        return max(1.0, known.refresh_seconds(*work) / known.iteration_seconds(*work))
