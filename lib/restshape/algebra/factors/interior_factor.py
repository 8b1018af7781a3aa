"""A complete factor of what a rank alone has of a symmetric matrix, and what it leaves for the border with others."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Protocol

import numpy as np
from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.factors.rank_border import Csr
from restshape.algebra.preconditioner import apply_to, free, order_factor
from restshape.arrays import Reals

if TYPE_CHECKING:
    import scipy.sparse as sp

SPACES = 60, 240, 960
"""Percent of memory beyond its estimate that MUMPS takes before it gives up, one after the other: it exchanges rows."""

NO_SPACE = -8, -9
"""What MUMPS ends with where this is not enough."""

NO_MEMORY = *NO_SPACE, -5, -7, -13, -19
"""What it ends with where there is not enough memory."""

AT_ONCE = 64
"""Unknowns of the border for which PETSc's own factor substitutes at once: each takes a row as long as the inside."""


class InteriorFactor(Protocol):
    """A factor of the first n unknowns of a symmetric matrix (n + m, n + m) whose last ones are the border.

    Attributes:
        negative: pivots; singular: whether there is no factor, too_large: for want of memory; nonzeros: of the factor.
    """

    negative: int
    singular: bool
    too_large: bool
    nonzeros: float

    def make(self, local: Csr) -> Reals:
        """Factor values on the pattern of before; the Schur complement (m, m) of the border, whose own block is not
        read."""

    def solve(self, rows: Reals) -> Reals:
        """The inverse of the first block times each row (k, n)."""

    def destroy(self) -> None:
        """Free it."""


@cache
def has_mumps() -> bool:
    """Whether PETSc has been built with MUMPS."""
    one = PETSc.Mat().createAIJ((1, 1), nnz=1, comm=PETSc.COMM_SELF)
    one.setValue(0, 0, 1.0)
    one.assemble()
    pc = PETSc.PC().create(PETSc.COMM_SELF)
    try:
        pc.setType("cholesky")
        pc.setFactorSolverType("mumps")
        pc.setOperators(one)
        pc.setFactorSetUpSolverType()
    except PETSc.Error:
        return False
    finally:
        pc.destroy()
        one.destroy()
    return True


def interior_factor(count: int, border: int) -> InteriorFactor:
    """What factors `count` unknowns beside a `border` of so many: MUMPS, or PETSc where that is missing."""
    return MumpsInterior(count, border) if has_mumps() else PlainInterior(count, border)


def first_rows(local: Csr, count: int) -> tuple[sp.csr_matrix, sp.csr_matrix]:
    """The first rows of a matrix: their own block, and the columns behind it."""
    # Factors in blocks of nodes do without SciPy, whose sparse matrices take 0.07 s to load, and 20 MB of each rank.
    import scipy.sparse as sp

    starts, columns, values = local
    whole = sp.csr_matrix((values, columns, starts), 2 * (len(starts) - 1,))
    return whole[:count, :count], whole[:count, count:]


