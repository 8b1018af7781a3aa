"""Linear solves of motion in steps: conjugate gradients by PETSc, with what one step gives the next."""

from __future__ import annotations

import numpy as np
from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.at_exit import destroyed_at_exit
from restshape.algebra.factors.shared_solves import set_shared_factor
from restshape.algebra.nodal import NodalVectors
from restshape.algebra.preconditioner import set_preconditioner, substitute_by_panels
from restshape.algebra.reuse.tries import Tries
from restshape.arrays import Reals

WAYS = 2
"""Solutions that the next guess is made of."""
ALIKE = 1e-12
"""Singular value, over the largest one, of the products of ways that are as good as parallel."""
SHIFT = 0.01
"""Part of the diagonal that is added to the matrix that incomplete factors are made from: without it most fail."""
MOST = 2000
"""Iterations of a solve."""
DEAR = 1.2
"""Iterations of relaxation, over the square root of the number of unknowns, from which on a complete factor costs less:
on a sheet a factor takes as many products as about so many readings of the matrix."""
KEPT = 10
"""Iterations with the factor of an earlier step, from which on a new one costs less."""


# More than 15 attributes: what solves, by iterations and by factors, and what one step gives the next.
class StepSolver:
    """Solves A d = b for a row of symmetric positive definite matrices of one size that change little by little.

    The guess is the best one, in the norm of A, among all sums of multiples of the last two solutions. The usual
    preconditioner is symmetric successive over-relaxation by nodes, on each rank of its own rows: it wants no factor,
    and is positive definite where A is. In blocks of three on one rank both sweeps and the product share one reading of
    the matrix (`node_ssor`), unless PETSc's options name a method. Where that takes many iterations, as beside stiff
    seams, complete factors take its place until `begin`, each for as many steps as it serves.

    Args:
        comm: PETSc communicator.
        prefix: of options in PETSc's database.
        nodal: of the unknowns.
        tolerance: residual over the right side.
        preconditioner: of PETSc: "sor", "ilu" without fill, or "cholesky", which solves alone.

    Attributes:
        iterations: since `begin`.
        blocks: the next matrix may be of type BAIJ. Multigrid and Eisenstat's form have none, nor can PETSc copy them
            whole, nor factor them in blocks of a node.
    """

    def __init__(
        self, comm: PETSc.Comm, prefix: str, nodal: NodalVectors, tolerance: float, preconditioner: str
    ) -> None:
        self.nodal, self.incomplete = nodal, preconditioner == "ilu"
        self.right, self.way, self.diagonal = (nodal.vector() for _ in range(3))
        self.known = [(nodal.vector(), nodal.vector()) for _ in range(WAYS)]
        self.matrix, self.shifted = PETSc.Mat(), PETSc.Mat()
        self.ksp = self._made(comm, prefix, tolerance, preconditioner, nodal.shape[1])
        self.tolerance = self.ksp.getTolerances()[0]
        self._relaxes = self.ksp.getPC().getType() == "sor"
        options = PETSc.Options(prefix)
        self._fused = self._relaxes and not any(options.hasName(key) for key in ("ksp_type", "pc_type"))
        self._dear = DEAR * self.right.getSize() ** 0.5 if self._fused and comm.size == 1 else np.inf
        self._complete: PETSc.KSP | None = None
        self._make_complete = lambda: self._made(comm, prefix, tolerance, "cholesky", nodal.shape[1])
        _kernels.register_node_relaxation()
        self.begin()

    @property
    def blocks(self) -> bool:
        """Whether the next matrix may be of type BAIJ."""
        return self._relaxes and not self._complete

    def begin(self) -> None:
        """Forget what earlier solves have reported, so that the same row of solves gives the same bits."""
        self.iterations, self.filled, self._old = 0, 0, Tries(ahead=1)
        if self._complete:
            self._complete.destroy()
            self._complete, self.matrix = None, PETSc.Mat()

    def free(self) -> None:
        """Free PETSc's objects."""
        pairs = [part for pair in self.known for part in pair]
        for part in (self.ksp, self._complete, self.right, self.way, self.diagonal, self.shifted, *pairs):
            if part:
                part.destroy()

    def solve(self, matrix: PETSc.Mat, right: Reals) -> Reals | None:
        """The solution (n, f) with right side (n, f); None where none is found."""
        self.nodal.put(right, self.right)
        if self.matrix.handle != matrix.handle:
            self._take(matrix)
        goal, weights = self.tolerance * self.right.norm(), self._guess(matrix)
        for weight, (_, product) in zip(weights, self.known):
            self.right.axpy(-weight, product)
        # What the guess leaves is solved for: its residual is known from the products.
        if not (self._by_factor(matrix, goal) if self._complete else self._by_iteration(matrix, goal)):
            return None
        for weight, (way, _) in zip(weights, self.known):
            self.way.axpy(weight, way)
        self.known.insert(0, self.known.pop())
        self.way.copy(self.known[0][0])
        self.filled = min(self.filled + 1, WAYS)
        return self.nodal.values(self.way).copy()

    def _by_iteration(self, matrix: PETSc.Mat, goal: float) -> bool:
        """Set `way` to what solves for `right` but for a norm of `goal`; returns success."""
        self.ksp.setOperators(matrix, self._shifted(matrix) if self.incomplete else matrix)
        taken, solved = self._run(self.ksp, goal, MOST)
        if taken > self._dear:
            self._complete = self._make_complete()
        return solved

    def _by_factor(self, matrix: PETSc.Mat, goal: float) -> bool:
        """The same with a complete factor, of an earlier step while that serves."""
        assert self._complete is not None
        ksp, left_out = self._complete, self._old.left_out()
        ksp.setOperators(matrix)
        if not left_out:
            substitute_by_panels(ksp, single=True)
            ksp.getPC().setReusePreconditioner(True)
            solved = self._run(ksp, goal, KEPT)[1]
            ksp.getPC().setReusePreconditioner(False)
            self._old.count(solved)
            if solved:
                return True
            # It has a factor as it is: a new one is made where the matrix is set again.
            ksp.setOperators(matrix)
        return self._run(ksp, goal, MOST)[1]

    def _run(self, ksp: PETSc.KSP, goal: float, most: int) -> tuple[int, bool]:
        """Iterations of a solver, and whether it leaves no more than a norm of `goal`."""
        ksp.setTolerances(rtol=0.0, atol=goal, max_it=most)
        ksp.solve(self.right, self.way)
        taken = ksp.getIterationNumber()
        self.iterations += taken
        return taken, ksp.getConvergedReason() > 0

    def _take(self, matrix: PETSc.Mat) -> None:
        """Take in another matrix, whose pattern may be another one, of which nothing informs PETSc."""
        (self._complete or self.ksp).reset()
        # Held, so that no other matrix takes its place in memory.
        self.matrix = matrix
        if self._complete:
            self._old = Tries(ahead=1)
        elif self._fused:
            nodes = matrix.getType() == "seqbaij" and matrix.getBlockSize() == 3
            self.ksp.setType(_kernels.node_ssor if nodes else "cg")
        if self.incomplete:
            self.shifted.destroy()
            self.shifted = matrix.duplicate(copy=False)

    def _guess(self, matrix: PETSc.Mat) -> Reals:
        """The multiples of earlier solutions whose sum is the best guess; none where there are none."""
        known = self.known[: self.filled]
        for way, product in known:
            matrix.mult(way, product)
        gram = np.array([[way.dot(product) for _, product in known] for way, _ in known])
        use = np.flatnonzero(gram.diagonal() > 0.0) if known else ()
        weights = np.zeros(len(known))
        if len(use) and np.isfinite(gram).all():
            # Each as long as the other: ways may differ in size by much, and hardly in direction.
            size = np.sqrt(gram.diagonal()[use])
            load = np.array([known[k][0].dot(self.right) for k in use]) / size
            scaled = gram[np.ix_(use, use)] / np.outer(size, size)
            weights[use] = np.linalg.lstsq(scaled, load, rcond=ALIKE)[0] / size
        return weights

    def _shifted(self, matrix: PETSc.Mat) -> PETSc.Mat:
        """A copy of a matrix with a larger diagonal."""
        matrix.copy(self.shifted, PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
        matrix.getDiagonal(self.diagonal)
        self.diagonal.scale(1.0 + SHIFT)
        self.shifted.setDiagonal(self.diagonal)
        return self.shifted

    @staticmethod
    def _made(comm: PETSc.Comm, prefix: str, tolerance: float, preconditioner: str, nodes: int) -> PETSc.KSP:
        ksp = destroyed_at_exit(PETSc.KSP().create(comm))
        ksp.setOptionsPrefix(prefix)
        ksp.setType("cg")
        ksp.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
        ksp.setTolerances(rtol=tolerance, max_it=MOST)
        if preconditioner == "cholesky" and comm.size > 1:
            # With factors of the ranks' own rows alone steps would be others, and lead to other rests.
            set_shared_factor(ksp, nodes)
        else:
            set_preconditioner(ksp, preconditioner, 0)
        ksp.setFromOptions()
        return ksp
