"""Estimated errors of the quantities of linear, steady scenes: one more solve a quantity."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from restshape.analysis.correction import conjugate_steps, gathered, preconditioner
from restshape.fem.derivative import Differentiable
from restshape.fem.quantity_error import quantity_error
from restshape.first_use import made

if TYPE_CHECKING:
    from restshape.algebra.linear import LinearSolver
    from restshape.analysis.linear_system import LinearSystem
    from restshape.fem.error_estimate import RecoveryEstimate
    from restshape.fem.observer import Observer
    from restshape.fem.problem import Problem

NONE_HERE = "errors of quantities are estimated in linear scenes at rest, of frequencies and of load factors"
LEAVE_OUT = "leave error = true out"


class LinearState(Protocol):
    """A solution of a linear problem, and what it was found with."""

    @property
    def x(self) -> np.ndarray: ...
    @property
    def predicted(self) -> bool: ...
    @property
    def problem(self) -> Problem: ...
    @property
    def system(self) -> LinearSystem: ...
    @property
    def observer(self) -> Observer: ...


class Estimated(Protocol):
    """What errors are estimated of: an analysis of a linear, symmetric problem.

    Attributes:
        solver: whose kept preconditioner is used.
    """

    solver: LinearSolver

    @property
    def state(self) -> LinearState: ...
    @property
    def error_estimate(self) -> RecoveryEstimate | None: ...


class SteadyQuantityErrors:
    """Estimates errors of quantities at the last solution, once a solution.

    Args:
        analysis: whose state they are of.
    """

    def __init__(self, analysis: Estimated) -> None:
        self.analysis = analysis
        self._known: tuple[Any, dict[str, float]] = (None, {})

    def __call__(self, names: Iterable[str]) -> dict[str, float]:
        """The estimated size of the error of each quantity.

        Not a number of predictions, where it has no estimate, and where a dual solve does not converge.
        """
        state = self.analysis.state
        if self._known[0] is not state:
            self._known = (state, {})
        known = self._known[1]
        known.update(self._estimated([name for name in names if name not in known]))
        return {name: known[name] for name in names}

    def _estimated(self, names: list[str]) -> dict[str, float]:
        state, estimate = self.analysis.state, self.analysis.error_estimate
        if not names or estimate is None or state.predicted or not state.problem.symmetric:
            return dict.fromkeys(names, np.nan)
        primal, found = estimate.sampled(state.x), {}
        for name in names:
            function = state.observer.functions.get(name)
            if not isinstance(function, Differentiable):
                found[name] = np.nan
                continue
            found[name] = quantity_error(state.problem, estimate, primal, function.derivative(state.x), self._dual)
        return found

    def _dual(self, rhs: np.ndarray) -> np.ndarray:
        """The dual to 1 % in the energy norm: what is left of it is orthogonal to the error.

        Steps of conjugate gradients that the solver does not count, so that frames are what they are without it.
        """
        system, solver = self.analysis.state.system, self.analysis.solver
        product = gathered(made(system.mat).mult, system.rows, system.comm)
        found = conjugate_steps(product, preconditioner(solver, system.rows), rhs.ravel())
        return found.reshape(rhs.shape)
