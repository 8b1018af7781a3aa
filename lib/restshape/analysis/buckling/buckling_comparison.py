"""Buckling beside a solve with nothing kept: new pattern, new values, and another library's eigensolver."""

import numpy as np
import scipy.sparse as sp
from petsc4py import PETSc
from scipy.sparse.linalg import LinearOperator, eigsh, splu

from restshape.algebra.factors.gathering import GatheredSystem, gather_matrix, matrix_difference
from restshape.algebra.operator import Operator
from restshape.analysis.analysis import Comparison
from restshape.analysis.buckling.buckling_state import BucklingState
from restshape.analysis.comparison import energy_distance
from restshape.fem.assembled import Assembled
from restshape.first_use import made

ROUNDING = 4.0 * float(np.finfo(float).eps)
"""Of an entry of K, a sum over elements; it counts where a slender body bends far more easily than these do."""


def compare_cold(state: BucklingState, warm: GatheredSystem, cold: GatheredSystem, least: float) -> Comparison:
    """Largest differences of the entries of K and G, and of displacement and load factors, from a cold solve.

    Entries relative to the largest; of G at the same displacement. Displacements in the energy norm.

    Args:
        state: solved on the mesh as it lies.
        warm, cold: the system of its equilibrium, as it was solved and from nothing.
        least: of the norm of displacements, as of `comparison.energy_distance`.
    """
    prebuckling, found = state.prebuckling, state.modes.load_factors
    matrices = made(state.matrices)
    kept = gather_matrix(matrices.geometric, matrices.share.comm)
    entries = max(
        matrix_difference(warm.matrix, cold.matrix), matrix_difference(kept, _geometric(state, prebuckling.x))
    )
    distance = energy_distance(cold.matrix, warm.solution, cold.solution, warm.energy, least)
    if len(found):
        off = np.abs(found / load_factors_of(state, cold) - 1.0) - _rounding(state, cold.matrix)
        # What is not a number stays none.
        distance = float(np.max([distance, *off]))
    return Comparison(entries, distance)


def _rounding(state: BucklingState, stiffness: sp.csr_matrix) -> np.ndarray:
    """What rounding may do to the load factors (modes,), relative: to phi K phi over its value.

    Entries of K are rounded each for itself, so that their errors add up by squares.
    """
    modes = state.modes.vectors[: len(state.modes.load_factors)]
    energies = np.einsum("mn,nm->m", modes, stiffness @ modes.T)
    squares = np.einsum("mn,nm->m", modes**2, stiffness.multiply(stiffness) @ (modes**2).T)
    return ROUNDING * np.sqrt(squares) / energies


def load_factors_of(state: BucklingState, cold: GatheredSystem) -> np.ndarray:
    """As many load factors (k,), ascending, as a state has, solved for with nothing kept at a cold equilibrium."""
    boundary = state.prebuckling.problem.boundary
    free = np.flatnonzero(boundary.mask.ravel() == 0)
    u = cold.solution.reshape(boundary.values.shape) + boundary.values
    stiffness, geometric = (part[free][:, free] for part in (cold.matrix, _geometric(state, u)))
    return cold_load_factors(stiffness, geometric, len(state.modes.load_factors))


def cold_load_factors(stiffness: sp.csr_matrix, geometric: sp.csr_matrix, count: int) -> np.ndarray:
    """The `count` lowest positive load factors (count,), ascending, of K and G of free unknowns, by ARPACK."""
    inverse = LinearOperator(stiffness.shape, splu(stiffness.tocsc()).solve)
    start = np.random.default_rng(11).uniform(-1.0, 1.0, stiffness.shape[0])
    values = eigsh(-geometric, count, stiffness, which="LA", Minv=inverse, v0=start, return_eigenvectors=False)
    return 1.0 / np.sort(values)[::-1]


def _geometric(state: BucklingState, u: np.ndarray) -> sp.csr_matrix:
    """G of a displacement u (n, 2) on a new pattern."""
    problem = state.prebuckling.problem
    operator = Operator(PETSc.COMM_SELF, u.shape[1], np.array([0, len(u)], dtype=np.int32), symmetric=False)
    operator.set_topology([problem.space.cells], problem.boundary.mask)
    assembled = Assembled([problem.geometric_stiffness(u, state.sign)], operator)
    return gather_matrix(assembled.tangent(np.zeros_like(u)), PETSc.COMM_SELF)
