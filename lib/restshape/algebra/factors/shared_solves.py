"""Solves with a complete factor of a definite matrix whose rows ranks share, as a preconditioner of PETSc's."""

import logging

from petsc4py import PETSc

from restshape.algebra.factors.shared_factor import NO_FACTOR, SharedFactor
from restshape.errors import ReplayProblem

log = logging.getLogger("restshape.algebra")


class SharedSolves:
    """A PC of type python: the inverse of the matrix, whose factor the ranks share (`SharedFactor`).

    Where the matrix has no factor solutions are no numbers, which ends the iteration of a KSP.

    Args:
        nodes: unknowns of a node.

    Attributes:
        negative: pivots of all ranks; singular: the matrix has no factor, however large one may be.
    """

    def __init__(self, nodes: int) -> None:
        self._factor, self._pattern = SharedFactor(nodes), PETSc.Mat()
        self.negative, self.singular = 0, False

    @property
    def nonzeros(self) -> float:
        """Of the factors of all ranks; 0 without one."""
        return self._factor.nonzeros if self._factor.made else 0.0

    def substitute_by_panels(self, single: bool) -> None:
        """Substitute by panels, in `single` precision or in double; they are worth making for several solves."""
        if self._factor.made:
            self._factor.substitute_by_panels(single)

    def setUp(self, pc: PETSc.PC) -> None:
        """Factor the matrix; another one may have another pattern."""
        matrix = pc.getOperators()[1]
        if self._pattern.handle != matrix.handle:
            self._factor.forget()
            # Held, so that no other matrix takes its place in memory.
            self._pattern = matrix
        try:
            self.negative, self.singular = self._factor.make(matrix, matrix, 0.0), False
        except ReplayProblem as problem:
            self.negative, self.singular = 0, str(problem) == NO_FACTOR
            log.log(logging.INFO if self.singular else logging.WARNING, "%s", problem)
            self._factor.forget()

    def apply(self, pc: PETSc.PC, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Set x to the solution with right side b."""
        if self._factor.made:
            self._factor.solve(b, x)
        else:
            x.set(float("nan"))

    def reset(self, pc: PETSc.PC) -> None:
        """Let go of factor and pattern."""
        self._factor.forget()
        self._pattern = PETSc.Mat()

    def destroy(self, pc: PETSc.PC) -> None:
        """Let go of factor and pattern."""
        self.reset(pc)


def set_shared_factor(ksp: PETSc.KSP, nodes: int) -> SharedSolves:
    """Give a solver on several ranks a complete factor of its matrix, of so many unknowns a node, which they share."""
    found = SharedSolves(nodes)
    ksp.getPC().setType("python")
    ksp.getPC().setPythonContext(found)
    return found
