"""Stiffness and geometric stiffness of a static solid, on patterns that are kept from frame to frame."""

import numpy as np
from petsc4py import PETSc

from restshape.algebra.operator import Operator
from restshape.analysis.steady import SteadyState
from restshape.fem.assembled import Assembled
from restshape.fem.problem import STIFFNESS, PrestressedProblem, SteadyProblem


class BucklingMatrices:
    """K and G of one mesh, whole on every rank.

    Args:
        problem: on the mesh.
        ranks: that share the solve for the equilibrium: on one rank its K is the whole one.
        backend: of the operators.
    """

    def __init__(self, problem: SteadyProblem, ranks: int, backend: str | None) -> None:
        offsets, mask = np.array([0, len(problem.space.X)], dtype=np.int32), problem.boundary.mask
        self.operators = [
            Operator(PETSc.COMM_SELF, mask.shape[1], offsets, backend, symmetric=False)
            for _ in range(1 if ranks == 1 else 2)
        ]
        for operator in self.operators:
            operator.set_topology([problem.space.cells], mask)

    @property
    def geometric(self) -> PETSc.Mat:
        """G as it was assembled last."""
        return self.operators[0].mat

    def set_constraints(self, mask: np.ndarray) -> None:
        """Take other supports (n, f)."""
        for operator in self.operators:
            operator.set_constraints(mask)

    def patch(self, changed: np.ndarray) -> None:
        """Take in cells (k,) that flips have changed."""
        for operator in self.operators:
            operator.patch(0, changed)

    def assemble(self, prebuckling: SteadyState[PrestressedProblem], sign: float) -> tuple[PETSc.Mat, PETSc.Mat]:
        """K and G, times the sign of the load, at an equilibrium."""
        problem, zero = prebuckling.problem, np.zeros_like(prebuckling.x)
        geometric = Assembled([problem.geometric_stiffness(prebuckling.x, sign)], self.operators[0]).tangent(zero)
        stiffness = prebuckling.system.mat
        if len(self.operators) > 1:
            stiffness = Assembled(problem.integrals(STIFFNESS), self.operators[1]).tangent(zero)
        return stiffness, geometric


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
