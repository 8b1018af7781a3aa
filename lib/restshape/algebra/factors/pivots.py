"""Pivots of complete factors: how many eigenvalues of their matrix are negative, and whether one is zero."""

import numpy as np
from petsc4py import PETSc

from restshape import _kernels


def factors_of(ksp: PETSc.KSP) -> list[PETSc.PC]:
    """What has this rank's factors."""
    pc = ksp.getPC()
    return [part.getPC() for part in pc.getASMSubKSP()] if pc.getType() == "asm" else [pc]


def negative_pivots(factor: PETSc.Mat, kind: str) -> int:
    """The negative pivots of a complete factor, `cholesky` or `lu`."""
    if kind == "cholesky":
        return factor.getInertia()[0] if _counts(factor) else 0
    if factor.getType() != "seqaij":
        # Other solvers' LU factors exchange rows, and show no pivots.
        return 0
    # PETSc's own exchanges no rows, and its diagonal is that of U.
    pivots = factor.getDiagonal()
    found = int(np.count_nonzero(pivots.getArray(readonly=True) < 0.0))
    pivots.destroy()
    return found


def _counts(factor: PETSc.Mat) -> bool:
    """Whether a Cholesky factor reports its pivots: other libraries' do not, nor one that has ended at a zero."""
    return factor.getType() == _kernels.node_blocks or (factor.getType() == "seqsbaij" and factor.isAssembled())


def zero_pivots(factor: PETSc.Mat, kind: str) -> int:
    """Pivots that a factor of PETSc's own has none of, as it ended at one that is zero; 0 of other libraries' factors.

    Of an LU factor, complete or not, and of a Cholesky factor of single numbers at most one: it does not go on.
    """
    if kind == "cholesky" and _counts(factor):
        return factor.getInertia()[1]
    return int(kind in ("cholesky", "lu", "ilu") and _kernels.ended_at_zero(factor.handle))
