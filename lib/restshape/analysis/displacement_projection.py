"""Displacements of a motion brought to a new mesh without a gain of energy."""

import numpy as np
from petsc4py import PETSc

from restshape.algebra.operator import Operator
from restshape.algebra.preconditioner import free, order_factor
from restshape.fem.elements import LINEAR_ELASTIC
from restshape.fem.facets import SHAPES
from restshape.fem.integral import Integral
from restshape.fem.semidiscrete import SemiDiscrete
from restshape.fem.space import Space
from restshape.mesh.quadratic_basis import quadratic_basis
from restshape.mesh.quadrature import SAMPLES
from restshape.mesh.transfer import Transfer, transfer

FACTORED = 300_000
"""Unknowns up to which a complete factor corrects them: it takes a third of the time of iterations, and more memory."""
NEAR = 1e-8
"""Residual of the correction, relative to its right side."""
MOST = 1000
"""Iterations of it: each brings it nearer, so that what it has then is taken."""

LINEAR_SLOPES = np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]])


def project_displacement(old: SemiDiscrete, new: SemiDiscrete, u: np.ndarray) -> np.ndarray:
    """Displacements (n_new, 2) [m] on a new mesh whose strains are nearest to those of u, in the norm of the energy.

    Interpolation from mesh to mesh adds energy to waves as short as the cells, more each time, without bound. The
    projection does not. Its stresses are those of small strains, also where strains are large; lambda counts 2 mu at
    most, as strains of nearly incompressible elements are right on the mean of a cell alone.

    Args:
        old, new: on the mesh before and on the new one.
        u: (n_old, 2) displacements [m], prescribed ones included.

    Source: docs/theory/solids.md.
    """
    space, values = new.problem.space, new.problem.boundary.values
    # Nodes that are prescribed have their own.
    start = np.where(new.constrained, values, transfer(old.problem.space, space, u))
    moduli = new.problem.energy_moduli()
    if moduli is None:
        return start
    lame, shear, thickness = np.broadcast_to(moduli, (len(space.cells), 3)).T
    lame = np.minimum(lame, 2.0 * shear)
    params = np.column_stack([lame, shear, thickness, np.zeros((len(lame), 2))])
    forces = _forces(old.problem.space, space, u, start, params)
    return start + _solved(space, new.constrained, params, forces)


def _forces(old: Space, new: Space, u: np.ndarray, start: np.ndarray, params: np.ndarray) -> np.ndarray:
    """Nodal forces (n, 2) [N] of the strains that `start` lacks beside u."""
    points, weights = SAMPLES
    values, slopes = _basis(points[:, 1:], new.cells.shape[1])
    nodes, count = new.cells.T, len(new.cells)
    # Products of two matrices, with a column for each cell and component.
    nodal = np.concatenate([new.X, start], axis=1)[nodes].reshape(len(nodes), -1)
    along = (slopes.transpose(0, 2, 1).reshape(-1, len(nodes)) @ nodal).reshape(len(weights), 2, count, 4)
    places = (values @ nodal).reshape(-1, 4)[:, :2]
    here, (inverse, area) = _gradients(along.transpose(0, 2, 1, 3))
    there, _ = _gradients(_along(Transfer(old, places), np.concatenate([old.X, u], axis=1)))
    lacking = there.reshape(here.shape) - here
    lame, shear, thickness = params[:, :3].T
    work = 0.5 * weights[:, None] * area * thickness
    pressure = lame * (lacking[..., 0, 0] + lacking[..., 1, 1])
    xx, yy = (work * (pressure + 2.0 * shear * lacking[..., a, a]) for a in (0, 1))
    xy = work * shear * (lacking[..., 0, 1] + lacking[..., 1, 0])
    # Of both components along both directions of the cell.
    shares = [np.stack([p * inverse[..., 0] + q * inverse[..., 1] for p, q in ((xx, xy), (xy, yy))], axis=-1)]
    shares += [np.stack([p * inverse[..., 2] + q * inverse[..., 3] for p, q in ((xx, xy), (xy, yy))], axis=-1)]
    rows = np.stack(shares, axis=1).reshape(2 * len(weights), -1)
    own = (slopes.transpose(1, 0, 2).reshape(len(nodes), -1) @ rows).reshape(len(nodes), count, 2)
    return np.column_stack([np.bincount(nodes.ravel(), own[..., a].ravel(), len(new.X)) for a in (0, 1)])


