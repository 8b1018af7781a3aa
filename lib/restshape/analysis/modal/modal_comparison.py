"""What the modes of a frame differ by from those of a solve with nothing kept."""

from dataclasses import dataclass

import numpy as np
from petsc4py import PETSc

from restshape.algebra.eigenproblems.clusters import CLUSTER, clusters
from restshape.algebra.eigenproblems.krylov_schur import krylov_schur
from restshape.algebra.eigenproblems.pencil import Deflation, Pencil
from restshape.algebra.factors.gathering import gather_matrix, matrix_difference
from restshape.analysis.analysis import Comparison, Context
from restshape.analysis.modal.modal_matrices import ModalMatrices
from restshape.analysis.modal.modal_state import ModalState, frequencies
from restshape.analysis.modal.mode_search import MOST_BESIDE, chosen_modes
from restshape.analysis.settings import modal_settings
from restshape.fem.eigenproblem import Eigenproblem, Maker
from restshape.first_use import made

COLD = 1e-10
"""Residual that a cold solve for comparison goes down to."""
TOLERANCE = 1e-6
"""Differences of frequencies, subspaces and participations that a solve may leave."""
ROUNDING = float(np.finfo(float).eps)
"""Of the entries of K, where a slender body's eigenvalues are far below the square of its elements' frequencies."""
THESIS = 4.0
"""Times the tolerance whose square modes of the thesis's inverse iteration may differ by, which ends at its residual;
Davidson's and Krylov and Schur's go beyond theirs."""
BEYOND = 2
"""Modes above those of the state that a cold solve looks for: where two are about to cross, their ranks may differ."""


def compare_cold(state: ModalState, context: Context, make: Maker) -> Comparison:
    """Largest differences of the matrices' entries and of the modes from a solve with nothing kept; relative.

    Of the modes that the scene asks for: of the frequencies, by rank among those asked for; and of each cluster of
    eigenvalues that holds one, of its subspace and of its participation.
    """
    body = make(state.scene, state.plan, made(state.space), context.policy.lumped_mass)
    cold = ModalMatrices(PETSc.COMM_SELF, body).assemble()
    pairs = zip(state.matrices.gather(), (gather_matrix(mat, PETSc.COMM_SELF) for mat in cold))
    entries = max(matrix_difference(*pair) for pair in pairs)
    solved = _solved(state, body, _pencil(state, context, cold))
    rounding = _rounding(state, cold[0])
    width = cluster_width(context.policy.solver, state.scene.solve.tolerance)
    subspaces = _subspace_difference(state, solved, width)
    return Comparison(entries, max(_frequency_difference(state, solved, rounding), subspaces))


def allowed(method: str, tolerance: float) -> float:
    """What modes may differ by from cold ones, solved by a method of `EigenSolver` to residuals of this tolerance."""
    return max(TOLERANCE, (THESIS * tolerance) ** 2) if method == "ilu" else TOLERANCE


def cluster_width(method: str, tolerance: float) -> float:
    """Share by which neighbours of a cluster differ at most, of modes solved for as in `allowed`.

    What is left turns modes by its size over the gap of their eigenvalues: the residual of the thesis's inverse
    iteration, and the square of it with the others.
    """
    return max(CLUSTER, (tolerance if method == "ilu" else tolerance**2) / TOLERANCE**0.5)


def cold_frequencies(state: ModalState, context: Context, make: Maker) -> np.ndarray:
    """The frequencies (modes,) [Hz] that the scene asks for, of a solve with nothing kept on the mesh as it lies."""
    body = make(state.scene, state.plan, made(state.space), context.policy.lumped_mass)
    solved = _solved(state, body, _pencil(state, context, ModalMatrices(PETSc.COMM_SELF, body).assemble()))
    return frequencies(solved.values[solved.chosen])


@dataclass(frozen=True, eq=False)
class ColdModes:
    """Modes solved for with nothing kept.

    Args:
        values: (k,) eigenvalues, ascending; mass_products: (k, n f) products M phi of their modes.
        participation: (k,) shares of the kinetic energy out of the plane.
        chosen: indices of those that the scene asks for.
    """

    values: np.ndarray
    mass_products: np.ndarray
    participation: np.ndarray
    chosen: np.ndarray


def _pencil(state: ModalState, context: Context, matrices: tuple[PETSc.Mat, PETSc.Mat]) -> Pencil:
    """K and M, factored below the lowest eigenvalue."""
    pencil = Pencil(context.stages)
    pencil.set_matrices(*matrices, True)
    pencil.factor(-1e-2 * float(state.modes.values[0]))
    return pencil


def _solved(state: ModalState, body: Eigenproblem, pencil: Pencil) -> ColdModes:
    """As many of the lowest modes as the state has, and more until those that the scene asks for are among them."""
    settings, count = modal_settings(state.plan), state.count + BEYOND
    while True:
        found = krylov_schur(pencil, Deflation(body.free_rigid_motions(), pencil), None, count, COLD)
        mass_products = np.empty_like(found.modes)
        pencil.apply(pencil.mass, found.modes, mass_products)
        participation = body.normal_participation(found.modes, mass_products)
        known = np.arange(len(participation)) < count
        chosen = chosen_modes(body, settings.modes, settings.in_plane, participation, known)
        if len(chosen) >= len(state.modes.chosen) or count > state.count + MOST_BESIDE:
            return ColdModes(found.values, mass_products, participation, chosen)
        count += BEYOND


def _rounding(state: ModalState, stiffness: PETSc.Mat) -> np.ndarray:
    """What rounding may do to the frequencies (modes,), relative: to phi K phi over its value, halved by the root."""
    modes = state.modes
    sizes = (modes.vectors[modes.chosen] ** 2).sum(axis=1)
    largest = stiffness.norm(PETSc.NormType.NORM_INFINITY)
    return 0.5 * ROUNDING * largest * sizes / np.abs(modes.values[modes.chosen])


def _frequency_difference(state: ModalState, cold: ColdModes, rounding: np.ndarray) -> float:
    """The largest relative difference of frequencies beyond rounding; infinite where there are more or fewer."""
    reference = frequencies(cold.values[cold.chosen])
    if len(reference) != len(state.frequencies):
        return float("inf")
    return float(np.max(np.maximum(np.abs(state.frequencies / reference - 1.0) - rounding, 0.0)))


def _subspace_difference(state: ModalState, cold: ColdModes, width: float) -> float:
    """The largest difference of subspaces, 1 - cos^2 of the angle to the cold ones, and of the participation in them.

    Clusters are those of the modes solved for, see `cluster_width`; each must lie in the cold clusters that hold the
    modes nearest to it. Where these are no more than it has, the mean participations are compared.
    """
    modes, worst = state.modes, 0.0
    cold_clusters = clusters(cold.values, width)
    for cluster in clusters(modes.values[: state.count], width):
        if not np.isin(cluster, modes.chosen).any():
            continue
        overlap = cold.mass_products @ modes.vectors[cluster].T
        nearest = np.argsort(-(overlap**2).sum(axis=1))[: len(cluster)]
        whole = np.concatenate([part for part in cold_clusters if np.isin(part, nearest).any()])
        cosine = float(np.linalg.svd(overlap[whole], compute_uv=False)[-1])
        worst = max(worst, abs(1.0 - cosine**2))
        if len(whole) == len(cluster):
            share = abs(modes.participation[cluster].mean() - cold.participation[whole].mean())
            worst = max(worst, float(share))
    return worst
