"""What Newton's method solves: a residual with a tangent, and an energy where there is one."""

from typing import Protocol

import numpy as np
from petsc4py import PETSc


class Equations(Protocol):
    """r(x) = 0 for nodal values x (n, f); rows of other ranks need not be set.

    Attributes:
        potential: whether r is the gradient of an energy that is least at stable solutions; that of a saddle is not.
    """

    potential: bool

    @property
    def constrained(self) -> np.ndarray:
        """Unknowns, of all n f, that are constrained."""

    @property
    def version(self) -> object:
        """Another one whenever r or its tangent may be others at the same x, or the matrix is overwritten."""

    def residual(self, x: np.ndarray, out: np.ndarray) -> None:
        """Set `out` (n, f) to r; 0 at constrained unknowns."""

    def assemble(self, x: np.ndarray, out: np.ndarray | None) -> PETSc.Mat:
        """The tangent dr/dx; sets `out` (n, f) to r in the same pass."""

    def energy(self, x: np.ndarray) -> float:
        """The energy whose gradient is r, over all ranks."""