def _gradients(along: np.ndarray) -> tuple[np.ndarray, tuple[np.ndarray, np.ndarray]]:
    """Gradients (..., 2, 2) of a displacement, of slopes (..., 2, 4) of x, y, u and v along both directions of a cell.

    Besides what these directions change by along x and y, each in turn (..., 4), and twice the area (...).
    """
    (xa, ya, *first), (xb, yb, *second) = (np.moveaxis(along[..., b, :], -1, 0) for b in (0, 1))
    area = xa * yb - xb * ya
    inverse = np.stack([yb, -xb, -ya, xa], axis=-1) / area[..., None]
    rows = [
        [a * inverse[..., 0] + b * inverse[..., 2], a * inverse[..., 1] + b * inverse[..., 3]]
        for a, b in zip(first, second)
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2), (inverse, area)


def _along(found: Transfer, field: np.ndarray) -> np.ndarray:
    """Slopes (m, 2, f) of a field (n, f) along both directions of the cells that the points that were found lie in."""
    weights = found.weights
    if weights.shape[1] == 3:
        return np.einsum("kb,mkf->mbf", LINEAR_SLOPES, field[found.nodes])
    # Places in a cell are weights of its corners, of which those of a side's middle count half to either end.
    middles = weights[:, 3:]
    corners = weights[:, :3] + 0.5 * (middles + middles[:, [2, 0, 1]])
    return np.einsum("mkb,mkf->mbf", quadratic_basis(corners[:, 1:])[1], field[found.nodes])


def _basis(points: np.ndarray, nodes: int) -> tuple[np.ndarray, np.ndarray]:
    """Values (q, k) and slopes (q, k, 2) of the basis of a triangle of 3 or 6 nodes at reference points (q, 2)."""
    if nodes == 6:
        return quadratic_basis(points)
    x, y = points.T
    return np.column_stack([1.0 - x - y, x, y]), np.broadcast_to(LINEAR_SLOPES, (len(points), 3, 2))


def _solved(space: Space, constrained: np.ndarray, params: np.ndarray, forces: np.ndarray) -> np.ndarray:
    """Displacements (n, 2) of forces (n, 2) [N], 0 where constrained."""
    right, found = np.where(constrained, 0.0, forces), np.zeros_like(forces)
    operator = Operator(PETSc.COMM_SELF, 2, np.array([0, len(space.X)], dtype=np.int32))
    operator.set_topology([space.cells], constrained.astype(np.uint8))
    element = LINEAR_ELASTIC[SHAPES[space.cells.shape[1]][0]]
    matrix = operator.assemble([Integral(element, space.X, space.cells, params).term(found)], None)
    b, x = (PETSc.Vec().createWithArray(one, comm=PETSc.COMM_SELF) for one in (right, found))
    ksp = PETSc.KSP().create(PETSc.COMM_SELF)
    ksp.setType("cg")
    pc = ksp.getPC()
    if right.size <= FACTORED:
        pc.setType("cholesky")
        order_factor(pc)
    else:
        pc.setType("icc")
        pc.setFactorLevels(1)
        pc.setFactorShift(PETSc.Mat.FactorShiftType.POSITIVE_DEFINITE)
    ksp.setTolerances(rtol=NEAR, atol=0.0, max_it=MOST)
    ksp.setOperators(matrix)
    ksp.solve(b, x)
    free(ksp, b, x)
    return found
