"""What a prediction is away from the solution, found with the kept preconditioner."""

from collections.abc import Callable

import numpy as np
from petsc4py import PETSc

from restshape.algebra.gathering import gather_vector
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
    whole = preconditioner(solver, rows)

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
    found, gains = np.zeros_like(residual), []
    step = precondition(residual)
    weight = float(residual @ step)
    for _ in range(MOST):
        force = product(step)
        stiffness = float(step @ force)
        if not (weight > 0.0 and stiffness > 0.0):
            break
        length = weight / stiffness
        found += length * step
        residual = residual - length * force
        gains.append(length * weight)
        if sum(gains[-delay:]) <= enough * (known + sum(gains)):
            break
        z = precondition(residual)
        weight, last = float(residual @ z), weight
        step = z + weight / last * step
    else:
        return np.full_like(found, np.nan)
    return found


def preconditioner(solver: LinearSolver, rows: slice) -> Operation:
    """The preconditioner of the last solve, as it is, for arrays (n,) whole on every rank; rows: this rank's.

    That of another number of unknowns is none: on a new mesh where nothing had to be solved for yet.
    """
    pc = solver.ksp.getPC()
    kept = gathered(pc.apply, rows, solver.comm)

    def apply(r: np.ndarray) -> np.ndarray:
        return kept(r) if solver.kept.ready and solver.kept.size.unknowns == len(r) else r.copy()

    return apply


def gathered(apply: Callable[[PETSc.Vec, PETSc.Vec], None], rows: slice, comm: PETSc.Comm) -> Operation:
    """An operation on PETSc's vectors, such as a product with a matrix, for arrays (n,) whole on every rank.

    Args:
        apply: from the first to the second vector.
        rows: this rank's.
        comm: of the vectors, which are made once: n is the same at each call.
    """
    vectors: tuple[PETSc.Vec, ...] = ()
    own: tuple[np.ndarray, ...] = ()

    def whole(r: np.ndarray) -> np.ndarray:
        nonlocal vectors, own
        if not vectors:
            count = rows.stop - rows.start
            own = np.zeros(count), np.zeros(count)
            vectors = tuple(PETSc.Vec().createWithArray(array, size=(count, len(r)), comm=comm) for array in own)
        source, target = vectors
        own[0][:] = r[rows]
        source.stateIncrease()
        apply(source, target)
        if comm.size == 1:
            return own[1].copy()
        full = np.empty(len(r))
        full[rows] = own[1]
        return gather_vector(full, rows, comm)

    return whole


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
