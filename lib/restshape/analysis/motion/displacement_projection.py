"""Displacements of a motion brought to a new mesh without a gain of energy."""

from collections.abc import Callable

import numpy as np
from petsc4py import PETSc

from restshape.algebra.operator import Operator
from restshape.algebra.preconditioner import free, order_factor
from restshape.analysis.motion.new_mesh_samples import CellSamples
from restshape.fem.elements import LINEAR_ELASTIC_DILATATION
from restshape.fem.integral import Integral
from restshape.fem.problem import REFERENCE
from restshape.fem.semidiscrete import SemiDiscrete
from restshape.fem.space import Space
from restshape.mesh.transfer import transfer

FACTORED = 300_000
"""Unknowns up to which a complete factor corrects them: it takes a third of the time of iterations, and more memory."""
STIFF = 10.0
"""Lambda by mu from which one does for any number of unknowns: iterations would not come to an end."""
NEAR = 1e-8
"""Residual of the correction, relative to its right side."""
MOST = 1000
"""Iterations of it: each brings it nearer, so that what it has then is taken."""

NO_MEANS = np.empty(0)


Factor = Callable[[PETSc.Mat], PETSc.PC | None]
"""Makes a complete factor of a matrix, or None."""


def project_displacement(
    old: SemiDiscrete,
    new: SemiDiscrete,
    u: np.ndarray,
    samples: CellSamples | None = None,
    operator: Operator | None = None,
    factor: Factor | None = None,
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
        operator: with the pattern of the new mesh, whose matrix this changes; None: one is made.
        factor: of its matrices; None: one is made.

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
    means = _mean_dilatation(old.problem.space, u) if averaged else NO_MEANS
    samples = samples or CellSamples(old.problem.space, space)
    forces = samples.lacking_forces(np.ascontiguousarray(u), start, moduli, means)
    right = np.where(new.constrained, 0.0, forces)
    if operator is None:
        operator, factor = _operator_of(stiffness, new.constrained), None
    matrix = operator.assemble([stiffness.term(np.zeros_like(right))], None)
    lame, shear = stiffness.parameters[..., :2].T
    complete = right.size <= FACTORED or bool(np.any(lame > STIFF * shear))
    more = _solved(matrix, factor(matrix) if factor else None, right, complete)
    return start + more if np.isfinite(more).all() else start


def _mean_dilatation(old: Space, u: np.ndarray) -> np.ndarray:
    """Means (ne,) of the dilatation of u (n, 2) over the cells of a mesh."""
    own = CellSamples(old, old)
    (xa, ya, ua, va), (xb, yb, ub, vb) = own.along(np.concatenate([old.X, u], axis=1)).transpose(1, 3, 0, 2)
    # The dilatation times the area, and the area, by weights.
    changes = own.weights @ (ua * yb - ub * ya + vb * xa - va * xb)
    return changes / (own.weights @ (xa * yb - xb * ya))


def _operator_of(stiffness: Integral, constrained: np.ndarray) -> Operator:
    """An operator for the stiffness alone."""
    operator = Operator(PETSc.COMM_SELF, 2, np.array([0, len(constrained)], dtype=np.int32))
    operator.set_topology([stiffness.entities], constrained.astype(np.uint8))
    return operator


def _solved(matrix: PETSc.Mat, pc: PETSc.PC | None, right: np.ndarray, complete: bool) -> np.ndarray:
    """Displacements (n, 2) of forces (n, 2) [N], 0 where constrained; not numbers where there are none.

    By a preconditioner of the matrix, or, where there is none, by a `complete` factor or an incomplete one.
    """
    found = np.zeros_like(right)
    b, x = (PETSc.Vec().createWithArray(one, comm=PETSc.COMM_SELF) for one in (right, found))
    ksp = PETSc.KSP().create(PETSc.COMM_SELF)
    ksp.setType("cg")
    if pc is not None:
        ksp.setPC(pc)
    elif complete:
        ksp.getPC().setType("cholesky")
        order_factor(ksp.getPC())
    else:
        ksp.getPC().setType("icc")
        ksp.getPC().setFactorLevels(1)
        ksp.getPC().setFactorShift(PETSc.Mat.FactorShiftType.POSITIVE_DEFINITE)
    ksp.setTolerances(rtol=NEAR, atol=0.0, max_it=MOST)
    ksp.setOperators(matrix)
    ksp.solve(b, x)
    # What the most iterations have reached is nearer than nothing; what broke down is not known to be.
    reason = ksp.getConvergedReason()
    if reason < 0 and reason != PETSc.KSP.ConvergedReason.DIVERGED_MAX_IT:
        found.fill(np.nan)
    free(ksp, b, x)
    return found
