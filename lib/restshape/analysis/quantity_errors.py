"""Estimated errors of the quantities of linear, steady scenes: one more solve a quantity."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from typing import TYPE_CHECKING, Protocol, cast

import numpy as np

from restshape.analysis.correction import conjugate_steps, gathered, preconditioner
from restshape.fem.derivative import Differentiable
from restshape.fem.quantity_error import CurvedProblem, quantity_error
from restshape.first_use import made
from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.mesh.mesh import Mesh

if TYPE_CHECKING:
    from restshape.algebra.linear import LinearSolver
    from restshape.analysis.linear_system import LinearSystem
    from restshape.fem.error_estimate import RecoveryEstimate
    from restshape.fem.observer import Observer
    from restshape.fem.problem import Problem
    from restshape.scene.model import Scene
    from restshape.scene.plan import Plan

NONE_HERE = "errors of quantities are estimated in linear scenes at rest, of frequencies and of load factors"
NO_ERRORS = f"no errors of quantities are estimated here: {NONE_HERE}"
LEAVE_OUT = "leave error = true out"


class LinearState(Protocol):
    """A solution of a linear problem, and what it was found with."""

    @property
    def x(self) -> np.ndarray: ...
    @property
    def predicted(self) -> bool: ...
    @property
    def scene(self) -> Scene: ...
    @property
    def plan(self) -> Plan: ...
    @property
    def mesh(self) -> Mesh | LagrangeSpace | None: ...
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
        make: makes the problem of a scene, a plan and a space.
    """

    solver: LinearSolver

    @property
    def state(self) -> LinearState: ...
    @property
    def make(self) -> Callable[[Scene, Plan, LagrangeSpace], Problem]: ...
    @property
    def error_estimate(self) -> RecoveryEstimate | None: ...


class SteadyQuantityErrors:
    """Estimates errors of quantities at the last solution, once a solution.

    Args:
        analysis: whose state they are of.
    """

    def __init__(self, analysis: Estimated) -> None:
        self.analysis = analysis
        self._known: tuple[LinearState | None, dict[str, float]] = (None, {})
        self._duals: dict[str, tuple[LinearSystem, np.ndarray]] = {}
        self._second: tuple[tuple[Mesh, int, Scene] | None, Problem | None] = (None, None)

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
        primal, curved, found = estimate.sampled(state.x), self._curved(), {}
        for name in names:
            function = state.observer.functions.get(name)
            if not isinstance(function, Differentiable):
                found[name] = np.nan
                continue
            derivative, solve = function.derivative(state.x), partial(self._dual, name)
            found[name] = quantity_error(state.problem, estimate, primal, state.x, derivative, solve, curved)
        return found

    def _curved(self) -> CurvedProblem | None:
        """The problem with curved sides, and loads as second order samples them; None where it is of that order.

        It is kept for as long as mesh topology and scene stay.
        """
        state = self.analysis.state
        mesh = state.mesh
        if not isinstance(mesh, Mesh) or state.problem.space is not mesh or mesh.hierarchy:
            return None
        key, (known, problem) = (mesh, mesh.topology, state.scene), self._second
        if problem is None or known != key:
            problem = self.analysis.make(state.scene, state.plan, LagrangeSpace(mesh))
            self._second = (key, problem)
        else:
            space = cast(LagrangeSpace, problem.space)
            space.bend(mesh.outline)
            space.place()
            problem.update()
        return CurvedProblem.of(problem, state.x)

    def _dual(self, name: str, rhs: np.ndarray) -> np.ndarray:
        """The dual of a quantity to 1 % in the energy norm, from that of before on this mesh.

        What is left of it is orthogonal to the error. The steps of conjugate gradients do not count for the solver, so
        that frames are what they are without it.
        """
        system, solver = self.analysis.state.system, self.analysis.solver
        product = gathered(made(system.mat).mult, system.rows, system.comm)
        on, before = self._duals.get(name, (None, rhs))
        residual, start = rhs.ravel(), np.zeros(rhs.size)
        known = 0.0
        if on is system:
            start = before
            force = product(start)
            known, residual = float(start @ force), residual - force
        found = start + conjugate_steps(product, preconditioner(solver, system.rows), residual, known)
        self._duals[name] = (system, found)
        return found.reshape(rhs.shape)