class MumpsInterior:
    """By MUMPS on this rank alone, which keeps its bits, exchanges rows and forms the Schur complement on the way.

    Args:
        count: unknowns inside; border: of the border.
    """

    def __init__(self, count: int, border: int) -> None:
        self.count, self.border = count, border
        self.negative, self.singular, self.too_large, self.nonzeros = 0, False, False, 0.0
        self._matrix: PETSc.Mat = None
        self._factor: PETSc.Mat = None
        self._pc: PETSc.PC = None

    def make(self, local: Csr) -> Reals:
        """Factor values on the pattern of before; see `InteriorFactor`."""
        status = self._set_up(local, SPACES[0])
        for space in SPACES[1:]:
            if status in NO_SPACE:
                # PETSc takes up no factor again that has ended.
                self.destroy()
                status = self._set_up(local, space)
        self.too_large = status in NO_MEMORY
        self.singular = status < 0 or self._factor.getMumpsInfog(28) > 0
        self.negative = self._factor.getMumpsInfog(12)
        entries = self._factor.getMumpsInfog(29)
        self.nonzeros = float(entries if entries >= 0 else -1_000_000 * entries)
        schur = np.zeros((self.border, self.border))
        if self.border and not self.singular:
            _kernels.schur_complement(self._factor.handle, schur)
        return schur

    def _set_up(self, local: Csr, space: int) -> int:
        """Factor, with so many percent of memory more where it is the first time; how MUMPS ends."""
        if self._pc is None:
            self._begin(local, space)
        else:
            self._matrix.setValuesCSR(*local)
            self._matrix.assemble()
        self._pc.setUp()
        # Solves are of the inside alone; the analysis of the pattern has set it otherwise.
        self._factor.setMumpsIcntl(26, 0)
        return int(self._factor.getMumpsInfog(1))

    def _begin(self, local: Csr, space: int) -> None:
        size = self.count + self.border
        self._matrix = PETSc.Mat().createAIJ((size, size), csr=local, comm=PETSc.COMM_SELF)
        self._matrix.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        self._pc = PETSc.PC().create(PETSc.COMM_SELF)
        self._pc.setType("cholesky")
        self._pc.setFactorSolverType("mumps")
        self._pc.setOperators(self._matrix)
        self._pc.setFactorSetUpSolverType()
        self._factor = self._pc.getFactorMatrix()
        if self.border:
            rows = np.arange(self.count, self.count + self.border, dtype=np.int32)
            _kernels.set_schur_rows(self._factor.handle, rows)
        # Pivots that are zero are found, and count as neither sign.
        self._factor.setMumpsIcntl(24, 1)
        self._factor.setMumpsIcntl(14, space)

    def solve(self, rows: Reals) -> Reals:
        """The inverse of the first block times each row (k, n)."""
        size = self.count + self.border
        right, found = np.zeros((len(rows), size)), np.zeros((len(rows), size))
        right[:, : self.count] = rows
        if len(rows) == 1:
            b, x = (PETSc.Vec().createWithArray(one[0], comm=PETSc.COMM_SELF) for one in (right, found))
            self._factor.solve(b, x)
        else:
            shape = (size, len(rows))
            b, x = (PETSc.Mat().createDense(shape, array=one.T, comm=PETSc.COMM_SELF) for one in (right, found))
            b.assemble()
            x.assemble()
            self._factor.matSolve(b, x)
        for part in (b, x):
            part.destroy()
        return np.ascontiguousarray(found[:, : self.count])

    def destroy(self) -> None:
        """Free it."""
        free(self._factor, self._pc, self._matrix)
        self._matrix = self._pc = self._factor = None


class PlainInterior:
    """By PETSc's own factor, and the Schur complement by a substitution for each unknown of the border.

    Args:
        count: unknowns inside; border: of the border.
    """

    def __init__(self, count: int, border: int) -> None:
        self.count, self.border = count, border
        self.negative, self.singular, self.too_large, self.nonzeros = 0, False, False, 0.0
        self._matrix: PETSc.Mat = None
        self._pc: PETSc.PC = None

    def make(self, local: Csr) -> Reals:
        """Factor values on the pattern of before; see `InteriorFactor`."""
        inside, beside = first_rows(local, self.count)
        csr = (inside.indptr, inside.indices, inside.data)
        if self._pc is None:
            self._matrix = PETSc.Mat().createAIJ(inside.shape, csr=csr, comm=PETSc.COMM_SELF)
            self._pc = PETSc.PC().create(PETSc.COMM_SELF)
            self._pc.setType("cholesky")
            order_factor(self._pc, False)
        else:
            self._matrix.setValuesCSR(*csr)
            self._matrix.assemble()
        self._matrix.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        self._pc.setOperators(self._matrix)
        self._pc.setUp()
        factor = self._pc.getFactorMatrix()
        self.negative, zero, _ = factor.getInertia()
        self.nonzeros = factor.getInfo()["nz_used"]
        schur, columns = np.zeros(2 * (self.border,)), beside.T.tocsr()
        for first in range(0, self.border, AT_ONCE):
            part = slice(first, first + AT_ONCE)
            schur[:, part] -= columns @ self.solve(columns[part].toarray()).T
        # PETSc only notes a pivot that failed.
        self.singular = zero > 0 or not np.isfinite(self.solve(np.ones((1, self.count)))).all()
        return schur

    def solve(self, rows: Reals) -> Reals:
        """The inverse of the first block times each row (k, n)."""
        found = np.empty_like(rows)
        for row, out in zip(rows, found):
            apply_to(self._pc, row, out)
        return found

    def destroy(self) -> None:
        """Free it."""
        free(self._pc, self._matrix)
        self._matrix = self._pc = None
