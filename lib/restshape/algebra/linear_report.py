"""What linear solves did, and how far a solution is from one."""

from dataclasses import dataclass

from petsc4py import PETSc

from restshape import _kernels


@dataclass
class LinearReport:
    """What a frame's solves did.

    Args:
        iterations: of the Krylov method.
        refreshed: the preconditioner is rebuilt.
        age: solves, or frames, since it was made.
        preconditioner: its name.
        newton: steps of Newton's method; 0 where the equations are linear.
    """

    iterations: int
    refreshed: bool
    age: int
    preconditioner: str = ""
    newton: int = 0

    def followed_by(self, other: "LinearReport") -> "LinearReport":
        """This solve and another one that went on from it, as one."""
        return LinearReport(
            self.iterations + other.iterations, self.refreshed or other.refreshed, other.age, other.preconditioner
        )


def true_residual(mat: PETSc.Mat, b: PETSc.Vec, x: PETSc.Vec, scale: float | None = None) -> float:
    """The norm of b - mat x over `scale`, by default the norm of b; as it is where that is 0."""
    error, scale = _kernels.residual_norm(mat.handle, b.handle, x.handle), b.norm() if scale is None else scale
    return error / scale if scale > 0 else error
