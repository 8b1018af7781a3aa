"""Displacements of a motion brought to a new mesh without a gain of energy."""

import numpy as np
from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.operator import Operator
from restshape.algebra.preconditioner import free, order_factor
from restshape.analysis.new_mesh_samples import LINEAR_SLOPES, CellSamples
from restshape.fem.elements import LINEAR_ELASTIC_DILATATION
from restshape.fem.integral import Integral
from restshape.fem.problem import REFERENCE
from restshape.fem.semidiscrete import SemiDiscrete
from restshape.mesh.quadratic_basis import quadratic_basis
from restshape.mesh.transfer import Transfer, transfer

FACTORED = 300_000
"""Unknowns up to which a complete factor corrects them: it takes a third of the time of iterations, and more memory."""
STIFF = 10.0
"""Lambda by mu from which one does for any number of unknowns: iterations would not come to an end."""
NEAR = 1e-8
"""Residual of the correction, relative to its right side."""
MOST = 1000
"""Iterations of it: each brings it nearer, so that what it has then is taken."""

CORNER_SLOPES = quadratic_basis(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]))[1].transpose(0, 2, 1).reshape(6, 6)
"""Those of the basis of second order at the three corners, along both directions, (6, 6)."""


def project_displacement(
    old: SemiDiscrete, new: SemiDiscrete, u: np.ndarray, samples: CellSamples | None = None
) -> np.ndarray:
    """Displacements (n_new, 2) [m] on a new mesh whose strains are nearest to those of u, in the norm of the energy.

    Interpolation from mesh to mesh adds energy to waves as short as the cells, more each time, without bound. The
    projection does not, up to the quadrature of strains that jump within a new cell. Its stresses are those of small
    strains, also where strains are large: there it is not for nearly incompressible bodies, which gain energy.

    The norm is that of the elements: where they take the mean of the dilatation, this mean counts.

    Args:
        old, new: on the mesh before and on the new one.
        u: (n_old, 2) displacements [m], prescribed ones included.
        samples: of both meshes; None: they are made.

    Source: docs/theory/solids.md.
    """
    space, values = new.problem.space, new.problem.boundary.values
    # Nodes that are prescribed have their own.
    start = np.where(new.constrained, values, transfer(old.problem.space, space, u))
    moduli = new.problem.energy_moduli()
    if moduli is None:
        return start
    (stiffness,) = new.problem.integrals(REFERENCE)
    averaged = stiffness.element.family == LINEAR_ELASTIC_DILATATION.name
    forces = _forces(samples or CellSamples(old.problem.space, space), u, start, moduli, averaged)
    more = _solved(stiffness, new.constrained, forces)
    return start + more if np.isfinite(more).all() else start


def _forces(samples: CellSamples, u: np.ndarray, start: np.ndarray, moduli: np.ndarray, averaged: bool) -> np.ndarray:
    """Nodal forces (n, 2) [N] of the strains that `start` lacks beside u; `averaged`: of means of the dilatation."""
    old, new, weights, slopes = samples.old, samples.new, samples.weights, samples.slopes
    there = _found_gradients(samples.found, np.concatenate([old.X, u], axis=1))
    there = there.reshape(len(weights), len(new.cells), 2, 2)
    along = samples.along(np.concatenate([new.X, start], axis=1))
    if new.cells.shape[1] == 3:
        # The mean of what a cell lacks counts, for its own strains are constant.
        there, along = np.tensordot(weights, there, 1)[None], along[:1]
        slopes, weights = slopes[:1], np.ones(1)
    here, (inverse, area) = _gradients(along.transpose(0, 2, 1, 3))
    lacking = there - here
    lame, shear, thickness = np.broadcast_to(moduli, (len(new.cells), 3)).T
    work = 0.5 * weights[:, None] * area * thickness
    dilatation = np.trace(lacking, axis1=-2, axis2=-1)
    if averaged:
        dilatation = _mean(_mean_dilatation(samples, u)[samples.found.cells].reshape(area.shape), weights, area)
        dilatation -= _mean(np.trace(here, axis1=-2, axis2=-1), weights, area)
    pressure = lame * dilatation
    xx, yy = (work * (pressure + 2.0 * shear * lacking[..., a, a]) for a in (0, 1))
    xy = work * shear * (lacking[..., 0, 1] + lacking[..., 1, 0])
    # Of both components along both directions of the cell.
    shares = [np.stack([p * inverse[..., 0] + q * inverse[..., 1] for p, q in ((xx, xy), (xy, yy))], axis=-1)]
    shares += [np.stack([p * inverse[..., 2] + q * inverse[..., 3] for p, q in ((xx, xy), (xy, yy))], axis=-1)]
    rows = np.stack(shares, axis=1).reshape(2 * len(weights), -1)
    columns = slopes.transpose(1, 0, 2).reshape(new.cells.shape[1], -1)
    return samples.nodal_sums((columns @ rows).reshape(len(columns), -1, 2))


