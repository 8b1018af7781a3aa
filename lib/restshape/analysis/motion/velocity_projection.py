"""Velocities projected to a new mesh without loss of momentum."""

from typing import cast

import numpy as np

from restshape.algebra.operator import Operator
from restshape.analysis.motion.new_mesh_samples import CellSamples
from restshape.fem.mass import CONVERGED, ConsistentMass, MassMatrix
from restshape.mesh.mesh import Mesh
from restshape.mesh.transfer import Transfer

ROUGH = 1e-3
"""Residual of the uniform velocities over their right sides: whatever is left, they make up for all momentum that is
missing, which is little."""


def project_velocity(
    old: MassMatrix,
    new: MassMatrix,
    v: np.ndarray,
    samples: CellSamples | None = None,
    operator: Operator | None = None,
) -> np.ndarray:
    """Velocities (n_new, 2) [m/s] on a new mesh: the projection of v with the mass matrix, with v's momentum.

    M_new v_new = integral of N_new rho v, on the new mesh by the rule of the three edge midpoints, of second order by
    one of 16 points (`quadrature.SAMPLES`). What is then missing of the momentum (the rule's error, and what lies
    between two outlines) is made up for by the smallest change in the norm of the mass matrix: multiples of the
    projections of uniform velocities along x and y. Prescribed nodes rest.

    Args:
        old, new: on the mesh before and on the new one.
        v: (n_old, 2) velocities [m/s].
        samples: of both meshes, which second order needs; None: they are made.
        operator: with the pattern of the new mesh, whose matrix this changes; None: one is made.

    Source: docs/theory/solids.md.
    """
    mesh = new.space
    if mesh.cells.shape[1] == 6:
        load = (samples or CellSamples(old.space, mesh)).momenta(np.ascontiguousarray(v), new.params)
    else:
        load = _linear_load(old, new, v)
    inertia, free = ConsistentMass(new.problem, operator), new.problem.boundary.mask == 0
    projected = inertia.solve(load * free, CONVERGED)
    uniform = inertia.solve(new.apply(np.ones_like(mesh.X)) * free, ROUGH)
    missing, reach = old.momentum(v) - new.momentum(projected), new.momentum(uniform)
    return projected + uniform * np.divide(missing, reach, out=np.zeros(2), where=reach > 0)


def _linear_load(old: MassMatrix, new: MassMatrix, v: np.ndarray) -> np.ndarray:
    """Integral of N_new rho v (n_new, 2) by the rule of the edges' midpoints."""
    # Cells of three nodes are those of the mesh itself.
    mesh = cast(Mesh, new.space)
    starts, ends = mesh.edge_nodes.T
    middle = Transfer(old.space, 0.5 * (mesh.X[starts] + mesh.X[ends]), close=True)(v)
    (ax, ay), (bx, by), (cx, cy) = mesh.X[mesh.cells].transpose(1, 2, 0)
    area = 0.5 * ((bx - ax) * (cy - ay) - (by - ay) * (cx - ax))
    mass = area * np.broadcast_to(new.params, (len(mesh.cells), 1))[:, 0]
    # A third of a cell's mass counts at the middle of each of its edges, where both ends' functions are one half.
    at_edges = np.bincount(mesh.cell_edges.ravel(), np.repeat(mass / 6.0, 3), len(middle))
    n = len(mesh.X)
    parts = [middle[:, a] * at_edges for a in (0, 1)]
    return np.column_stack([np.bincount(starts, part, n) + np.bincount(ends, part, n) for part in parts])
