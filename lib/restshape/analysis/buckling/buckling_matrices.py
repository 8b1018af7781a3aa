"""Stiffness and geometric stiffness of a static solid, on patterns that are kept from frame to frame."""

import numpy as np
from petsc4py import PETSc

from restshape.algebra.factors.row_share import RowShare
from restshape.algebra.operator import Operator
from restshape.analysis.static.steady import SteadyState
from restshape.fem.assembled import Assembled
from restshape.fem.problem import STIFFNESS, PrestressedProblem, SteadyProblem


class BucklingMatrices:
    """G of one mesh, whose rows ranks share as they do those of K, which is that of the equilibrium.

    Args:
        comm: PETSc communicator.
        problem: on the mesh.
        backend: of the operator.

    Attributes:
        share: the unknowns that this rank owns.
    """

    def __init__(self, comm: PETSc.Comm, problem: SteadyProblem, backend: str | None) -> None:
        mask = problem.boundary.mask
        self.operator = Operator(comm, mask.shape[1], problem.space.node_offsets, backend, symmetric=False)
        self.operator.set_topology([problem.space.cells], mask)
        self.share = RowShare(comm, self.operator.rows, mask.size)

    @property
    def geometric(self) -> PETSc.Mat:
        """G as it was assembled last."""
        return self.operator.mat

    def set_constraints(self, mask: np.ndarray) -> None:
        """Take other supports (n, f)."""
        self.operator.set_constraints(mask)

    def patch(self, changed: np.ndarray) -> None:
        """Take in cells (k,) that flips have changed."""
        self.operator.patch(0, changed)

    def assemble(self, prebuckling: SteadyState[PrestressedProblem], sign: float) -> tuple[PETSc.Mat, PETSc.Mat]:
        """K and G, times the sign of the load, at an equilibrium."""
        problem, zero = prebuckling.problem, np.zeros_like(prebuckling.x)
        geometric = Assembled([problem.geometric_stiffness(prebuckling.x, sign)], self.operator).tangent(zero)
        return prebuckling.system.mat, geometric


def products(problem: PrestressedProblem, modes: np.ndarray, u: np.ndarray, sign: float) -> np.ndarray:
    """K phi and -G phi (2, k, 2 n) of modes (k, 2 n) at free unknowns, without matrices.

    Args:
        problem: with a geometric stiffness.
        u: (n, 2) [m] the displacement that it is of.
        sign: of the load.
    """
    shape, found = problem.boundary.mask.shape, np.empty((2, *modes.shape))
    parts = (Assembled(problem.integrals(STIFFNESS)), Assembled([problem.geometric_stiffness(u, -sign)]))
    for part, out in zip(parts, found):
        for mode, row in zip(modes, out):
            force = part.residual(np.ascontiguousarray(mode.reshape(shape)))
            problem.boundary.zero(force)
            row[:] = force.ravel()
    return found
