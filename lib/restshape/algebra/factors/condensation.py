"""What stays of a linear system, condensed onto its border: a Schur complement, and what follows the border."""

from collections.abc import Callable
from weakref import finalize

import numpy as np
import scipy.sparse as sp
from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.factors.interior_factor import interior_factor
from restshape.algebra.preconditioner import order_factor
from restshape.arrays import Indices, Reals
from restshape.errors import ReplayProblem
from restshape.first_use import made

MOST_WAYS = 32
"""Directions of the border whose extensions are kept: a drag of one hand has fewer that matter."""
BEYOND = 0.9
"""Part of the forces that may be left, which is for what is in none of these directions."""
MOST_STEPS, STALLED = 16, 0.5
"""Steps of refinement at most, and what a step must make of what is left for another one to be worth it."""
ALL = slice(None)
NO_FACTOR = "the part of the body that stays has no factor: part of it is not constrained"


class Condensation:
    """A symmetric, positive definite matrix of unknowns inside, eliminated from those of their border.

    With K = (A C; C^T D), inside first, the border is left with the Schur complement D - C^T A^-1 C. Unknowns inside
    follow those of the border linearly. In a drag these go few ways: what they make of the inside is kept for each, and
    a substitution with the factor is done for ways alone that are new.

    Args:
        matrix: (n + m, n + m), both triangles, the m unknowns of the border last.
        border: m.
        fields: unknowns of a node inside, one after the other.

    Raises:
        ReplayProblem: A has no factor, or one that memory does not hold.

    Source: R. J. Guyan, AIAA J. 3 (1965) 380; docs/theory/substructures.md.
    """

    def __init__(self, matrix: sp.csr_matrix, border: int, fields: int) -> None:
        self.count, self.border = matrix.shape[0] - border, border
        own = matrix[self.count :, self.count :].toarray()
        self._beside = sp.csr_matrix(matrix[: self.count, self.count :])
        # Most unknowns inside have no cell in common with the border.
        self._next_to_border = self._beside[np.flatnonzero(np.diff(self._beside.indptr))]
        self._beside_back = sp.csr_matrix(self._beside.T)
        inside = matrix[: self.count, : self.count]
        local = sp.csr_matrix(sp.bmat([[inside, self._beside], [self._beside_back, None]]))
        local.sort_indices()
        factor = interior_factor(self.count, border)
        self.complement = own + factor.make((local.indptr, local.indices, local.data)) if self.count else own
        fails = factor.singular or factor.negative or not np.isfinite(self.complement).all()
        factor.destroy()
        if fails:
            raise ReplayProblem(NO_FACTOR)
        # That one makes the complement, this one substitutes in a third of its time.
        self._solver = NodeFactor(sp.csr_matrix(inside), fields) if self.count else None
        self._ways, self._extensions = np.empty((MOST_WAYS, border)), np.empty((0, 0))
        self._known, self._left = 0, np.zeros(MOST_WAYS)

    def alone(self, force: Reals) -> Reals:
        """The unknowns inside (n,) under forces (n,) there, while those of the border are 0."""
        if self._solver is None or not np.any(force):
            return np.zeros(self.count)
        found, left, before = self._solver(force), 0.0, np.inf
        while True:
            rest = force - self._solver.product(found)
            left = float(np.linalg.norm(rest))
            if not left < STALLED * before:
                return found
            before = left
            found += self._solver(rest)

    def on_border(self, alone: Reals) -> Reals:
        """What such unknowns inside (n,) take from the right side (m,) of the border."""
        return np.asarray(self._beside_back @ alone)

    def following(self, at_border: Reals, allowed: float, some: Indices | slice = ALL) -> Reals:
        """The unknowns inside (n,) that follow those of the border (m,), without forces.

        Args:
            at_border: of the border.
            allowed: the norm of the forces inside that may be left.
            some: those (k,) of them that are wanted; by default all.
        """
        if self._solver is None or not np.any(at_border):
            return np.zeros(self.count)[some]
        if self._beyond(at_border) > BEYOND * allowed:
            rest = self._split(at_border)[1]
            if self._known == MOST_WAYS:
                self._known, rest = 0, at_border
            self._learn(rest)
        weights = self._split(at_border)[0]
        self._refine(weights, (1.0 - BEYOND) * allowed)
        return weights @ self._extensions[: self._known, some]

    def left(self, at_border: Reals) -> float:
        """The norm of the forces inside that known ways leave of unknowns (m,) of the border, at most."""
        weights = self._split(at_border)[0]
        return self._beyond(at_border) + float(np.abs(weights) @ self._left[: self._known])

    def _beyond(self, at_border: Reals) -> float:
        """The same of what is in none of the ways."""
        return float(np.linalg.norm(self._next_to_border @ self._split(at_border)[1]))

    def _split(self, at_border: Reals) -> tuple[Reals, Reals]:
        """The weights (k,) of the known ways in unknowns (m,), and what they leave."""
        ways = self._ways[: self._known]
        weights = ways @ at_border
        rest = at_border - weights @ ways
        # Once more, for what is left may be small.
        again = ways @ rest
        return weights + again, rest - again @ ways

    def _learn(self, way: Reals) -> None:
        """Keep what one more way makes of the inside."""
        if not self._extensions.size:
            self._extensions = np.zeros((MOST_WAYS, self.count))
        k = self._known
        self._ways[k] = way / np.linalg.norm(way)
        self._extensions[k] = 0.0
        self._known += 1
        self._step(k)

    def _refine(self, weights: Reals, allowed: float) -> None:
        """Solve again for what ways with such weights (k,) leave inside, those that leave most first."""
        for _ in range(MOST_STEPS):
            left = np.abs(weights) * self._left[: self._known]
            if left.sum() <= allowed:
                return
            k = int(left.argmax())
            before = self._left[k]
            self._step(k)
            if not self._left[k] < STALLED * before:
                return

    def _step(self, k: int) -> None:
        """Take a step of refinement with a way's extension."""
        solver, extension = made(self._solver), self._extensions[k]
        extension -= solver(self._force_of(k))
        self._left[k] = np.linalg.norm(self._force_of(k))

    def _force_of(self, k: int) -> Reals:
        """The forces inside (n,) that a way and its extension leave."""
        pull = self._beside @ self._ways[k]
        return pull + made(self._solver).product(self._extensions[k]) if self._extensions[k].any() else pull


