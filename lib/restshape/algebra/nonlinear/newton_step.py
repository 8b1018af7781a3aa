"""The linear solve of one Newton step, with a shift where the tangent is not positive definite."""

from petsc4py import PETSc

from restshape.algebra.linear import LinearSolver
from restshape.algebra.nonlinear.forcing_terms import COARSE
from restshape.algebra.nonlinear.newton_convergence import INDEFINITE
from restshape.algebra.nonlinear.tangent import Tangent
from restshape.arrays import Reals
from restshape.errors import ReplayProblem

LEAST_SHIFT, SHIFT_GROWTH, MOST_SHIFT = 1e-8, 4.0, 1.0
"""What is added to the diagonal of an indefinite tangent, over the mean of its entries: grown until there is enough."""


class NewtonStep:
    """Solves for the steps of one run after another, by the linear solver that outlives them.

    Args:
        linear: keeps its preconditioner over matrices and frames.

    Attributes:
        iterations, refreshed, why: of this run: of the linear solver; a preconditioner was made; what went wrong.
    """

    def __init__(self, linear: LinearSolver) -> None:
        self.linear = linear
        self.places: Reals | None = None
        self.new_system, self.patched = True, False
        self.begin_run()

    def begin_run(self) -> None:
        """Count from zero."""
        self.iterations, self.refreshed, self.why, self._shift = 0, False, "", 0.0

    def begin_frame(self, new_system: bool, patched: bool, places: Reals | None) -> None:
        """A new frame: whether the mesh is another one, or has flips; `places` are those of this rank's nodes."""
        # A mesh on which nothing had to be solved for is still to be met.
        self.new_system |= new_system
        self.patched, self.places = patched, places

    def definite(self, mat: PETSc.Mat) -> bool:
        """Whether a matrix is positive definite, as far as the preconditioner can show."""
        new_system, self.new_system = self.new_system, False
        return self.linear.definite(mat, self.places, new_system)

    def solve(self, tangent: Tangent, b: PETSc.Vec, y: PETSc.Vec, target: float, shifts: bool) -> bool:
        """Solve for the step y of the residual b until a norm `target` is left; returns whether that went well.

        With `shifts` an indefinite tangent gets a multiple of the unit matrix: the step goes down in energy.
        """
        good = self.solve_with(tangent.mat, b, y, target) or (shifts and self._solve_shifted(tangent, b, y))
        # A preconditioner of several grids, or of another place of edges, moves constrained unknowns too, as far as its
        # tolerance lets it.
        tangent.equations.constrain(y.getArray())
        return good

    def solve_with(self, mat: PETSc.Mat, b: PETSc.Vec, y: PETSc.Vec, target: float) -> bool:
        """Solve for y until a norm `target` of b is left; returns whether the matrix seems positive definite."""
        linear, new_system = self.linear, self.new_system
        # Whatever comes of it, the solver has met this mesh then.
        self.new_system = False
        y.set(0.0)
        scale = target / linear.tolerance
        try:
            report = linear.solve(mat, b, y, new_system, patched=self.patched, places=self.places, scale=scale)
        except ReplayProblem as problem:
            self.why = INDEFINITE if linear.traits.minimises else str(problem)
            return False
        self.iterations += report.iterations
        self.refreshed |= report.refreshed
        if report.refreshed and linear.negative_pivots():
            self.why = INDEFINITE
            return False
        return True

    def _solve_shifted(self, tangent: Tangent, b: PETSc.Vec, y: PETSc.Vec) -> bool:
        """Solve with the least shift, of those tried, that makes the tangent positive definite."""
        diagonal = tangent.mat.getDiagonal()
        size = diagonal.norm(PETSc.NormType.NORM_1) / diagonal.getSize()
        diagonal.destroy()
        added, shift = 0.0, max(LEAST_SHIFT, self._shift / SHIFT_GROWTH**2)
        while shift <= MOST_SHIFT:
            tangent.shift((shift - added) * size)
            mat = tangent.mat
            if self.linear.definite(mat, self.places) and self.solve_with(mat, b, y, COARSE * b.norm()):
                self.why, self._shift = "", shift
                return True
            added, shift = shift, SHIFT_GROWTH * shift
        return False
