"""What a problem declares of its linear systems, from which a preconditioner is chosen."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Traits:
    """Properties of all matrices of one problem.

    Args:
        symmetric: each equals its transpose.
        definite: where the problem is stable, each is positive definite.
        fields: unknowns a node.
        dimension: 2 for bodies in the plane, 3 for bodies and sheets in space: what patterns of nodes are like.
        rigid_motions: rigid motions of the body are nearly in the null space; else constants are.
    """

    symmetric: bool = True
    definite: bool = True
    fields: int = 2
    dimension: int = 2
    rigid_motions: bool = True

    @property
    def factor(self) -> str:
        """PETSc's type of a complete factor."""
        return "cholesky" if self.symmetric else "lu"

    @property
    def krylov(self) -> str:
        """PETSc's type of the iteration that serves with any preconditioner."""
        return "cg" if self.symmetric else "gmres"
