"""What a prediction is away from the solution, found with the kept preconditioner."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.factors.gathering import gather_vector
from restshape.algebra.factors.row_share import RowShare
from restshape.algebra.linear import LinearSolver
from restshape.fem.problem import SteadyProblem
from restshape.fem.residuals import Operation, stiffness_product, unconstrained_residual

ENOUGH, DELAY, MOST = 1e-4, 4, 200
"""Share of the squared energy that so many successive steps together add at the end; steps at most."""

REPEATED = 1e-12
"""Of vectors that span a space: a direction of less than this share of the largest is none."""


def correction(
    problem: SteadyProblem,
    x: np.ndarray,
    solver: LinearSolver,
    rows: slice,
    on_step: Callable[[], None] = lambda: None,
) -> np.ndarray:
    """About what unknowns x (n, f) lack to be a solution (n, f).

    Where no tangent is symmetric it is one step with the kept factor. The solver's own state is left as it is.

    Args:
        problem: on the space as it lies.
        x: prescribed unknowns have their values.
        solver: its preconditioner is that of a mesh some frames ago.
        rows: this rank's, of n f.
        on_step: called where the kept preconditioner is applied.
    """
    rest = -unconstrained_residual(problem, x)
    problem.boundary.zero(rest)
    residual = rest.ravel()
    whole = KeptOperation(solver, rows)

    def kept(r: np.ndarray) -> np.ndarray:
        on_step()
        return whole(r)

    if not solver.symmetric:
        return kept(residual).reshape(x.shape)
    return conjugate_steps(stiffness_product(problem, x), kept, residual).reshape(x.shape)


def conjugate_steps(
    product: Operation,
    precondition: Operation,
    residual: np.ndarray,
    known: float = 0.0,
    delay: int = DELAY,
    enough: float = ENOUGH,
) -> np.ndarray:
    """About the solution (n,) of product(d) = rest: steps of conjugate gradients from 0.

    Each lowers the squared distance in the energy norm by what it gains. A single small gain says nothing of what is
    left; several together are that distance some steps ago, but for the one that is left now. A factor of
    that very matrix takes one step more than the delay. Not a number where the most steps are not enough.
    Without a delay the last step is the preconditioned residual, which foresees its gain and takes no product.

    Where both are `RowOperation`s, ranks take the steps of their own rows alone; products are summed in their order. On
    one rank those of a matrix and the kept preconditioner are taken without Python.

    Args:
        product: of a symmetric positive definite matrix with (n,).
        precondition: about its inverse.
        residual: (n,) right side.
        known: squared energy of what the solution is added to, of which what is left is a share too.
        delay: successive steps whose gains together must be small.
        enough: share of the squared energy that is small.

    Source: docs/theory/error-estimates.md; Hestenes and Stiefel, J. Res. Natl. Bur. Stand. 49 (1952) 409; Strakos and
    Tichy, Electron. Trans. Numer. Anal. 13 (2002) 56.
    """
    n = len(residual)
    if isinstance(product, RowOperation) and isinstance(precondition, RowOperation):
        if product.comm.size > 1:
            # Each rank takes the steps of its own rows.
            rows, share = product.rows, RowShare(product.comm, product.rows, n)
            own = _Steps(lambda d: product.own(d, n), lambda r: precondition.own(r, n), share)
            found = np.empty(n)
            found[rows] = own(residual[rows], known, delay, enough)
            return gather_vector(found, rows, product.comm)
        handles = product.handle_for(n), precondition.handle_for(n)
        if all(handles):
            found = np.empty(n)
            solved = _kernels.conjugate_steps(
                *handles, np.ascontiguousarray(residual), found, known, delay, enough, MOST
            )
            return found if solved else np.full(n, np.nan)
    return _Steps(product, precondition, None)(residual, known, delay, enough)


@dataclass(frozen=True)
class _Steps:
    """Steps of conjugate gradients, of arrays that are whole, or of this rank's rows where ranks share them.

    Args:
        product, precondition: of such arrays; share: of the rows; None: they are whole.
    """

    product: Operation
    precondition: Operation
    share: RowShare | None

    def __call__(self, residual: np.ndarray, known: float, delay: int, enough: float) -> np.ndarray:
        """About the solution; see `conjugate_steps`."""
        found, gains = np.zeros_like(residual), list[float]()
        step = self.precondition(residual)
        weight = self._dot(residual, step)
        for _ in range(MOST):
            force = self.product(step)
            stiffness = self._dot(step, force)
            if not (weight > 0.0 and stiffness > 0.0):
                break
            length = weight / stiffness
            found += length * step
            residual = residual - length * force
            gains.append(length * weight)
            small = enough * (known + sum(gains))
            if delay and sum(gains[-delay:]) <= small:
                break
            z = self.precondition(residual)
            weight, last = self._dot(residual, z), weight
            if not delay and 0.0 <= weight <= small:
                found += z
                break
            step = z + weight / last * step
        else:
            return np.full_like(found, np.nan)
        return found

    def _dot(self, a: np.ndarray, b: np.ndarray) -> float:
        product = a @ b
        return float(product if self.share is None else self.share.summed(np.float64(product)))


class RowOperation:
    """An operation on PETSc's vectors, such as a product with a matrix, of which each rank has its own rows.

    A call takes an array (n,) that is whole on every rank, and gives one; `own` takes and gives this rank's rows alone.

    Args:
        apply: from the first to the second vector.
        rows: this rank's.
        comm: of the vectors, which are made once: n is the same at each call.
        handle: of PETSc's matrix or preconditioner that is applied; 0: there is none.
    """

    def __init__(
        self, apply: Callable[[PETSc.Vec, PETSc.Vec], None], rows: slice, comm: PETSc.Comm, handle: int = 0
    ) -> None:
        self.rows, self.comm, self._apply, self._handle = rows, comm, apply, handle
        self._vectors: tuple[PETSc.Vec, ...] = ()
        self._arrays: tuple[np.ndarray, ...] = ()

    def __call__(self, r: np.ndarray) -> np.ndarray:
        """The operation on r (n,), whole on every rank; collective."""
        own = self.own(r[self.rows], len(r))
        if self.comm.size == 1:
            return own
        full = np.empty(len(r))
        full[self.rows] = own
        return gather_vector(full, self.rows, self.comm)

    def own(self, r: np.ndarray, n: int) -> np.ndarray:
        """This rank's rows of the operation on an array (n,), of which r are this rank's rows; collective."""
        if not self._vectors:
            count = self.rows.stop - self.rows.start
            self._arrays = np.zeros(count), np.zeros(count)
            of = {"size": (count, n), "comm": self.comm}
            self._vectors = tuple(PETSc.Vec().createWithArray(array, **of) for array in self._arrays)
        source, target = self._vectors
        self._arrays[0][:] = r
        source.stateIncrease()
        self._apply(source, target)
        return self._arrays[1].copy()

    def handle_for(self, n: int) -> int:
        """Of PETSc's object that is applied to arrays (n,); 0 where there is none."""
        return self._handle


