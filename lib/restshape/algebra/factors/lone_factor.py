"""A complete factor of a symmetric matrix on one rank, whose pivots are counted."""

import math

from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.factors.interior_factor import has_mumps, interior_factor
from restshape.algebra.preconditioner import order_factor
from restshape.errors import ReplayProblem

LARGE = 10_000
"""Unknowns from which on a factor in blocks of a node and MUMPS's count of pivots take less time, together, than one of
single numbers: half of it at 13,000 unknowns of a bar of tetrahedra, a quarter at 30,000."""
NO_FACTOR = "the pencil of stiffness and mass has no factor at this shift"


class LoneFactor:
    """A complete factor of K - s M whose ordering and fill are kept for as long as the pattern stays.

    Args:
        blocks: of a node; else of single numbers.
    """

    def __init__(self, blocks: bool = False) -> None:
        self.blocks = blocks
        self.made, self.stale_pattern, self.nonzeros = False, True, 0.0
        self._matrix: PETSc.Mat = None
        self._pc: PETSc.PC = None
        self._panels = False

    def forget(self) -> None:
        """Let go of the factor."""
        for part in (self._pc, self._matrix):
            if part is not None:
                part.destroy()
        self.made, self.stale_pattern, self._matrix, self._pc = False, True, None, None
        self._panels = False

    def substitute_by_panels(self) -> None:
        """Substitute by panels, now and with factors to come of this pattern: worth making for more than one frame."""
        if not self._panels:
            _kernels.solve_by_panels(self._pc.getFactorMatrix().handle)
            self._panels = True

    def make(self, stiffness: PETSc.Mat, mass: PETSc.Mat, shift: float) -> int:
        """Factor; the number of negative pivots."""
        if self.stale_pattern:
            self.forget()
            self._matrix = stiffness.duplicate(copy=True)
            self._pc = PETSc.PC().create(PETSc.COMM_SELF)
            self._pc.setType("cholesky")
            # Counts of eigenvalues of thin bodies hang on pivots that blocks round more.
            order_factor(self._pc, self.blocks)
            self.stale_pattern = False
        else:
            stiffness.copy(self._matrix, structure=PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
        if shift:
            self._matrix.axpy(-shift, mass, structure=PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
        # An indefinite matrix under the name of a definite one would go to a factor without pivots to count.
        self._matrix.setOption(PETSc.Mat.Option.SPD, False)
        self._matrix.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        self._pc.setOperators(self._matrix)
        self._pc.setUp()
        factor = self._pc.getFactorMatrix()
        below, singular, _ = factor.getInertia()
        if singular or not self._answers():
            self.forget()
            raise ReplayProblem(NO_FACTOR)
        if self._panels:
            _kernels.solve_by_panels(factor.handle)
        self.nonzeros, self.made = factor.getInfo()["nz_used"], True
        return below

    def _answers(self) -> bool:
        """Whether the factor gives numbers: PETSc only notes a pivot that failed."""
        b, x = self._matrix.createVecs()
        b.set(1.0)
        self._pc.apply(b, x)
        finite = math.isfinite(x.norm())
        b.destroy()
        x.destroy()
        return finite

    def solve(self, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Forward and backward substitution."""
        self._pc.apply(b, x)


class CountedFactor(LoneFactor):
    """A complete factor of a large K - s M in blocks of a node, beside which MUMPS counts negative pivots.

    MUMPS exchanges rows, so that its counts are those of thin bodies, too. Its factor is not kept: substitutions with
    the one in blocks take less time.
    """

    def __init__(self) -> None:
        super().__init__(blocks=True)

    @staticmethod
    def serves(unknowns: int) -> bool:
        """Whether it takes less time than a factor of single numbers, of so many unknowns."""
        return unknowns >= LARGE and has_mumps()

    def make(self, stiffness: PETSc.Mat, mass: PETSc.Mat, shift: float) -> int:
        """Factor; the number of negative pivots, which none counts below 0, where the matrix is definite."""
        below = super().make(stiffness, mass, shift)
        return self._counted() if shift > 0.0 else below

    def _counted(self) -> int:
        counts = interior_factor(self._matrix.getSize()[0], 0)
        counts.make(self._matrix.getValuesCSR())
        below, failed = counts.negative, counts.singular or counts.too_large
        counts.destroy()
        if failed:
            self.forget()
            raise ReplayProblem(NO_FACTOR)
        return below
