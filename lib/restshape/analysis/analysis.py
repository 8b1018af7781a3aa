"""What the replay asks of an analysis, whatever its physics."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol, TypeVar

import numpy as np
from petsc4py import PETSc

from restshape.algebra.linear_report import LinearReport
from restshape.algebra.stages import Stages
from restshape.analysis.frame import Frame
from restshape.analysis.row_values import RowValues
from restshape.analysis.solution import Solution
from restshape.calibration import Calibration
from restshape.fem.problem import Fields, Problem
from restshape.fem.space import Space
from restshape.policy import Policy


@dataclass(frozen=True)
class Context:
    """What all parts of one replay share.

    Args:
        comm: PETSc communicator.
        policy: what is reused from frame to frame.
        calibration: seconds a unit of counted work.
        stages: takes the time of each stage.
        guided: what would mend a frame is sought where nothing but the result needs it.
    """

    comm: PETSc.Comm
    policy: Policy
    calibration: Calibration
    stages: Stages
    guided: bool = True


@dataclass(frozen=True)
class Comparison:
    """A frame beside a cold solve on the same mesh.

    Args:
        entries: largest difference of matrix entries over the largest entry.
        solution: relative difference of the solutions, in the analysis's own norm; None: nothing was solved.
    """

    entries: float
    solution: float | None


Alignment = Callable[[np.ndarray], np.ndarray]
"""A linear function of values, or of a derivative of them."""


class Predictor(Protocol):
    """Shows frames of a drag to first order in the hand, without a solve.

    Attributes:
        transferable: values of an old mesh serve as a guess on a new one, wherever the old one lies.
    """

    transferable: bool

    def derivative(self, motion: np.ndarray, tolerance: float) -> np.ndarray:
        """Derivatives (2, ...) of `values` along the hand's two directions.

        Args:
            motion: (2, n, d) node displacements a unit of each of the hand's coefficients.
            tolerance: of each linear solve.

        Raises:
            ReplayProblem: there is no derivative.
        """

    def values(self) -> np.ndarray:
        """What is predicted, at the last solution or prediction."""

    def set_values(self, values: np.ndarray) -> None:
        """Take predicted values for those of the mesh as it lies now, without a solve."""

    @property
    def prediction(self) -> np.ndarray | None:
        """The prediction that the analysis holds; None where it holds a solution."""

    def error(self, predicted: np.ndarray) -> float:
        """The relative distance of a prediction on this mesh from the solution."""

    def compare_cold(self) -> float:
        """The same distance of the prediction that the analysis holds from a cold solve on the mesh as it lies."""

    def quantity_distances(self) -> dict[str, float]:
        """Estimated distances of the quantities of the prediction that the analysis holds from those of the solution.

        Of those alone that can be estimated.
        """

    def counted(self) -> tuple[int, ...]:
        """Counts of all work of solves so far."""

    def seconds_since(self, before: tuple[int, ...]) -> float:
        """Seconds by the calibration of the work since there were these counts."""

    def step_seconds(self) -> float:
        """Seconds by the calibration that `step` is expected to cost; infinite where there are no steps."""

    def step(self) -> bool:
        """Take one step from the prediction that the analysis holds towards the solution; whether another one pays."""

    def in_basis(self) -> np.ndarray:
        """The values that the analysis holds, in the basis of the last solution."""

    def alignment(self, before: np.ndarray) -> Alignment | None:
        """What brings values, and derivatives, of solutions before to the basis of the last solution.

        Args:
            before: the values of one of those solutions, in the basis that all of them have.

        Returns:
            None where they cannot be mixed with those of the last solution.
        """

    def nodal_fields(self, rows: np.ndarray, nodes: int) -> np.ndarray | None:
        """The fields (m, n, f) at the nodes of `Analysis.space` that values or derivatives (count, ...) hold.

        Args:
            rows: of solutions on one mesh; nodes: how many it has.

        Returns:
            None where they are not of such nodes.
        """

    def with_nodal_fields(self, rows: np.ndarray, fields: np.ndarray) -> np.ndarray:
        """The same rows (count, ...) with fields (m, n, f) at other nodes, which the analysis has been solved on."""

    def set_mixed(self, values: np.ndarray) -> None:
        """As `set_values`, of values that several solutions in one basis have been mixed to."""

    def mixable(self) -> Predictor:
        """What predicts values that can be mixed from those of several solutions; often itself."""


class QuantityErrors(Protocol):
    """Estimates the errors of quantities at the state; one that solves for them has a true attribute `solves`."""

    def __call__(self, names: Sequence[str]) -> dict[str, float]:
        """The estimated size of the error of each, in its unit; not a number where there is no estimate."""


P_co = TypeVar("P_co", bound=Problem, covariant=True)


class State(Protocol[P_co]):
    """What an analysis knows after a frame: frozen, so that an analysis goes back to it by an assignment.

    Attributes:
        problem: that was solved last, once there is one.
        interrupted: the last frame has failed: what was set up for it must be set up again.
    """

    @property
    def problem(self) -> P_co | None: ...
    @property
    def interrupted(self) -> bool: ...


class Analysis(Protocol[P_co]):
    """Computes the answer of each frame of an edit, from that of the frame before.

    Attributes:
        state: `solve` replaces it, and one that fails assigns that of before, marked as interrupted. Versions in it
            decide what is stale.
        space: of the last solution; None before the first.
        estimated_quantity: what the estimates of `errors` are of.
        why_not: why frames cannot be predicted where there is no predictor, and what to do.
    """

    estimated_quantity: str
    why_not: str

    @property
    def state(self) -> State[P_co]: ...

    @property
    def predictor(self) -> Predictor | None:
        """Predicts frames from the state; None where they cannot be."""

    @property
    def quantity_errors(self) -> QuantityErrors | None:
        """Estimates errors of quantities of the state; None where they cannot be."""

    @property
    def space(self) -> Space | None: ...

    @property
    def unknowns(self) -> int:
        """Unknowns of the system, prescribed ones included."""

    @property
    def tolerance(self) -> float:
        """That solutions meet, in the norm of `compare_cold`."""

    def solve(self, frame: Frame) -> LinearReport:
        """Bring the state up to date with a frame.

        Raises:
            ReplayProblem: no solution is found; the state is that of before.
            UserError: the scene's new values make no sense; likewise.
        """

    def observe(self) -> dict[str, float]:
        """The scene's quantities of interest at the state."""

    def observed_on(
        self, frame: Frame, before: State[Problem] | None, solved: State[Problem], earlier: bool
    ) -> dict[str, float]:
        """The quantities of a frame on another mesh of its shape, by an analysis that has solved nothing yet.

        Args:
            frame: with the other mesh.
            before: the state, before it solved the frame, of the analysis of this kind that has; None: it had none.
            solved: its state since.
            earlier: the mesh has the shape of the frame before: what goes on in time takes no steps on it.

        Returns:
            None of them where that mesh has no state to begin with.

        Raises:
            ReplayProblem: there is no solution on that mesh.
            UserError: likewise.
        """

    def observed_beside(self, frame: Frame, before: State[Problem] | None) -> dict[str, float] | None:
        """The same of a mesh with the nodes of this one, from the answer and with the preconditioner that are known.

        None where a solve with nothing kept is wanted. Nothing of this analysis changes.

        Args:
            frame: with the other mesh.
            before: the state before it solved the frame.

        Raises:
            UserError: the scene has no meaning on that mesh.
        """

    def row(self) -> RowValues:
        """Columns of the frame's row that only this analysis has."""

    def residual_norm(self) -> float:
        """The residual of the state over what it is measured against."""

    def errors(self) -> dict[str, float]:
        """Error estimates of the state by column: `estimate` of the mesh, `estimate_time` of time steps."""

    def solution(self) -> Solution:
        """The state, as who compares answers of different settings sees it."""

    def linear_displacement(self) -> np.ndarray | None:
        """Displacement (n, d) [m] of the nodes by linear theory, no copy; None where there is none."""

    def fields(self) -> Fields:
        """What a recording shows of the state."""

    def blank_fields(self, space: Space) -> Fields:
        """The same fields, all NaN, on a space that has not been solved on."""

    def compare_cold(self) -> Comparison:
        """The state beside a solve with new pattern, values and factor, and no guess."""


class Timeless:
    """An analysis whose frames stand each for itself: none goes on in time from the one before."""

    def observed_on(
        self: Analysis[Problem], frame: Frame, before: State[Problem] | None, solved: State[Problem], earlier: bool
    ) -> dict[str, float]:
        """The quantities of a frame on another mesh of its shape; see `Analysis.observed_on`."""
        self.solve(frame)
        return self.observe()

    def observed_beside(self, frame: Frame, before: State[Problem] | None) -> dict[str, float] | None:
        """None: see `Analysis.observed_beside`."""
        return None
