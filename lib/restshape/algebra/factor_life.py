"""How long the factor of a pencil serves: until the substitutions that its age has cost would have paid for another."""

from restshape.algebra.pencil import Pencil
from restshape.calibration import Calibration


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

    def begin(self) -> None:
        """Note that the factor is new."""
        self.age, self.extra_iterations = 0, 0.0

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
