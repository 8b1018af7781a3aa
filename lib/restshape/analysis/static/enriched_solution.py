"""Solutions on the next richer space, by few steps on the preconditioner that is kept of the space itself."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

import numpy as np
from petsc4py import PETSc

from restshape.algebra.factors.gathering import gather_vector
from restshape.algebra.factors.lone_factor import LoneFactor
from restshape.algebra.linear import LinearSolver
from restshape.algebra.preconditioner import free
from restshape.analysis.correction import KeptOperation, conjugate_steps, matrix_product
from restshape.analysis.static.linear_system import LinearSystem
from restshape.errors import ReplayProblem
from restshape.fem.assembled import Assembled
from restshape.fem.enrichment import Enrichment
from restshape.fem.problem import INTERNAL
from restshape.fem.residuals import Operation, unconstrained_residual

if TYPE_CHECKING:
    from restshape.algebra.factors.shared_factor import SharedFactor

log = logging.getLogger("restshape.analysis")

MOST_FACTORED = 500_000
"""Unknowns of a richer space whose matrix gets a complete factor."""


class EnrichedSystem:
    """Solves a linear, symmetric problem on a richer space than it was solved on.

    Conjugate gradients start at the solution. They are preconditioned on two levels: the kept preconditioner of the
    space, and the diagonal of the richer one's matrix. Where elements take means, as of incompressible materials,
    the solution is not in the richer space's, whose matrix gets a complete factor.

    Args:
        enrichment: of the problem.
        solver: whose kept preconditioner is used; its own state is left as it is.
        system: that it has solved.
        backend: of the operator.

    Source: Xu, SIAM Review 34 (1992) 581; docs/theory/error-estimates.md.
    """

    def __init__(self, enrichment: Enrichment, solver: LinearSolver, system: LinearSystem, backend: str | None) -> None:
        self.enrichment, self._solver, self._coarse, self._backend = enrichment, solver, system, backend
        self._system = LinearSystem(system.comm, enrichment.problem, backend, solver.traits)
        from scipy.sparse import identity, kron

        # For arrays (n f,): products with one vector are several times faster than with one a field.
        fields = identity(enrichment.problem.boundary.values.shape[1])
        self._up = kron(enrichment.over.prolongation, fields, format="csr")
        self._down = self._up.T.tocsr()
        self._problem = enrichment.problem
        self._before: tuple[int, np.ndarray] | None = None
        self._complete = self._problem.nested is not self._problem
        self._factor: LoneFactor | SharedFactor | None = None

    def solution(self, x: np.ndarray, free: np.ndarray, geometry: int) -> np.ndarray:
        """The unknowns (m, f), to 1 % of what they are away from those of the space, in the energy norm.

        Steps begin at what they were away before, times a factor, where no node has moved since. Not numbers where they
        do not converge, and where there is no factor.

        Args:
            x: (n, f) solution of the space.
            free: (n, f) where its unknowns are not prescribed.
            geometry: version of where its nodes are.
        """
        self._follow()
        problem, system = self.enrichment.problem, self._system
        start = self.enrichment.unknowns(x)
        residual = -unconstrained_residual(problem, start)
        problem.boundary.zero(residual)
        internal = Assembled(problem.integrals(INTERNAL), system.operator)
        matrix = internal.system(problem.boundary.values, np.zeros_like(start))
        if self._complete:
            return start + self._factored(matrix, residual.ravel()).reshape(start.shape)
        diagonal = np.zeros(start.size)
        diagonal[system.rows] = matrix.getDiagonal().array
        gather_vector(diagonal, system.rows, system.comm)
        product = matrix_product(matrix, system.rows, system.comm)
        begun, left, known = self._begun(product, residual.ravel(), geometry)
        missing = begun + conjugate_steps(product, self._two_levels(diagonal, free), left, known)
        self._before = geometry, missing
        return start + missing.reshape(start.shape)

    def _follow(self) -> None:
        """Meet another problem of the enrichment; its pattern is the same where its unknowns are numbered alike."""
        problem = self.enrichment.problem
        if problem is self._problem:
            return
        self._complete = problem.nested is not problem
        if problem.space is self._problem.space:
            self._system.operator.set_constraints(problem.boundary.mask)
        else:
            self._system = LinearSystem(self._coarse.comm, problem, self._backend, self._solver.traits)
            self._before = None
            if self._factor is not None:
                self._factor.stale_pattern = True
        self._problem = problem

    def _factored(self, matrix: PETSc.Mat, residual: np.ndarray) -> np.ndarray:
        """What is missing (m f,), by a complete factor of the matrix; not numbers where there is none."""
        system, found = self._system, np.full_like(residual, np.nan)
        if residual.size > MOST_FACTORED:
            return found
        if self._factor is None:
            fields = self._problem.boundary.mask.shape[1]
            self._factor = LoneFactor(blocks=True) if system.comm.size == 1 else _shared_factor(fields)
        b, x = matrix.createVecs()
        b.array[:] = residual[system.rows]
        try:
            if self._factor.make(matrix, matrix, 0.0) == 0:
                self._factor.solve(b, x)
                found[system.rows] = x.array
        except ReplayProblem as problem:
            log.info("No errors of quantities: %s", problem)
        free(b, x)
        gather_vector(found, system.rows, system.comm)
        return found

    def _begun(self, product: Operation, residual: np.ndarray, geometry: int) -> tuple[np.ndarray, np.ndarray, float]:
        """Where steps begin (m f,), the residual left there, and its squared energy.

        That is the multiple of what was missing before that is nearest in the energy norm.
        """
        nothing = np.zeros_like(residual), residual, 0.0
        if self._before is None or self._before[0] != geometry:
            return nothing
        before = self._before[1].copy()
        self.enrichment.problem.boundary.zero(before)
        force = product(before)
        energy = float(before @ force)
        if not energy > 0.0:
            return nothing
        factor = float(before @ residual) / energy
        return factor * before, residual - factor * force, factor**2 * energy

    def _two_levels(self, diagonal: np.ndarray, free: np.ndarray) -> Operation:
        """About the inverse of the richer matrix of this diagonal (m f,), for arrays (m f,); free (n, f)."""
        kept = KeptOperation(self._solver, self._coarse.rows)
        up, down, boundary, free = self._up, self._down, self.enrichment.problem.boundary, free.ravel()

        def apply(r: np.ndarray) -> np.ndarray:
            found = r / diagonal + up @ (free * kept(free * (down @ r)))
            boundary.zero(found)
            return found

        return apply


def _shared_factor(fields: int) -> SharedFactor:
    # It brings SciPy, which is needed here alone.
    from restshape.algebra.factors.shared_factor import SharedFactor

    return SharedFactor(fields)
