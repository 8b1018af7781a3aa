"""The tangent of equations, and the place where it was assembled."""

from petsc4py import PETSc

from restshape.algebra.nonlinear.equations import Equations
from restshape.arrays import Reals


class Tangent:
    """One matrix of equations, assembled again when the equations or the unknowns are others.

    Args:
        equations: whose `version` shows when they are others.

    Attributes:
        mat: the matrix; None before it is first assembled.
    """

    def __init__(self, equations: Equations) -> None:
        self.equations = equations
        self.mat: PETSc.Mat = None
        self._version: object = None
        self._x: Reals | None = None

    def assemble(self, x: Reals, out: Reals | None) -> PETSc.Mat:
        """The tangent at x (n, f); sets `out` (n, f) to the residual in the same pass."""
        self.mat = self.equations.assemble(x, out)
        self._version, self._x = self.equations.version, x.copy()
        return self.mat

    def is_at(self, x: Reals) -> bool:
        """Whether the matrix is the tangent at x (n, f)."""
        return self._x is not None and self._version == self.equations.version and bool((self._x == x).all())

    def at(self, x: Reals) -> PETSc.Mat:
        """The tangent at x (n, f), assembled where the matrix is another one."""
        return self.mat if self.is_at(x) else self.assemble(x, None)

    def shift(self, value: float) -> None:
        """Add a value to the diagonal; the matrix is no tangent any more."""
        self._x = None
        self.mat.shift(value)
