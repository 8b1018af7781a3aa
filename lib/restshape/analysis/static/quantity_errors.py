"""Estimated errors of the quantities of linear, steady scenes: by duals, or on a richer space."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from restshape.analysis.correction import KeptOperation, conjugate_steps, matrix_product
from restshape.analysis.static.enriched_errors import EnrichedErrors
from restshape.fem.derivative import Differentiable
from restshape.fem.quantity_error import CurvedProblem, quantity_error
from restshape.first_use import made

if TYPE_CHECKING:
    from restshape.analysis.static.linear_state import Estimated, LinearState
    from restshape.analysis.static.linear_system import LinearSystem

NONE_HERE = (
    "errors are estimated in symmetric steady linear scenes, and of load factors and frequencies without a motion"
)
NO_ERRORS = f"no errors of quantities are estimated here: {NONE_HERE}"
LEAVE_OUT = "leave error = true out"


class SteadyQuantityErrors:
    """Estimates errors of quantities at the last solution, once a solution.

    Args:
        analysis: whose state they are of.
    """

    solves = True

    def __init__(self, analysis: Estimated) -> None:
        self.analysis = analysis
        self._known: tuple[LinearState | None, dict[str, float]] = (None, {})
        self._duals: dict[str, tuple[LinearSystem, np.ndarray]] = {}
        self.enriched = EnrichedErrors(analysis)

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
        functions, found = state.observer.functions, dict.fromkeys(names, np.nan)
        smooth = {name: one for name in names if isinstance(one := functions.get(name), Differentiable)}
        others = [name for name in names if name in functions and name not in smooth]
        richer = self.enriched.follow(bool(others))
        if smooth:
            primal = estimate.sampled(state.x)
            curved = CurvedProblem.of(richer, state.problem, state.x) if richer else None
        for name, function in smooth.items():
            derivative, solve = function.derivative(state.x), partial(self._dual, name)
            found[name] = quantity_error(state.problem, estimate, primal, state.x, derivative, solve, curved)
        return found | (self.enriched(others) if others else {})

    def _dual(self, name: str, rhs: np.ndarray) -> np.ndarray:
        """The dual of a quantity to 1 % in the energy norm, from that of before on this mesh.

        What is left of it is orthogonal to the error. The steps of conjugate gradients do not count for the solver, so
        that frames are what they are without it.
        """
        system, solver = self.analysis.state.system, self.analysis.solver
        product = matrix_product(made(system.mat), system.rows, system.comm)
        on, before = self._duals.get(name, (None, rhs))
        residual, start = rhs.ravel(), np.zeros(rhs.size)
        known = 0.0
        if on is system:
            start = before
            force = product(start)
            known, residual = float(start @ force), residual - force
        found = start + conjugate_steps(product, KeptOperation(solver, system.rows), residual, known)
        self._duals[name] = (system, found)
        return found.reshape(rhs.shape)