def _free(pc: PETSc.PC, matrix: PETSc.Mat) -> None:
    pc.destroy()
    matrix.destroy()


class NodeFactor:
    """A complete Cholesky factor in blocks of a node, which substitutes by panels of single precision.

    Args:
        matrix: (n, n) symmetric and positive definite.
        fields: unknowns of a node, one after the other.
    """

    def __init__(self, matrix: sp.csr_matrix, fields: int) -> None:
        csr = matrix.indptr, matrix.indices, matrix.data
        self._matrix = PETSc.Mat().createAIJ(matrix.shape, bsize=fields, csr=csr, comm=PETSc.COMM_SELF)
        self._matrix.setOption(PETSc.Mat.Option.SPD, True)
        self._pc = PETSc.PC().create(PETSc.COMM_SELF)
        self._pc.setType("cholesky")
        order_factor(self._pc)
        self._pc.setOperators(self._matrix)
        self._pc.setUp()
        _kernels.solve_by_panels(self._pc.getFactorMatrix().handle, True)
        # A press makes one, and petsc4py only collects what is let go of.
        finalize(self, _free, self._pc, self._matrix).atexit = False

    def __call__(self, force: Reals) -> Reals:
        """About the solution (n,) of a right side (n,)."""
        return self._applied(self._pc.apply, force)

    def product(self, x: Reals) -> Reals:
        """The product (n,) of the matrix with x (n,)."""
        return self._applied(self._matrix.mult, x)

    @staticmethod
    def _applied(function: Callable[[PETSc.Vec, PETSc.Vec], None], given: Reals) -> Reals:
        found = np.empty_like(given)
        b, x = (PETSc.Vec().createWithArray(array, comm=PETSc.COMM_SELF) for array in (given, found))
        function(b, x)
        for vector in (b, x):
            vector.destroy()
        return found
