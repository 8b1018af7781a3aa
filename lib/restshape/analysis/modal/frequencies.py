"""The lowest eigenfrequencies of a constrained structure, and how far frequencies are from others."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from petsc4py import PETSc

if TYPE_CHECKING:
    import scipy.sparse as sp

TOLERANCE = 1e-12


def lowest_modes(stiffness: sp.spmatrix, mass: sp.spmatrix, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Angular frequencies (count,) [rad/s], ascending, and modes (n, count) with phi^T M phi = 1.

    K phi = omega^2 M phi by SLEPc's Krylov-Schur method with shift-and-invert at 0, on each rank by itself.

    Args:
        stiffness, mass: (n, n) of the free unknowns, symmetric positive definite.
        count: how many.

    Source: docs/theory/solids.md.
    """
    # SLEPc finds PETSc's arguments already taken in; imported here, so that PETSc comes first.
    from slepc4py import SLEPc

    def matrix(csr: sp.spmatrix) -> PETSc.Mat:
        csr = csr.tocsr()
        return PETSc.Mat().createAIJ(csr.shape, csr=(csr.indptr, csr.indices, csr.data), comm=PETSc.COMM_SELF)

    eps = SLEPc.EPS().create(PETSc.COMM_SELF)
    eps.setOperators(matrix(stiffness), matrix(mass))
    eps.setProblemType(SLEPc.EPS.ProblemType.GHEP)
    eps.setType(SLEPc.EPS.Type.KRYLOVSCHUR)
    eps.setWhichEigenpairs(SLEPc.EPS.Which.TARGET_MAGNITUDE)
    eps.setTarget(0.0)
    transform = eps.getST()
    transform.setType(SLEPc.ST.Type.SINVERT)
    transform.getKSP().setType("preonly")
    transform.getKSP().getPC().setType("cholesky")
    eps.setDimensions(count)
    eps.setTolerances(TOLERANCE, 200)
    eps.solve()
    if eps.getConverged() < count:
        raise ArithmeticError(f"{eps.getConverged()} of {count} eigenvalues converged")
    pairs = []
    vector = eps.getOperators()[0].createVecRight()
    for k in range(count):
        value = eps.getEigenpair(k, vector).real
        phi = vector.getArray().copy()
        pairs.append((np.sqrt(value), phi / np.sqrt(phi @ (mass @ phi))))
    pairs.sort(key=lambda pair: pair[0])
    return np.array([omega for omega, _ in pairs]), np.column_stack([phi for _, phi in pairs])


def largest_difference(found: np.ndarray, reference: np.ndarray) -> float:
    """The largest difference of values (k,) from those of reference (m,) of the same rank, relative."""
    count = min(len(found), len(reference))
    return float(np.max(np.abs(found[:count] / reference[:count] - 1.0))) if count else float("nan")
