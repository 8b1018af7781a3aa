"""Factors in blocks of nodes of what ranks share of a matrix: of a rank's inside, and of the border between ranks.

They exchange no rows, and take a quarter of the time of those that do.
"""

import numpy as np
from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.factors.rank_border import Csr
from restshape.algebra.preconditioner import apply_to, free, order_factor
from restshape.arrays import Indices, Reals


class BorderedFactor:
    """A Cholesky factor of a sequential matrix, in blocks of nodes, whose pattern is kept.

    Args:
        border: last unknowns, whole nodes, that it keeps: they are no pivots, and are 0 in solutions.
        fields: unknowns of a node, where there is a border.

    Attributes:
        negative: pivots; singular: whether one is zero; nonzeros: of the factor.
    """

    def __init__(self, border: int = 0, fields: int = 0) -> None:
        self.border, self.fields = border, fields
        self.negative, self.singular, self.nonzeros = 0, False, 0.0
        self._values = np.empty(0)
        self._matrix: PETSc.Mat = None
        self._pc: PETSc.PC = None

    def make(self, csr: Csr) -> None:
        """Factor a matrix (n, n), of the pattern of before, whose arrays are kept: no copy is made of the first one."""
        if self._pc is None:
            size = len(csr[0]) - 1
            self._values = csr[2]
            self._begin(PETSc.Mat().createAIJWithArrays((size, size), csr, comm=PETSc.COMM_SELF))
        else:
            if csr[2] is not self._values:
                self._values[:] = csr[2]
            self._matrix.stateIncrease()
            self._pc.setOperators(self._matrix)
        self._pc.setUp()
        self._count()

    def make_inside(self, mat: PETSc.Mat, number: Indices) -> None:
        """Factor this rank's rows inside of a matrix that ranks share, and their border, without a copy of them.

        Args:
            mat: of the pattern of before; number: as of `RankBorder`.
        """
        if self._pc is None:
            size = int(number.max(initial=-1)) + 1
            self._begin(PETSc.Mat().createAIJ((size, size), nnz=0, comm=PETSc.COMM_SELF))
        _kernels.factor_shared_rows(self._pc.getFactorMatrix().handle, mat.handle, number)
        self._count()

    def _begin(self, matrix: PETSc.Mat) -> None:
        """Take up a matrix, whose factor is of its size."""
        self._matrix = matrix
        matrix.assemble()
        self._pc = PETSc.PC().create(PETSc.COMM_SELF)
        self._pc.setType("cholesky")
        order_factor(self._pc)
        self._pc.setOperators(matrix)
        self._pc.setFactorSetUpSolverType()
        _kernels.keep_border(self._pc.getFactorMatrix().handle, self.border, self.fields)

    def _count(self) -> None:
        factor = self._pc.getFactorMatrix()
        self.negative, zero, _ = factor.getInertia()
        self.singular = zero > 0
        self.nonzeros = factor.getInfo()["nz_used"]

    def complement(self) -> Reals:
        """The Schur complement (border, border) of what it keeps."""
        out = np.empty(2 * (self.border,))
        if self.border:
            _kernels.border_complement(self._pc.getFactorMatrix().handle, out)
        return out

    def substitute_by_panels(self, single: bool) -> None:
        """Substitute by panels, in `single` precision or in double."""
        if self._pc is not None:
            _kernels.solve_by_panels(self._pc.getFactorMatrix().handle, single)

    def solve(self, right: Reals) -> Reals:
        """The solution (n,) with right side (n,)."""
        found = np.zeros_like(right)
        apply_to(self._pc, right, found)
        return found

    def eliminate(self, inside: Reals) -> Reals:
        """What equations of the border (border,) have on their right without the unknowns before it (n,)."""
        out = np.empty(self.border)
        _kernels.eliminate_inside(self._pc.getFactorMatrix().handle, inside, out)
        return out

    def complete(self, border: Reals, count: int) -> Reals:
        """The unknowns (count,) before the border after `eliminate`, from those of the border."""
        out = np.empty(count)
        _kernels.complete_inside(self._pc.getFactorMatrix().handle, border, out)
        return out

    def destroy(self) -> None:
        """Free it."""
        free(self._pc, self._matrix)
        self._matrix = self._pc = None
        self._values = np.empty(0)


class NodeInterior:
    """A factor in blocks of nodes of what a rank has inside, whose rows inside and on the border are whole nodes.

    Args:
        border: unknowns of the border; nodes: unknowns of a node.

    Attributes:
        negative: pivots; singular: whether one is zero; nonzeros: of the factor; too_large: never.
        factor: of both.
    """

    too_large = False

    def __init__(self, border: int, nodes: int) -> None:
        self.negative, self.singular, self.nonzeros = 0, False, 0.0
        self.factor = BorderedFactor(border, nodes)

    def make(self, mat: PETSc.Mat, number: Indices) -> Reals:
        """Factor values on the pattern of before; the Schur complement (m, m) of the border, whose own block is 0.

        Args:
            mat: whose rows ranks share; number: as of `RankBorder`.
        """
        self.factor.make_inside(mat, number)
        self.negative, self.singular, self.nonzeros = (
            self.factor.negative,
            self.factor.singular,
            self.factor.nonzeros,
        )
        return self.factor.complement()

    def destroy(self) -> None:
        """Free it."""
        self.factor.destroy()


class DenseBorder:
    """The dense factor of the border's complement (m, m), by `BorderedFactor`.

    Attributes:
        negative: pivots; factor: of it.
    """

    def __init__(self) -> None:
        self.negative, self.factor, self._size = 0, BorderedFactor(), 0
        # What is counted of a factor is what all ranks do; this is done by one of them.
        self._stage = PETSc.Log.Stage("border of ranks")

    def make(self, complement: Reals) -> bool:
        """Factor; whether a pivot is zero."""
        size = len(complement)
        if size != self._size:
            self.destroy()
            self.factor, self._size = BorderedFactor(), size
        if not size:
            self.negative = 0
            return False
        columns = np.tile(np.arange(size, dtype=PETSc.IntType), size)
        starts = np.arange(0, size * size + 1, size, dtype=PETSc.IntType)
        with self._stage:
            self.factor.make((starts, columns, complement.ravel()))
        self.negative = self.factor.negative
        return self.factor.singular

    def solve(self, right: Reals) -> Reals:
        """The solutions (k, m) with right sides (k, m)."""
        with self._stage:
            found = [self.factor.solve(row) for row in np.ascontiguousarray(right)]
        return np.array(found).reshape(right.shape)

    def destroy(self) -> None:
        """Free it."""
        self.factor.destroy()
