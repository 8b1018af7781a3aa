"""What predicts frames on a coarse mesh, and shows them on a fine one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from restshape.analysis.analysis import Predictor

if TYPE_CHECKING:
    from restshape.arrays import Reals
    from restshape.scene.model import Scene


class RefiningPredictor(Predictor, Protocol):
    """A predictor whose values are those of a coarse mesh, solved beside the fine one that is shown and recorded.

    Attributes:
        correction: what the fine mesh has besides the coarse one, as it is to be shown.
        waits: nothing is shown before `show`, for more is to come.
        lean: of what is shown positions alone are made before more is asked for.
    """

    correction: Reals
    waits: bool
    lean: bool

    @property
    def settled(self) -> bool:
        """Whether the coarse mesh has a solution as it lies."""

    @property
    def sparse(self) -> bool:
        """Whether positions alone have been made of what is shown."""

    def begin(self) -> None:
        """Solve the coarse mesh from where the fine one has a solution.

        Raises:
            ReplayProblem: it has none.
        """

    def settle(self, scene: Scene) -> None:
        """Solve the coarse mesh as it lies, and show that.

        Raises:
            ReplayProblem: it has no solution.
        """

    def show(self) -> None:
        """Let the analysis of the fine mesh hold what the coarse one has, with the correction."""

    @property
    def distance_known(self) -> bool:
        """Whether `coarse_distance` takes no steps of its own."""

    def coarse_distance(self) -> float:
        """About the distance of the coarse mesh from its solution, relative."""

    def fine_correction(self, motion: Reals, tolerance: float) -> tuple[Reals, Reals]:
        """The correction where both meshes have solutions, and its derivatives (2, ...) along the hand.

        Args:
            motion: (2, n, d) displacements of the fine nodes a unit of each of the hand's coefficients.
            tolerance: of each linear solve.

        Raises:
            ReplayProblem: there is no derivative.
        """

    def way(self, correction: Reals) -> float:
        """Of a correction since both meshes had solutions, relative."""

    def refine(self) -> bool:
        """Take a step of the fine mesh towards its solution, beside what is shown; whether another one is needed."""

    def reached(self) -> Reals | None:
        """The correction that steps of `refine` have led to; None where that is no better than what is shown."""

    def take(self) -> None:
        """Let the fine mesh be solved from where `refine` has come to."""


class Refinable(Protocol):
    """An analysis on the finest of nested meshes, which those that can be have as `refinable`."""

    def refined(self, levels: int) -> RefiningPredictor:
        """Predicts frames from a coarse mesh, of so many nested ones the first."""
