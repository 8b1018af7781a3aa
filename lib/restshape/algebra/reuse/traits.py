"""What a problem declares of its linear systems, from which a preconditioner is chosen."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Traits:
    """Properties of all matrices of one problem.

    Args:
        symmetric: each equals its transpose.
        definite: where the problem is stable, each is positive definite; symmetric ones that are not may have zeros on
            the diagonal, as those with a pressure do.
        fields: unknowns a node, on which the fill of factors hangs.
        dimension: 2 for bodies in the plane, 3 for bodies and sheets in space: what patterns of nodes are like.
        sheet: in space, nodes couple along a surface: work on a factor grows as in the plane.
        rigid_motions: rigid motions of the body are nearly in the null space; else constants are.
        rate: matrices are those of steps in time, whose rate term makes them better conditioned than steady ones.
    """

    symmetric: bool = True
    definite: bool = True
    fields: int = 2
    dimension: int = 2
    rigid_motions: bool = True
    rate: bool = False
    sheet: bool = False

    @property
    def factor(self) -> str:
        """PETSc's type of a complete factor."""
        return "cholesky" if self.symmetric else "lu"

    @property
    def krylov(self) -> str:
        """PETSc's type of the iteration that serves with any preconditioner."""
        return "cg" if self.minimises else "gmres"

    @property
    def minimises(self) -> bool:
        """Whether solutions are least of an energy, so that a matrix that is not definite shows an unstable one."""
        return self.symmetric and self.definite

    @property
    def pivots(self) -> bool:
        """Whether a complete factor must exchange rows: one of a symmetric matrix that is not definite."""
        return self.symmetric and not self.definite
