"""Whole matrices and vectors from the ranks' rows of them, and the end of those that nobody needs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from petsc4py import PETSc

from restshape.algebra.preconditioner import order_factor
from restshape.arrays import Reals

if TYPE_CHECKING:
    import scipy.sparse as sp


def clean_up(comm: PETSc.Comm) -> None:
    """Free the matrices, vectors and solvers that Python has let go of; collective.

    petsc4py only collects them, for Python does not let go at the same moment on all ranks.
    """
    PETSc.garbage_cleanup(comm)
    PETSc.garbage_cleanup(PETSc.COMM_SELF)


@dataclass
class GatheredSystem:
    """A whole linear system's matrix (n, n) and solution (n,).

    Args:
        energy: strain energy [J] of the displacement that the solution is part of; None: that of the solution alone.
    """

    matrix: sp.csr_matrix
    solution: Reals
    energy: float | None = None


def gather_vector(full: Reals, rows: slice, comm: PETSc.Comm) -> Reals:
    """Fill an array (n,) of which each rank has set its own rows; returns it."""
    if comm.size > 1:
        world = comm.tompi4py()
        counts = world.allgather(rows.stop - rows.start)
        world.Allgatherv(full[rows].copy(), [full, counts])
    return full


def gather_matrix(mat: PETSc.Mat, comm: PETSc.Comm) -> sp.csr_matrix:
    """A copy of a PETSc matrix (n, n), whole on every rank."""
    import scipy.sparse as sp

    indptr, indices, values = (np.array(part) for part in mat.getValuesCSR())
    n = mat.getSize()[1]
    own = sp.csr_matrix((values, indices, indptr), shape=(len(indptr) - 1, n))
    parts = comm.tompi4py().allgather(own) if comm.size > 1 else [own]
    return sp.vstack(parts, format="csr")


def whole_cholesky(mat: PETSc.Mat, comm: PETSc.Comm) -> tuple[PETSc.Mat, PETSc.PC]:
    """A PETSc matrix (n, n) whole on each rank, and a complete Cholesky factor of it; both are to be destroyed."""
    whole = gather_matrix(mat, comm)
    matrix = PETSc.Mat().createAIJ(whole.shape, csr=(whole.indptr, whole.indices, whole.data), comm=PETSc.COMM_SELF)
    pc = PETSc.PC().create(PETSc.COMM_SELF)
    pc.setType("cholesky")
    order_factor(pc)
    pc.setOperators(matrix)
    pc.setUp()
    return matrix, pc


def matrix_difference(a: sp.csr_matrix, b: sp.csr_matrix) -> float:
    """The largest difference of two matrices' entries over the largest entry."""
    scale = abs(b).max()
    return float(abs(a - b).max() / scale) if scale else float(abs(a).max())
