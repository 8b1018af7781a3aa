"""The sum of integrals as a function of nodal unknowns: its residual, tangent, products and energy."""

from collections.abc import Iterable, Sequence

import numpy as np
from petsc4py import PETSc

from restshape.algebra.operator import Operator
from restshape.fem.integral import Term


class Assembled:
    """A sum of integrals over spaces that share their nodes.

    Args:
        integrals: what is summed, in this order.
        operator: holds the pattern of their blocks; None where no matrix is wanted.
    """

    def __init__(self, integrals: Iterable[Term], operator: Operator | None = None) -> None:
        self.integrals: Sequence[Term] = tuple(integrals)
        self._operator = operator

    @property
    def operator(self) -> Operator:
        """What holds the pattern.

        Raises:
            ValueError: there is none.
        """
        if self._operator is None:
            raise ValueError("a sum without an operator has no matrix")
        return self._operator

    def residual(self, x: np.ndarray, out: np.ndarray | None = None, subset: np.ndarray | None = None) -> np.ndarray:
        """The residual (n, f) at x (n, f), added to `out` where it is given.

        Args:
            x: unknowns.
            out: is changed and returned.
            subset: (k,) int32 cells of the first block that count; the other blocks count whole.
        """
        out = np.zeros(x.shape) if out is None else out
        for integral in self.integrals:
            integral.add_residual(x, out, subset if integral.block == 0 else None)
        return out

    def tangent(self, x: np.ndarray, right_side: np.ndarray | None = None, kept: bool = False) -> PETSc.Mat:
        """The tangent at x (n, f); the residual is added to `right_side` (n, f) in the same pass where it is given.

        With `kept` the tangent contains that of the sum of which `keep` was called last.
        """
        terms = [integral.term(x, 1.0, -1.0) for integral in self.integrals]
        return self.operator.assemble(terms, None if right_side is None else right_side.ravel(), kept)

    def keep(self, x: np.ndarray) -> None:
        """Let the operator keep the tangent at x (n, f), for other sums with the same operator to start from."""
        self.operator.keep([integral.term(x) for integral in self.integrals])

    def system(self, x: np.ndarray, right_side: np.ndarray) -> PETSc.Mat:
        """The tangent at x (n, f); `right_side` (n, f) loses the residual there in the same pass."""
        return self.operator.assemble([integral.term(x) for integral in self.integrals], right_side.ravel())

    def tangent_product(self, x: np.ndarray, d: np.ndarray) -> np.ndarray:
        """The product (n, f) of the tangent at x (n, f) with d (n, f), without a matrix."""
        out, d = np.zeros_like(x), np.ascontiguousarray(d)
        for integral in self.integrals:
            integral.add_tangent_product(x, d, out)
        return out

    def design_product(self, x: np.ndarray, dX: np.ndarray, dx: np.ndarray | None = None) -> np.ndarray:
        """The rate (n, f) of the residual when material coordinates change with dX (n, d), and x with dx (n, f)."""
        out = np.zeros_like(x)
        for integral in self.integrals:
            integral.add_design_product(x, dX, out, dx)
        return out

    def energy(self, x: np.ndarray) -> float:
        """The energy at x (n, f), whose gradient is the residual."""
        return float(sum(integral.energies(x).sum() for integral in self.integrals))
