"""Eigenpairs from nothing: SLEPc's Krylov-Schur method with shift-and-invert on a factor that the caller keeps."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from petsc4py import PETSc

from restshape.algebra.eigenproblems.davidson import Found
from restshape.algebra.eigenproblems.pencil import Deflation, Pencil
from restshape.arrays import Reals
from restshape.errors import ReplayProblem

if TYPE_CHECKING:
    from slepc4py import SLEPc

ROOM = 12
"""Vectors of the basis beyond the wanted ones, at least, from nothing."""


class KeptFactor:
    """A preconditioner for SLEPc that is the pencil's factor: SLEPc's own would be rebuilt for each solve."""

    def __init__(self, pencil: Pencil) -> None:
        self.pencil = pencil

    def apply(self, _pc: PETSc.PC, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Forward and backward substitution."""
        self.pencil.solve_vector(b, x)


def krylov_schur(
    pencil: Pencil,
    deflation: Deflation,
    start: Reals | None,
    count: int,
    tolerance: float,
    room: int | None = None,
) -> Found:
    """The `count` eigenpairs of (K, M) nearest to the shift of the pencil's factor, ascending.

    Args:
        pencil: its factor is of K and M as they stand.
        deflation: the rigid motions, which are given to SLEPc as deflation space.
        start: (n,) a vector with a share of each mode that is wanted, such as the sum of those of the last frame; this
            rank's part of it.
        count: wanted.
        tolerance: of the residual |K phi - lambda M phi| relative to |lambda M phi|.
        room: vectors of its basis beyond the wanted ones; by default as many as a start from nothing wants.

    Raises:
        ReplayProblem: not all of them converge.

    Source: V. Hernandez, J. E. Roman, V. Vidal, ACM Trans. Math. Softw. 31 (2005) 351; docs/theory/free-vibrations.md.
    """
    # SLEPc finds PETSc's arguments already taken in; imported here, so that PETSc comes first.
    from slepc4py import SLEPc

    before, share = pencil.substitutions, pencil.share
    eps = SLEPc.EPS().create(share.comm)
    eps.setOperators(pencil.stiffness, pencil.mass)
    eps.setProblemType(SLEPc.EPS.ProblemType.GHEP)
    eps.setType(SLEPc.EPS.Type.KRYLOVSCHUR)
    eps.setWhichEigenpairs(SLEPc.EPS.Which.TARGET_MAGNITUDE)
    eps.setTarget(pencil.shift)
    transform = eps.getST()
    transform.setType(SLEPc.ST.Type.SINVERT)
    solver = transform.getKSP()
    solver.setType("preonly")
    solver.getPC().setType(PETSc.PC.Type.PYTHON)
    solver.getPC().setPythonContext(KeptFactor(pencil))
    vectors = [vector_of(row, pencil) for row in deflation.rigid]
    eps.setDeflationSpace(vectors)
    if start is not None:
        first = vector_of(start, pencil)
        eps.setInitialSpace([first])
        vectors.append(first)
    eps.setDimensions(count, count + (max(count, ROOM) if room is None else room))
    # SLEPc measures the residual of the inverted problem.
    eps.setTolerances(0.1 * tolerance, 300)
    modes = solved_modes(eps, pencil, count, "the eigenproblem did not converge: {} of {} modes")
    for part in (*vectors, eps):
        part.destroy()
    return refine_ritz(pencil, deflation, modes, count, tolerance, pencil.substitutions - before)


def vector_of(row: Reals, pencil: Pencil) -> PETSc.Vec:
    """PETSc's vector of a copy of this rank's part (n,) of one."""
    share = pencil.share
    return PETSc.Vec().createWithArray(np.array(row), size=(share.count, share.size), comm=share.comm)


def solved_modes(eps: SLEPc.EPS, pencil: Pencil, count: int, problem: str) -> Reals:
    """This rank's columns of the first modes (count, n) that SLEPc finds; more may converge.

    Args:
        eps: SLEPc's solver, set up; pencil: its matrices.
        count: wanted; problem: words with places for how many have converged, and for `count`.

    Raises:
        ReplayProblem: not all of them converge.
    """
    eps.solve()
    converged = eps.getConverged()
    if converged < count:
        raise ReplayProblem(problem.format(converged, count))
    modes, vector = np.empty((count, pencil.share.count)), pencil.stiffness.createVecRight()
    for k in range(count):
        eps.getEigenpair(k, vector)
        modes[k] = vector.getArray()
    vector.destroy()
    return modes


def refine_ritz(
    pencil: Pencil, deflation: Deflation, modes: Reals, count: int, tolerance: float, iterations: int
) -> Found:
    """The Ritz pairs of K and M over rows (k, n), with their true residuals, `count` of which must be small."""
    rows, share = np.array(modes), pencil.share
    deflation.clean(rows)
    mass_products, stiff = np.empty_like(rows), np.empty_like(rows)
    pencil.apply(pencil.mass, rows, mass_products)
    pencil.apply(pencil.stiffness, rows, stiff)
    factor = np.linalg.cholesky(share.summed(rows @ mass_products.T))
    small = np.linalg.solve(factor, np.linalg.solve(factor, share.summed(rows @ stiff.T)).T)
    values, weights = np.linalg.eigh(0.5 * (small + small.T))
    turn = np.linalg.solve(factor.T, weights).T
    rows, mass_products, stiff = turn @ rows, turn @ mass_products, turn @ stiff
    residuals = share.norms(stiff - values[:, None] * mass_products)
    residuals /= np.abs(values) * share.norms(mass_products)
    return Found(values, rows, residuals, iterations, bool(np.all(residuals[:count] <= tolerance)))
