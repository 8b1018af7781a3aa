"""The mass, or capacity, matrix of a problem, applied element by element on all nodes."""

import numpy as np
from petsc4py import PETSc

from restshape.algebra.operator import Operator
from restshape.errors import ReplayProblem
from restshape.fem.assembled import Assembled
from restshape.fem.problem import CONSISTENT, LUMPED, MASS, SteadyProblem

CONVERGED = 1e-15
"""Residual of a solve with the mass matrix, relative to the right side."""
MOST = 200
"""Iterations of it."""


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
        self._consistent: ConsistentMass | None = None

    @property
    def params(self) -> np.ndarray:
        """Parameters of the cells' integral: mass an area (1,), or (ne, 1)."""
        return self.integrals[0].parameters

    def apply(self, v: np.ndarray) -> np.ndarray:
        """M v (n, f) of nodal values v (n, f)."""
        return self._assembled.residual(v)

    def energies(self, v: np.ndarray, cells: slice = slice(None)) -> np.ndarray:
        """Kinetic energies (m,) of some cells, or of all, at the velocities v (n, f): all sum to half of v . M v."""
        return self.integrals[0].of(cells).energies(v)

    def momentum(self, v: np.ndarray) -> np.ndarray:
        """Linear momentum (f,) of the velocities v (n, f)."""
        return self.apply(v).sum(axis=0)

    def solve(self, rhs: np.ndarray, consistent: bool = False, tolerance: float = CONVERGED) -> np.ndarray:
        """The w (n, f), 0 where prescribed, for which M w = rhs elsewhere.

        Conjugate gradients with the diagonal as preconditioner (its condition number is 4 at most).

        Args:
            rhs: (n, f).
            consistent: with the consistent mass even where the problem has the lumped one.
            tolerance: residual, relative to rhs.

        Raises:
            ReplayProblem: no convergence.

        Source: A. J. Wathen, Realistic eigenvalue bounds for the Galerkin mass matrix, IMA J. Numer. Anal. 7 (1987).
        """
        free = self.problem.boundary.mask == 0
        lumped = self.problem.integrals(LUMPED)
        if lumped[0].element.name == self.integrals[0].element.name and not consistent:
            return free / Assembled(lumped).residual(np.ones(free.shape)) * rhs
        if self._consistent is None:
            self._consistent = ConsistentMass(self.problem)
        return self._consistent.solve(rhs * free, tolerance)


class ConsistentMass:
    """The consistent mass matrix, assembled whole on each rank, and the method that solves with it.

    Args:
        problem: with integrals of the kind `CONSISTENT`, on a space whose nodes may move and whose edges may flip.
        operator: with the pattern of the space as it is, which others use before and after; None: one of its own.
    """

    def __init__(self, problem: SteadyProblem, operator: Operator | None = None) -> None:
        shape = problem.boundary.mask.shape
        self._problem, self._topology, self._places = problem, -1, np.zeros(0)
        self._operator = operator or Operator(PETSc.COMM_SELF, shape[1], np.array([0, shape[0]], dtype=np.int32))
        if operator:
            self._topology = problem.space.topology
        self._right, self._way = np.zeros(shape), np.zeros(shape)
        self._b, self._x = (PETSc.Vec().createWithArray(own, comm=PETSc.COMM_SELF) for own in (self._right, self._way))
        self._ksp = PETSc.KSP().create(PETSc.COMM_SELF)
        self._ksp.setType("cg")
        self._ksp.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
        self._ksp.getPC().setType("jacobi")

    def solve(self, rhs: np.ndarray, tolerance: float) -> np.ndarray:
        """The w (n, f), 0 where prescribed, for which M w = rhs elsewhere; rhs (n, f) is 0 where prescribed.

        Raises:
            ReplayProblem: no convergence.
        """
        ksp = self._ksp
        self._follow()
        self._right[:] = rhs
        for vector in (self._b, self._x):
            vector.stateIncrease()
        ksp.setTolerances(rtol=tolerance, atol=0.0, max_it=MOST)
        ksp.solve(self._b, self._x)
        if ksp.getConvergedReason() < 0:
            raise ReplayProblem("the solve with the mass matrix did not converge")
        return self._way.copy()

    def _follow(self) -> None:
        """Assemble the matrix where it is not of the space as it lies."""
        problem, space = self._problem, self._problem.space
        known = self._topology == space.topology
        # Places themselves are compared: a frame that is taken back gives its version to the next one.
        if known and np.array_equal(self._places, space.X) and not problem.varies:
            return
        if not known:
            self._operator.set_topology(problem.blocks(), problem.boundary.mask)
        terms = [part.term(self._way) for part in problem.integrals(CONSISTENT)]
        self._ksp.setOperators(self._operator.assemble(terms, None))
        self._topology, self._places = space.topology, space.X.copy()
