"""Stiffness and mass matrices of a body that vibrates, on patterns that are kept from frame to frame."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from petsc4py import PETSc

from restshape.algebra.factors.gathering import gather_matrix
from restshape.algebra.factors.row_share import RowShare
from restshape.algebra.operator import Operator
from restshape.fem.assembled import Assembled
from restshape.fem.eigenproblem import Eigenproblem
from restshape.fem.problem import MASS, STIFFNESS

if TYPE_CHECKING:
    import scipy.sparse as sp


class ModalMatrices:
    """K and M of a problem, of one pattern each, whose rows ranks share.

    Args:
        comm: PETSc communicator; of one process where they are wanted whole on every rank.
        problem: whose integrals are linear; kept by reference.
        backend: of the operators.
        before: of another problem, whose patterns serve this one where its cells are the same; it is of no use then.

    Attributes:
        share: the unknowns that this rank owns.
    """

    def __init__(
        self,
        comm: PETSc.Comm,
        problem: Eigenproblem,
        backend: str | None = None,
        before: ModalMatrices | None = None,
    ) -> None:
        self.problem, self.comm, mask = problem, comm, problem.boundary.mask
        offsets = problem.space.node_offsets if comm.size > 1 else np.array([0, len(problem.space.X)], dtype=np.int32)
        self.operators: list[Operator] = []
        self.share: RowShare
        if before is not None and before._serves(problem):
            self.operators, self.share = before.operators, before.share
            for operator in self.operators:
                operator.set_constraints(mask)
            return
        self.operators = [Operator(comm, mask.shape[1], offsets, backend) for _ in range(2)]
        self.share = RowShare(comm, self.operators[0].rows, mask.size)
        for operator in self.operators:
            operator.set_topology(problem.blocks(), mask)

    def _serves(self, problem: Eigenproblem) -> bool:
        """Whether another problem on the same plane mesh has the same cells, and as many unknowns a node."""
        if problem.boundary.mask.shape != self.problem.boundary.mask.shape:
            return False
        ours, others = self.problem.blocks(), problem.blocks()
        return len(ours) == len(others) and all(map(np.array_equal, ours, others))

    def patch(self, changed: np.ndarray) -> None:
        """Take in cells (k,) that flips have changed."""
        for operator in self.operators:
            operator.patch(0, changed)

    def assemble(self) -> tuple[PETSc.Mat, PETSc.Mat]:
        """K and M as the nodes lie; they belong to the operators."""
        constrained, undeformed = self.problem.boundary.constrained, np.zeros(self.problem.boundary.mask.shape)
        stiffness, mass = (
            Assembled(self.problem.integrals(kind), operator).tangent(undeformed)
            for kind, operator in zip((STIFFNESS, MASS), self.operators)
        )
        if len(constrained):
            # Alone on their rows, with a mass they would be modes of their own.
            rows, diagonal = self.share.unknowns, mass.getDiagonal()
            own = constrained[(constrained >= rows.start) & (constrained < rows.stop)]
            diagonal.getArray()[own - rows.start] = 0.0
            mass.setDiagonal(diagonal)
            diagonal.destroy()
        return stiffness, mass

    def gather(self) -> tuple[sp.csr_matrix, sp.csr_matrix]:
        """Copies of K and M as they stand, whole on each rank, with the rows of prescribed unknowns."""
        return tuple(gather_matrix(operator.mat, self.comm) for operator in self.operators)


def products(problem: Eigenproblem, modes: np.ndarray) -> np.ndarray:
    """K phi and M phi (2, k, n f) of modes (k, n f), without matrices; forces at constrained unknowns are in them."""
    shape, found = problem.boundary.mask.shape, np.empty((2, *modes.shape))
    for kind, out in zip((STIFFNESS, MASS), found):
        assembled = Assembled(problem.integrals(kind))
        for mode, product in zip(modes, out):
            product[:] = assembled.residual(np.ascontiguousarray(mode.reshape(shape))).ravel()
    return found
