"""Second-order meshes of the unit square with dofs of several fields, and Stokes flow on them."""

import numpy as np
from petsc4py import PETSc
from sample_meshes import second_order, unit_box

from restshape import _kernels as k


def mixed_dofs(element, cells: np.ndarray, corners: int) -> tuple[np.ndarray, int]:
    """Dofs (ne, 15) of velocity, node after node, and then of pressure on the first `corners` nodes; their number."""
    nodes = int(cells.max()) + 1
    velocity = (2 * cells[:, :, None] + np.arange(2)).reshape(len(cells), -1)
    return np.hstack([velocity, 2 * nodes + cells[:, :3]]).astype(np.int32), 2 * nodes + corners


def square(per_side: int, seed: int = 3) -> tuple[np.ndarray, np.ndarray, int]:
    """Nodes, second-order cells and the number of corners of the unit square; corners come first."""
    X, cells, inner = unit_box(2, per_side, seed)
    corners = len(X)
    X, cells, _ = second_order(X, cells, inner)
    return X, np.ascontiguousarray(cells, dtype=np.int32), corners


def solve(element, X, cells, corners, params, boundary, backend="csr", coefficients=None) -> np.ndarray:
    """The flow (dofs,) whose velocity is boundary(X) (n, 2) on the square's sides, its first pressure 0, by LU."""
    dofs, count = mixed_dofs(element, cells, corners)
    x, mask = np.zeros((count, 1)), np.zeros(count, dtype=np.uint8)
    side = np.flatnonzero(np.any((X < 1e-9) | (X > 1 - 1e-9), axis=1))
    fixed = (2 * side[:, None] + np.arange(2)).ravel()
    x[fixed, 0] = boundary(X[side]).ravel()
    mask[fixed] = mask[2 * len(X)] = 1
    op = k.Operator(False, 1, np.array([0, count], dtype=np.int32), 0, backend)
    op.set_topology([(cells, dofs)])
    op.set_constraints(mask)
    rhs = np.zeros(count)
    op.begin()
    op.add(0, X, [(element, x, params, 1.0, 1.0, coefficients)], rhs)
    op.end()
    ksp = PETSc.KSP().create(PETSc.COMM_SELF)
    ksp.setOperators(op.mat)
    ksp.setType("preonly")
    ksp.getPC().setType("lu")
    ksp.getPC().setFactorSolverType("mumps")
    b, change = PETSc.Vec().createWithArray(rhs, comm=PETSc.COMM_SELF), op.mat.createVecRight()
    ksp.solve(b, change)
    return x[:, 0] + change.array
