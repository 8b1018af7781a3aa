"""The time steps of a frame once more, from its first state, by matrices assembled from nothing and another formula."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from petsc4py import PETSc

from restshape.algebra.factors.gathering import gather_matrix
from restshape.algebra.operator import Operator
from restshape.fem.integral import Integral
from restshape.fem.problem import FOLLOWERS, INTERNAL, MASS, REFERENCE, STIFFNESS
from restshape.fem.residuals import unconstrained_residual
from restshape.fem.semidiscrete import SemiDiscrete
from restshape.fem.time_integration import TimeIntegration, TimeState


class RepeatedMotion:
    """Steps with the highest rate as the unknown, by the `plain_steps` of the scheme, a `fem.plain_steps.PlainSystem`.

    Nothing of `EffectiveSystem` and `MotionEquations` is used.

    Args:
        body: set up from nothing on the space as it lies.
        integration: of the frame.

    Attributes:
        mass, damping: (k, k) of the free unknowns; linear: the stiffness is constant.

    Source: T. J. R. Hughes, The Finite Element Method, 1987, section 9.1.
    """

    def __init__(self, body: SemiDiscrete, integration: TimeIntegration) -> None:
        self.body, self.integration, self.linear = body, integration, body.problem.linear
        self.shape, self.free = body.constrained.shape, np.flatnonzero(~body.constrained.ravel())
        fields = self.shape[1]
        offsets, problem = np.array([0, self.shape[0]], dtype=np.int32), body.problem
        self._operator = Operator(PETSc.COMM_SELF, fields, offsets, None, problem.symmetric, problem.definite)
        self._operator.set_topology(problem.blocks(), problem.boundary.mask)
        zero = np.zeros(self.shape)
        self.mass = self._matrix([MASS], zero)
        self.reference = self._matrix([STIFFNESS if problem.linear else REFERENCE], zero)
        self.damping = body.damping_of.alpha * self.mass + body.damping_of.beta * self.reference

    def __call__(self, start: TimeState) -> TimeState:
        """The state after the steps of a frame that begins with another."""
        scheme, steps = self.integration.scheme, self.integration.steps
        y, v = start.y.ravel()[self.free], start.v.ravel()[self.free]
        y, v = scheme.plain_steps(self, y, v, start.time, steps)
        return TimeState(self._whole(y), self._whole(v), None, start.time + steps * scheme.dt)

    def tangent(self, y: np.ndarray) -> sp.csr_matrix:
        """The matrix (k, k) of the free unknowns that a step to y (n, f) is solved with: K + a0 M + a1 C."""
        scheme = self.integration.scheme
        return self.stiffness(y.ravel()[self.free]) + scheme.a0 * self.mass + scheme.a1 * self.damping

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

    def base_force(self, time: float) -> np.ndarray:
        """M 1 a_base (k,) at a time [s]."""
        base = self.integration.base_acceleration(time, self.shape[1])
        return self.body.mass.apply(np.zeros(self.shape) + base).ravel()[self.free]

    def residual(self, y: np.ndarray) -> np.ndarray:
        """Internal less applied forces (k,) at free unknowns y (k,)."""
        return unconstrained_residual(self.body.problem, self.body.unknowns(self._whole(y))).ravel()[self.free]

    def stiffness(self, y: np.ndarray) -> sp.csr_matrix:
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
