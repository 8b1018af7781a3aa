"""What Newton's method solves: a residual with a tangent, and an energy where there is one."""

from typing import Protocol

from petsc4py import PETSc

from restshape.arrays import Reals


class Equations(Protocol):
    """r(x) = 0 for nodal values x (n, f); rows of other ranks need not be set.

    Attributes:
        potential: whether r is the gradient of an energy that is least at stable solutions; that of a saddle is not.
    """

    potential: bool

    def constrain(self, rows: Reals) -> None:
        """Set to 0 what is constrained of this rank's rows (k,) of a step."""

    @property
    def version(self) -> object:
        """Another one whenever r or its tangent may be others at the same x, or the matrix is overwritten."""

    def residual(self, x: Reals, out: Reals) -> None:
        """Set `out` (n, f) to r; 0 at constrained unknowns."""

    def assemble(self, x: Reals, out: Reals | None) -> PETSc.Mat:
        """The tangent dr/dx; sets `out` (n, f) to r in the same pass."""

    def energy(self, x: Reals) -> float:
        """The energy whose gradient is r, over all ranks."""
