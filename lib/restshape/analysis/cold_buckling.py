"""Buckling with nothing kept: new pattern, new values, and another library's eigensolver."""

from typing import Protocol

import numpy as np
import scipy.sparse as sp
from petsc4py import PETSc
from scipy.sparse.linalg import LinearOperator, eigsh, splu

from restshape.algebra.gather import System, matrix_difference, whole_matrix
from restshape.algebra.operator import Operator
from restshape.mesh.mesh import Mesh
from restshape.physics.elasticity.geometric_stiffness import GeometricStiffness
from restshape.physics.elasticity.plane_solid import PlaneSolid


class Buckled(Protocol):
    """What is compared: a `BucklingAnalysis` that has just been solved."""

    mesh: Mesh
    physics: PlaneSolid
    geometric: GeometricStiffness
    sign: float
    x: np.ndarray
    load_factors: np.ndarray
    whole: list[Operator]

    def system(self) -> System:
        """Matrix and solution as they stand."""

    def cold_system(self) -> System:
        """Matrix and solution from nothing."""


def cold_differences(analysis: Buckled) -> tuple[float, float]:
    """Largest differences of the entries of K and G, and of displacement and load factors, from a cold solve.

    Entries relative to the largest; of G at the same displacement. Displacements in the energy norm.
    """
    hot, cold = analysis.system(), analysis.cold_system()
    kept = whole_matrix(analysis.whole[0].mat, PETSc.COMM_SELF)
    entries = max(matrix_difference(hot.matrix, cold.matrix), matrix_difference(kept, _geometric(analysis, analysis.x)))
    error = hot.solution - cold.solution
    distance = float(np.sqrt(max(0.0, error @ (cold.matrix @ error)) / (2.0 * hot.energy))) if hot.energy else 0.0
    free = np.flatnonzero(analysis.physics.mask.ravel() == 0)
    u = cold.solution.reshape(-1, 2) + analysis.physics.prescribed
    stiffness, geometric = (part[free][:, free] for part in (cold.matrix, _geometric(analysis, u)))
    found = analysis.load_factors
    if len(found):
        distance = max(distance, float(np.max(np.abs(found / cold_load_factors(stiffness, geometric, len(found)) - 1))))
    return entries, distance


def cold_load_factors(stiffness: sp.csr_matrix, geometric: sp.csr_matrix, count: int) -> np.ndarray:
    """The `count` lowest positive load factors (count,), ascending, of K and G of free unknowns, by ARPACK."""
    inverse = LinearOperator(stiffness.shape, splu(stiffness.tocsc()).solve)
    start = np.random.default_rng(11).uniform(-1.0, 1.0, stiffness.shape[0])
    values = eigsh(-geometric, count, stiffness, which="LA", Minv=inverse, v0=start, return_eigenvectors=False)
    return 1.0 / np.sort(values)[::-1]


def _geometric(analysis: Buckled, u: np.ndarray) -> sp.csr_matrix:
    """G of a displacement u (n, 2) on a new pattern."""
    mesh, part = analysis.mesh, analysis.geometric
    operator = Operator(PETSc.COMM_SELF, 2, np.array([0, len(mesh.X)], dtype=np.int32), "coo", False)
    operator.set_topology([mesh.cells], analysis.physics.mask)
    terms = [(0, part.element, mesh.X, np.zeros_like(u), part.params(u), analysis.sign)]
    return whole_matrix(operator.assemble(terms, None), PETSc.COMM_SELF)