def _mean_dilatation(samples: CellSamples, u: np.ndarray) -> np.ndarray:
    """Means (ne_old,) of the dilatation of u over the cells of the mesh before."""
    old = samples.old
    own = CellSamples(old, old)
    gradients, (_, area) = _gradients(own.along(np.concatenate([old.X, u], axis=1)).transpose(0, 2, 1, 3))
    return _mean(np.trace(gradients, axis1=-2, axis2=-1), own.weights, area)


def _mean(values: np.ndarray, weights: np.ndarray, area: np.ndarray) -> np.ndarray:
    """Means (ne,) over cells, of values (q, ne) at points of these weights (q,) and areas (q, ne)."""
    return (weights @ (values * area)) / (weights @ area)


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


def _found_gradients(found: Transfer, field: np.ndarray) -> np.ndarray:
    """Gradients (m, 2, 2) of a displacement where points were found, of x, y, u and v at all nodes (n, 4)."""
    cells, weights = found.mesh.cells, found.weights
    nodal = field[cells.T].reshape(cells.shape[1], -1)
    if cells.shape[1] == 3:
        slopes = (LINEAR_SLOPES.T @ nodal).reshape(2, len(cells), -1).transpose(1, 0, 2)
        return _gradients(slopes)[0][found.cells]
    # Slopes of second order are linear in a cell: those at its corners give all others.
    slopes = (CORNER_SLOPES @ nodal).reshape(3, 2, len(cells), -1).transpose(2, 0, 1, 3)
    # Places in a cell are weights of its corners, of which those of a side's middle count half to either end.
    middles = weights[:, 3:]
    corners = weights[:, :3] + 0.5 * (middles + middles[:, [2, 0, 1]])
    rows = 3 * found.cells[:, None] + np.arange(3, dtype=np.int32)
    out = np.empty((len(rows), 2, field.shape[1]))
    _kernels.interpolate_rows(rows, corners, slopes.reshape(1, 3 * len(cells), -1), out)
    return _gradients(out)[0]


def _solved(stiffness: Integral, constrained: np.ndarray, forces: np.ndarray) -> np.ndarray:
    """Displacements (n, 2) of forces (n, 2) [N], 0 where constrained; not numbers where there are none."""
    right, found = np.where(constrained, 0.0, forces), np.zeros_like(forces)
    operator = Operator(PETSc.COMM_SELF, 2, np.array([0, len(forces)], dtype=np.int32))
    operator.set_topology([stiffness.entities], constrained.astype(np.uint8))
    matrix = operator.assemble([stiffness.term(found)], None)
    b, x = (PETSc.Vec().createWithArray(one, comm=PETSc.COMM_SELF) for one in (right, found))
    ksp = PETSc.KSP().create(PETSc.COMM_SELF)
    ksp.setType("cg")
    pc = ksp.getPC()
    lame, shear = stiffness.parameters[..., :2].T
    if right.size <= FACTORED or np.any(lame > STIFF * shear):
        pc.setType("cholesky")
        order_factor(pc)
    else:
        pc.setType("icc")
        pc.setFactorLevels(1)
        pc.setFactorShift(PETSc.Mat.FactorShiftType.POSITIVE_DEFINITE)
    ksp.setTolerances(rtol=NEAR, atol=0.0, max_it=MOST)
    ksp.setOperators(matrix)
    ksp.solve(b, x)
    # What the most iterations have reached is nearer than nothing; what broke down is not known to be.
    reason = ksp.getConvergedReason()
    if reason < 0 and reason != PETSc.KSP.ConvergedReason.DIVERGED_MAX_IT:
        found.fill(np.nan)
    free(ksp, b, x)
    return found
