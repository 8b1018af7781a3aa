"""The time steps of a frame once more, from its first state, by matrices assembled from nothing and another formula."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.sparse as sp
from petsc4py import PETSc
from scipy.sparse.linalg import SuperLU, splu

from restshape.algebra.gathering import gather_matrix
from restshape.algebra.operator import Operator
from restshape.errors import ReplayProblem
from restshape.fem.integral import Integral
from restshape.fem.problem import FOLLOWERS, INTERNAL, MASS, REFERENCE, STIFFNESS
from restshape.fem.residuals import unconstrained_residual
from restshape.fem.semidiscrete import SemiDiscrete
from restshape.fem.time_integration import Newmark, Theta, TimeIntegration, TimeState

CONVERGED = 1e-11
"""Change of the highest rates in a step of Newton's method, over the largest, at which a time step has converged."""
MOST = 60
"""Steps of Newton's method in a time step."""
LEAST = 1e-3
"""Part of a step of Newton's method that is taken at least."""


class RepeatedMotion:
    """Steps with the highest rate as the unknown, each solved by Newton's method on complete factors.

    Newmark's a' solves M a' + C v' + r(y') = -M a_base' with y' = y + dt v + dt^2 ((1/2 - beta) a + beta a') and
    v' = v + dt ((1 - gamma) a + gamma a'), which begins with the a of equilibrium; the theta method's rate v' solves
    M v' + theta r(y + dt v') + (1 - theta) r(y) = 0. Nothing of `EffectiveSystem` and `MotionEquations` is used.

    Args:
        body: set up from nothing on the space as it lies.
        integration: of the frame.

    Source: T. J. R. Hughes, The Finite Element Method, 1987, section 9.1.
    """

    def __init__(self, body: SemiDiscrete, integration: TimeIntegration) -> None:
        self.body, self.integration = body, integration
        self.shape, self.free = body.constrained.shape, np.flatnonzero(~body.constrained.ravel())
        fields = self.shape[1]
        offsets, problem = np.array([0, self.shape[0]], dtype=np.int32), body.problem
        self._operator = Operator(PETSc.COMM_SELF, fields, offsets, "coo", problem.symmetric, problem.definite)
        self._operator.set_topology(problem.blocks(), problem.boundary.mask)
        zero = np.zeros(self.shape)
        self.mass = self._matrix([MASS], zero)
        self.reference = self._matrix([STIFFNESS if problem.linear else REFERENCE], zero)
        self.damping = body.damping_of.alpha * self.mass + body.damping_of.beta * self.reference

    def __call__(self, start: TimeState) -> TimeState:
        """The state after the steps of a frame that begins with another."""
        scheme = self.integration.scheme
        y, v = start.y.ravel()[self.free], start.v.ravel()[self.free]
        if isinstance(scheme, Theta):
            y, v = self._theta(scheme, y, v)
        elif isinstance(scheme, Newmark):
            y, v = self._newmark(scheme, y, v, start.time)
        else:
            raise TypeError(f"no other formula is known for {type(scheme).__name__}")
        return TimeState(self._whole(y), self._whole(v), None, start.time + self.integration.steps * scheme.dt)

    def tangent(self, y: np.ndarray) -> sp.csr_matrix:
        """The matrix (k, k) of the free unknowns that a step to y (n, f) is solved with: K + a0 M + a1 C."""
        scheme = self.integration.scheme
        return self._stiffness(y.ravel()[self.free]) + scheme.a0 * self.mass + scheme.a1 * self.damping

    def distance(self, state: TimeState, other: TimeState) -> float:
        """How far a state is from another, over the size of that one; over the start's 1 where it is 0.

        In the norm of a step's matrix where all unknowns are 0, of the unknowns and, of second order in time, of the
        way dt beta / gamma v that rates stand for in it.
        """
        size = self._norm(other.y, other.v)
        found = self._norm(state.y - other.y, state.v - other.v)
        return found / size if size else found

    def _norm(self, y: np.ndarray, v: np.ndarray) -> float:
        scheme = self.integration.scheme
        matrix = self.reference + scheme.a0 * self.mass + scheme.a1 * self.damping
        parts = [y.ravel()[self.free], *([v.ravel()[self.free] / scheme.a1] if scheme.a1 else [])]
        return float(np.sqrt(sum(max(0.0, part @ (matrix @ part)) for part in parts)))

    def _newmark(self, scheme: Newmark, y: np.ndarray, v: np.ndarray, time: float) -> tuple[np.ndarray, np.ndarray]:
        dt, beta, gamma = scheme.dt, scheme.beta, scheme.gamma
        a = splu(self.mass.tocsc()).solve(-self._residual(y) - self.damping @ v - self._base_force(time))
        solve = _Newton(self.body.problem.linear)
        for k in range(1, self.integration.steps + 1):
            base, last = self._base_force(time + k * dt), y
            y, v = y + dt * v + dt**2 * (0.5 - beta) * a, v + dt * (1 - gamma) * a

            def residual(a: np.ndarray, y: np.ndarray = y, v: np.ndarray = v, base: np.ndarray = base) -> np.ndarray:
                rest = self._residual(y + beta * dt**2 * a) + base
                return self.mass @ a + self.damping @ (v + gamma * dt * a) + rest

            def tangent(a: np.ndarray, y: np.ndarray = y) -> sp.csr_matrix:
                stiffness = self._stiffness(y + beta * dt**2 * a)
                return self.mass + gamma * dt * self.damping + beta * dt**2 * stiffness

            # From the last place: an acceleration that a new shape asks for may lead anywhere.
            a = solve((last - y) / (beta * dt**2), residual, tangent)
            y, v = y + beta * dt**2 * a, v + gamma * dt * a
        return y, v

    def _theta(self, scheme: Theta, y: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        dt, theta = scheme.dt, scheme.theta
        solve = _Newton(self.body.problem.linear)
        for _ in range(self.integration.steps):
            before = (1.0 - theta) * self._residual(y)

            def residual(v: np.ndarray, y: np.ndarray = y, before: np.ndarray = before) -> np.ndarray:
                return self.mass @ v + theta * self._residual(y + dt * v) + before

            def tangent(v: np.ndarray, y: np.ndarray = y) -> sp.csr_matrix:
                return self.mass + theta * dt * self._stiffness(y + dt * v)

            v = solve(np.zeros_like(v), residual, tangent)
            y = y + dt * v
        return y, v

    def _base_force(self, time: float) -> np.ndarray:
        """M 1 a_base (k,) at a time [s]."""
        base = self.integration.base_acceleration(time, self.shape[1])
        return self.body.mass.apply(np.zeros(self.shape) + base).ravel()[self.free]

    def _residual(self, y: np.ndarray) -> np.ndarray:
        """Internal less applied forces (k,) at free unknowns y (k,)."""
        return unconstrained_residual(self.body.problem, self.body.unknowns(self._whole(y))).ravel()[self.free]

    def _stiffness(self, y: np.ndarray) -> sp.csr_matrix:
        """The tangent (k, k) of these forces."""
        if self.body.problem.linear:
            return self.reference
        return self._matrix([INTERNAL, FOLLOWERS], self.body.unknowns(self._whole(y)))

    def _matrix(self, kinds: list[str], x: np.ndarray) -> sp.csr_matrix:
        """The sum of tangents (k, k) of integrals at unknowns x (n, f), of the free ones."""
        integrals: list[Integral] = [part for kind in kinds for part in self.body.problem.integrals(kind)]
        mat = self._operator.assemble([part.term(x) for part in integrals], None)
        return gather_matrix(mat, PETSc.COMM_SELF)[self.free][:, self.free]

    def _whole(self, y: np.ndarray) -> np.ndarray:
        """Unknowns (n, f) less the prescribed ones, of free ones (k,)."""
        out = np.zeros(self.shape)
        out.ravel()[self.free] = y
        return out


class _Newton:
    """Newton's method on complete factors, the step halved while it makes the residual larger.

    Args:
        linear: one factor serves all.
    """

    def __init__(self, linear: bool) -> None:
        self.linear = linear
        self._factor: SuperLU | None = None

    def __call__(
        self,
        x: np.ndarray,
        residual: Callable[[np.ndarray], np.ndarray],
        tangent: Callable[[np.ndarray], sp.csr_matrix],
    ) -> np.ndarray:
        """The root of the residual that is found from x (k,).

        Raises:
            ReplayProblem: none is found.
        """
        force = residual(x)
        for _ in range(MOST):
            if self._factor is None or not self.linear:
                self._factor = splu(tangent(x).tocsc())
            change, part = self._factor.solve(force), 1.0
            while True:
                moved = x - part * change
                after = residual(moved)
                if part < LEAST or np.linalg.norm(after) < np.linalg.norm(force) or self._small(change, moved):
                    break
                part *= 0.5
            x, force = moved, after
            if self._small(part * change, x):
                return x
        raise ReplayProblem("the repeated step has no solution that is found")

    @staticmethod
    def _small(change: np.ndarray, x: np.ndarray) -> bool:
        return bool(np.abs(change).max(initial=0.0) <= CONVERGED * np.abs(x).max(initial=0.0))
