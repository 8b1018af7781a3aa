"""The linear system of a frame: operator, right side and solution on one mesh."""

from collections.abc import Callable, Sequence

import numpy as np
from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.factors.gathering import gather_vector
from restshape.algebra.linear import LinearSolver
from restshape.algebra.operator import Operator
from restshape.algebra.reuse.traits import Traits
from restshape.fem.dirichlet import Dirichlet
from restshape.fem.problem import INTERNAL, SteadyProblem


class LinearSystem:
    """Holds what lives as long as a mesh does: the operator's pattern, and vectors.

    Args:
        comm: PETSc communicator.
        problem: on the mesh.
        backend: of the operator.
        traits: what the solver takes matrices for.

    Raises:
        ValueError: a tangent of the problem is not symmetric, though the traits say so.

    Attributes:
        rows: this rank's, of all n f unknowns.
        right: (n, f) right side, full: (n f,) solution, of all nodes; b, solution: PETSc's vectors of this rank's rows.
        places: (m, d) this rank's nodes [m].
        late: assembles the matrix and the vectors when `mat` is asked for; None: they are as they should be.
    """

    def __init__(self, comm: PETSc.Comm, problem: SteadyProblem, backend: str | None, traits: Traits) -> None:
        if traits.symmetric:
            refuse_unsymmetric(problem)
        mask = problem.boundary.mask
        fields = mask.shape[1]
        self.comm = comm
        known = {"symmetric": traits.symmetric, "definite": traits.definite}
        self.operator = Operator(comm, fields, problem.space.node_offsets, backend, **known)
        self.operator.set_topology(problem.blocks(), mask)
        self.rows = rows = self.operator.rows
        self.right, self.full = np.zeros(mask.shape), np.zeros(mask.size)
        size = (rows.stop - rows.start, mask.size)
        self.b = PETSc.Vec().createWithArray(self.right.ravel()[rows], size=size, comm=comm)
        self.solution = PETSc.Vec().createWithArray(self.full[rows], size=size, comm=comm)
        self.places = problem.space.dof_X[rows.start // fields : rows.stop // fields]
        self.late: Callable[[], PETSc.Mat] | None = None
        self._mat: PETSc.Mat | None = None

    @property
    def mat(self) -> PETSc.Mat | None:
        """The matrix of the last solve; of one of a part alone it is assembled now."""
        if self.late is not None:
            late, self.late = self.late, None
            self._mat = late()
        return self._mat

    @mat.setter
    def mat(self, mat: PETSc.Mat) -> None:
        self.late, self._mat = None, mat

    def start(self, terms: Sequence[tuple[float, np.ndarray]], boundary: Dirichlet) -> None:
        """Let the iteration start from the sum of fields (n, f) times weights, and take in another right side.

        Where supports move, the guess is set at all nodes, for residuals are measured against its forces.
        """
        # PETSc keeps a vector's norm until it is notified that the array behind it has changed.
        self.b.stateIncrease()
        rows = self.rows
        if boundary.nonzero:
            rows, terms = slice(0, self.full.size), [*terms, (-1.0, boundary.values)]
        weights, fields = [weight for weight, _ in terms], [field for _, field in terms]
        if rows.stop - rows.start == self.full.size:
            _kernels.weighted_sum(weights, fields, self.full)
        else:
            _kernels.weighted_sum(weights, [field.ravel()[rows] for field in fields], self.full[rows])
        self.full[boundary.constrained] = 0.0
        if self.b.norm() == 0.0:
            # From another guess an iteration would leave rounding, in which buckling would look for modes.
            self.full[:] = 0.0
        self.solution.stateIncrease()

    def gather(self) -> None:
        """Fill `full` with all ranks' rows of the solution."""
        gather_vector(self.full, self.rows, self.comm)

    def unknowns(self, boundary: Dirichlet) -> np.ndarray:
        """The unknowns (n, f), prescribed ones included, of which each rank has solved for its own; collective."""
        if self.comm.size > 1:
            self.gather()
        return self.with_prescribed(boundary)

    def with_prescribed(self, boundary: Dirichlet) -> np.ndarray:
        """The unknowns (n, f) of `full` as it is, prescribed ones included."""
        values = boundary.values
        if not boundary.nonzero:
            return self.full.reshape(values.shape).copy()
        found = np.empty(values.shape)
        _kernels.weighted_sum([1.0, 1.0], [self.full, values], found)
        return found


def refuse_unsymmetric(problem: SteadyProblem) -> None:
    """Makes sure that what is declared symmetric is: a factor of half of the matrix would be one of another.

    Raises:
        ValueError: an element of the problem has a tangent that is not symmetric.
    """
    for integral in problem.integrals(INTERNAL):
        if integral.block is not None and not integral.element.symmetric:
            declared = f"the physics {problem.name!r} declares symmetric matrices"
            raise ValueError(
                f"{declared}, and the tangent of {integral.element.name} is not: let its plan name UNSYMMETRIC"
            )


def auxiliary_solve(
    solver: LinearSolver,
    operator: Operator,
    mat: PETSc.Mat,
    rhs: np.ndarray,
    tolerance: float,
    constrained: np.ndarray,
    places: np.ndarray,
    same_matrix: bool,
) -> np.ndarray:
    """The s (n, f) of mat s = rhs beside the sequence of solves, on the kept preconditioner.

    Args:
        solver: of that sequence.
        operator: whose rows are this rank's.
        mat: a tangent.
        rhs: (n, f), ignored at constrained unknowns, where s is 0.
        tolerance: of the residual, relative to rhs.
        constrained: indices among all n f unknowns.
        places: (m, d) this rank's nodes [m].
        same_matrix: mat is that of the last solve.

    Raises:
        ReplayProblem: the solve does not converge.
    """
    rows, n, comm = operator.rows, rhs.size, operator.comm
    right, full = rhs.ravel().copy(), np.zeros(n)
    right[constrained] = 0.0
    size = (rows.stop - rows.start, n)
    b, s = (PETSc.Vec().createWithArray(array[rows], size=size, comm=comm) for array in (right, full))
    norm = b.norm()
    if norm > 0.0:
        scale = norm * tolerance / solver.tolerance
        solver.solve(mat, b, s, False, same_matrix=same_matrix, places=places, scale=scale, auxiliary=True)
        gather_vector(full, rows, comm)
    for vector in (b, s):
        vector.destroy()
    return full.reshape(rhs.shape)
