"""What a prediction is away from the solution, found with the kept preconditioner."""

from collections.abc import Callable

import numpy as np
from petsc4py import PETSc

from restshape.algebra.gather import whole_vector
from restshape.algebra.linear import LinearSolver
from restshape.physics.elasticity.plane_solid import PlaneSolid

ENOUGH, DELAY, MOST = 1e-4, 4, 200
"""Share of the squared energy that so many successive steps together add at the end; steps at most."""

REPEATED = 1e-12
"""Of vectors that span a space: a direction of less than this share of the largest is none."""

Operation = Callable[[np.ndarray], np.ndarray]


def correction(physics: PlaneSolid, x: np.ndarray, solver: LinearSolver, rows: slice) -> np.ndarray:
    """About what a displacement x (n, 2) [m] lacks to be in equilibrium (n, 2) [m].

    Where no tangent is symmetric it is one step with the kept factor. The solver's own state is left as it is.

    Args:
        physics: on the mesh as it lies.
        x: held unknowns have their prescribed values.
        solver: its preconditioner is that of a mesh some frames ago.
        rows: this rank's, of 2 n.
    """
    rest = -physics.imbalance(x).ravel()
    rest[physics.constrained] = 0.0
    kept = preconditioner(solver, rows)
    if not solver.symmetric:
        return kept(rest).reshape(x.shape)
    return conjugate_steps(tangent_product(physics, x), kept, rest).reshape(x.shape)


def conjugate_steps(product: Operation, precondition: Operation, rest: np.ndarray) -> np.ndarray:
    """About the solution (n,) of product(d) = rest: steps of conjugate gradients from 0.

    Each lowers the squared distance in the energy norm by what it gains. A single small gain says nothing of what is
    left; several together are that distance some steps ago, but for the one that is left now. A factor of
    that very matrix takes one step more than the delay. Not a number where the most steps are not enough.

    Args:
        product: of a symmetric positive definite matrix with (n,).
        precondition: about its inverse.
        rest: (n,) right side.

    Source: docs/theory.md, section 9; Hestenes and Stiefel, J. Res. Natl. Bur. Stand. 49 (1952) 409; Strakos and Tichy,
    Electron. Trans. Numer. Anal. 13 (2002) 56.
    """
    found, gains = np.zeros_like(rest), []
    step = precondition(rest)
    weight = float(rest @ step)
    for _ in range(MOST):
        force = product(step)
        stiffness = float(step @ force)
        if not (weight > 0.0 and stiffness > 0.0):
            break
        length = weight / stiffness
        found += length * step
        rest = rest - length * force
        gains.append(length * weight)
        if sum(gains[-DELAY:]) <= ENOUGH * sum(gains):
            break
        z = precondition(rest)
        weight, last = float(rest @ z), weight
        step = z + weight / last * step
    else:
        return np.full_like(found, np.nan)
    return found


def tangent_product(physics: PlaneSolid, x: np.ndarray) -> Operation:
    """The function from rates (2 n,) of displacements to those of internal forces at x (n, 2) [m], 0 where held."""
    mesh, still = physics.mesh, np.zeros_like(physics.mesh.X)

    def product(d: np.ndarray) -> np.ndarray:
        out, d = np.zeros_like(x), np.ascontiguousarray(d.reshape(x.shape))
        if physics.law == "linear_elastic":
            physics.element.residual(mesh.X, d, mesh.cells, physics.stiffness_params, out)
        else:
            physics.element.design(mesh.X, still, x, mesh.cells, physics.stiffness_params, out, dx=d)
        out.ravel()[physics.constrained] = 0.0
        return out.ravel()

    return product


def preconditioner(solver: LinearSolver, rows: slice) -> Operation:
    """The preconditioner of the last solve, as it is, for arrays (n,) whole on every rank; rows: this rank's.

    That of another number of unknowns is none: on a new mesh where nothing had to be solved for yet.
    """
    comm, pc = solver.comm, solver.ksp.getPC()

    def apply(r: np.ndarray) -> np.ndarray:
        if not (solver.ready and solver.size.unknowns == len(r)):
            return r.copy()
        full = np.zeros_like(r)
        size = (rows.stop - rows.start, len(r))
        source, target = (PETSc.Vec().createWithArray(array[rows], size=size, comm=comm) for array in (r, full))
        pc.apply(source, target)
        whole_vector(full, rows, comm)
        source.destroy()
        target.destroy()
        return full

    return apply


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
