"""What a prediction is away from the solution, found with the kept preconditioner."""

from collections.abc import Callable

import numpy as np
from petsc4py import PETSc

from restshape.algebra.gather import whole_vector
from restshape.algebra.linear import LinearSolver
from restshape.physics.solid import PlaneSolid

MOST, ENOUGH = 30, 0.01
"""Steps at most; the share of the squared distance found so far below which a step is the last one."""

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
    """About the solution (n,) of product(d) = rest: a few steps of conjugate gradients from 0.

    Each lowers the distance in the energy norm by what it adds to it. A kept complete factor takes one or two.

    Args:
        product: of a symmetric positive definite matrix with (n,).
        precondition: about its inverse.
        rest: (n,) right side.
    """
    found, total = np.zeros_like(rest), 0.0
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
        gain, total = length * weight, total + length * weight
        if gain <= ENOUGH * total:
            break
        z = precondition(rest)
        weight, last = float(rest @ z), weight
        step = z + weight / last * step
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
    """The preconditioner of the last solve, as it is, for arrays (n,) whole on every rank; rows: this rank's."""
    comm, pc = solver.comm, solver.ksp.getPC()

    def apply(r: np.ndarray) -> np.ndarray:
        full = np.zeros_like(r)
        if not r.any():
            # Of a body that nothing has moved yet there is no preconditioner either.
            return full
        size = (rows.stop - rows.start, len(r))
        source, target = (PETSc.Vec().createWithArray(array[rows], size=size, comm=comm) for array in (r, full))
        pc.apply(source, target)
        whole_vector(full, rows, comm)
        source.destroy()
        target.destroy()
        return full

    return apply


def largest_values(a: np.ndarray, b: np.ndarray, count: int) -> np.ndarray:
    """The largest eigenvalues (count,), ascending, of a y = theta b y; b is positive but where vectors repeat."""
    scale = 1.0 / np.sqrt(np.maximum(np.diag(b), np.finfo(float).tiny))
    a, b = (0.5 * (m + m.T) * scale * scale[:, None] for m in (a, b))
    sizes, turn = np.linalg.eigh(b)
    kept = sizes > REPEATED * sizes[-1]
    turn = turn[:, kept] / np.sqrt(sizes[kept])
    return np.linalg.eigvalsh(turn.T @ a @ turn)[-count:]
