"""The pencil K + mu G of buckling: products, a factor that is kept, and how many critical load factors lie below mu."""

import numpy as np
from petsc4py import PETSc

from restshape.algebra.eigenproblems.krylov_schur import KeptFactor, solved_modes, vector_of
from restshape.algebra.eigenproblems.pencil import Pencil
from restshape.arrays import Reals

UNLOADED = -np.inf
"""The shift of the unloaded body: the factor is that of K alone."""


class LoadPencil(Pencil):
    """G and K of G phi = lambda K phi: `stiffness` is the geometric stiffness G, `mass` the stiffness K.

    K is positive definite, G is not definite. The lowest eigenvalues lambda = -1/mu, below 0, are those of the lowest
    positive load factors mu; a shift s < 0 stands for mu = -1/s, and its factor is that of K + mu G.
    """

    def factor(self, shift: float) -> int:
        """Factor K - G/shift as they stand, and keep it; the number of load factors between 0 and -1/shift."""
        with self.stages("factor"):
            below = self._kept.make(self.mass, self.stiffness, 1.0 / shift)
        self.factorisations += 1
        self.shift, self.nonzeros = shift, self._kept.nonzeros
        return below

    def below(self, shift: float) -> int:
        """The number of load factors between 0 and -1/shift, by a factor that is not kept (Sylvester)."""
        with self.stages("factor"):
            found = self._counting.make(self.mass, self.stiffness, 1.0 / shift)
        self.factorisations += 1
        return found


def load_modes(pencil: LoadPencil, start: Reals, count: int, tolerance: float) -> Reals:
    """Modes (count, n) of the lowest positive load factors, by SLEPc's Krylov-Schur method on K^-1 G.

    In the inner product of K this operator is symmetric; it is shift and invert about the load factor 0.

    Args:
        pencil: its factor is that of K as it stands.
        start: (n,) this rank's part of the first vector.
        count: wanted; there are as many.
        tolerance: of the residual, in SLEPc's norm.

    Raises:
        ReplayProblem: not all of them converge.

    Source: V. Hernandez, J. E. Roman, V. Vidal, ACM Trans. Math. Softw. 31 (2005) 351; docs/theory/buckling.md.
    """
    # SLEPc finds PETSc's arguments already taken in; imported here, so that PETSc comes first.
    from slepc4py import SLEPc

    eps = SLEPc.EPS().create(pencil.share.comm)
    eps.setOperators(pencil.stiffness, pencil.mass)
    eps.setProblemType(SLEPc.EPS.ProblemType.GHEP)
    eps.setType(SLEPc.EPS.Type.KRYLOVSCHUR)
    eps.setWhichEigenpairs(SLEPc.EPS.Which.SMALLEST_REAL)
    solver = eps.getST().getKSP()
    solver.setType("preonly")
    solver.getPC().setType(PETSc.PC.Type.PYTHON)
    solver.getPC().setPythonContext(KeptFactor(pencil))
    first = vector_of(start, pencil)
    eps.setInitialSpace([first])
    eps.setDimensions(count, max(2 * count, count + 12))
    eps.setTolerances(0.1 * tolerance, 300)
    modes = solved_modes(eps, pencil, count, "buckling: {} of {} load factors converged")
    for part in (first, eps):
        part.destroy()
    return modes