def matrix_product(mat: PETSc.Mat, rows: slice, comm: PETSc.Comm) -> RowOperation:
    """The product with a matrix of this communicator, of which this rank has these rows."""
    return RowOperation(mat.mult, rows, comm, mat.handle)


class KeptOperation(RowOperation):
    """The preconditioner of the last solve, as it is.

    That of another number of unknowns is none: on a new mesh where nothing had to be solved for yet.

    Args:
        solver: whose it is; rows: this rank's.
    """

    def __init__(self, solver: LinearSolver, rows: slice) -> None:
        pc = solver.ksp.getPC()
        super().__init__(pc.apply, rows, solver.comm, pc.handle)
        self._kept = solver.kept

    def own(self, r: np.ndarray, n: int) -> np.ndarray:
        """This rank's rows; see `RowOperation`."""
        return super().own(r, n) if self.handle_for(n) else r.copy()

    def handle_for(self, n: int) -> int:
        """That of the preconditioner; see `RowOperation`."""
        return super().handle_for(n) if self._kept.ready and self._kept.size.unknowns == n else 0


def largest_values(a: np.ndarray, b: np.ndarray, count: int) -> np.ndarray:
    """The largest eigenvalues (count,), ascending, of a y = theta b y; b is positive but where vectors repeat.

    Not numbers where a or b is not.
    """
    if not (np.isfinite(a).all() and np.isfinite(b).all()):
        return np.full(count, np.nan)
    scale = 1.0 / np.sqrt(np.maximum(np.diag(b), np.finfo(float).tiny))
    a, b = (0.5 * (m + m.T) * scale * scale[:, None] for m in (a, b))
    sizes, turn = np.linalg.eigh(b)
    kept = sizes > REPEATED * sizes[-1]
    turn = turn[:, kept] / np.sqrt(sizes[kept])
    return np.linalg.eigvalsh(turn.T @ a @ turn)[-count:]
