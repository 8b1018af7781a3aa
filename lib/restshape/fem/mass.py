"""The mass, or capacity, matrix of a problem, applied element by element on all nodes."""

import numpy as np

from restshape.errors import ReplayProblem
from restshape.fem.assembled import Assembled
from restshape.fem.problem import CONSISTENT, LUMPED, MASS, SteadyProblem

CONVERGED = 1e-15
"""Residual of a solve with the mass matrix, relative to the right side."""


class MassMatrix:
    """M of a problem, on a space whose nodes may move.

    Args:
        problem: with integrals of the kind `MASS`, and `LUMPED` and `CONSISTENT` where `solve` is asked for.

    Raises:
        UserError: the problem refuses its mass, as where a material has no density.
    """

    def __init__(self, problem: SteadyProblem) -> None:
        self.problem, self.space = problem, problem.space
        self.integrals = problem.integrals(MASS)
        self._assembled = Assembled(self.integrals)

    @property
    def params(self) -> np.ndarray:
        """Parameters of the cells' integral: mass an area (1,), or (ne, 1)."""
        return self.integrals[0].parameters

    def apply(self, v: np.ndarray) -> np.ndarray:
        """M v (n, f) of nodal values v (n, f)."""
        return self._assembled.residual(v)

    def energies(self, v: np.ndarray) -> np.ndarray:
        """Kinetic energies (ne,) of the cells at the velocities v (n, f); they sum to half of v . M v."""
        return self.integrals[0].energies(v)

    def momentum(self, v: np.ndarray) -> np.ndarray:
        """Linear momentum (f,) of the velocities v (n, f)."""
        return self.apply(v).sum(axis=0)

    def solve(self, rhs: np.ndarray, consistent: bool = False, tolerance: float = CONVERGED) -> np.ndarray:
        """The w (n, f), 0 where prescribed, for which M w = rhs elsewhere.

        Conjugate gradients with the lumped mass as preconditioner (its condition number is 4 at most: Wathen 1987).

        Args:
            rhs: (n, f).
            consistent: with the consistent mass even where the problem has the lumped one.
            tolerance: residual, relative to rhs.

        Raises:
            ReplayProblem: no convergence.
        """
        free = self.problem.boundary.mask == 0
        lumped = self.problem.integrals(LUMPED)
        inverse = free / Assembled(lumped).residual(np.ones(free.shape))
        if lumped[0].element.name == self.integrals[0].element.name and not consistent:
            return inverse * rhs
        whole = Assembled(self.problem.integrals(CONSISTENT))
        r = rhs * free
        goal = tolerance * np.linalg.norm(r)
        w, z = np.zeros_like(r), inverse * r
        p, rz = z.copy(), np.vdot(r, z)
        for _ in range(200):
            if np.linalg.norm(r) <= goal:
                return w
            q = whole.residual(p) * free
            step = rz / np.vdot(p, q)
            w += step * p
            r -= step * q
            z = inverse * r
            rz, last = np.vdot(r, z), rz
            p = z + (rz / last) * p
        raise ReplayProblem("the solve with the mass matrix did not converge")
