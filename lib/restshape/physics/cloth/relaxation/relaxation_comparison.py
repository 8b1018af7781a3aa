"""An equilibrium of cloth beside that of a cold solve."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from restshape.algebra.factors.gathering import gather_matrix, matrix_difference
from restshape.analysis.analysis import Comparison
from restshape.errors import ReplayProblem
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.relaxation.equilibrium import EquilibriumSolver
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport
from restshape.physics.cloth.relaxation.state import RelaxationState
from restshape.physics.cloth.scene import cloth_arguments, cloth_problem

FARTHER = 0.01
"""Part of the tolerance to which a cold solve goes on."""
PERTURBATIONS = (1e-4, 1e-5, 1e-6)
"""Largest displacements that a cold solve starts with, over the size of the cloth: where folds do not come back from
one, it starts again from the next."""
LOOSE = 10.0
"""Distance over the size of the cloth that places may have, over the tolerance of forces: folds are loose."""

MakeSolver = Callable[[ClothProblem, str], EquilibriumSolver]


def compare_cold(state: RelaxationState, make_solver: MakeSolver) -> Comparison:
    """How far tangent, positions and energies are from those of a cold solve, on a new problem with the same friction.

    Newton's method starts from perturbed positions and goes on farther than the state. Entries by the largest one;
    positions by the forces over the weight that the difference takes, for that is what equilibria are measured by, and
    by the largest distance over the size of the cloth; energies by the sum of their sizes.

    Args:
        state: of the last equilibrium.
        make_solver: of a problem, and a prefix of options in PETSc's database.

    Raises:
        ReplayProblem: Newton's method comes back from none of the perturbed positions.
    """
    solver, comm = state.solver, state.solver.comm
    cold = make_solver(_cold_problem(state), "drape_cold_")
    warm, fresh = (gather_matrix(each.newton.tangent(state.x), comm) for each in (solver, cold))
    entries = matrix_difference(warm, fresh)
    try:
        x = _restarted(state, cold)
        # Loose cloth turns on its way; the mean of both tangents is good to third order.
        mean = 0.5 * (fresh + gather_matrix(cold.newton.tangent(x), comm))
        forces = (mean @ (state.x - x).ravel()).reshape(x.shape) * state.problem.boundary.free
        # Without what the cold solve may leave itself.
        distance = float(np.linalg.norm(forces)) / solver.scale(state.x) / (1.0 + FARTHER)
        if not state.report.converged:
            # It says so, and how far it is: no farther it must be.
            return Comparison(entries, distance * min(1.0, solver.goal / state.report.residual))
        places = np.abs(state.problem.corners(state.x) - cold.problem.corners(x)).max() / _size(state)
        return Comparison(entries, max(distance, float(places) / LOOSE, _energy_difference(state, cold.problem, x)))
    finally:
        cold.destroy()


def _restarted(state: RelaxationState, cold: EquilibriumSolver) -> np.ndarray:
    """The positions (n, 3) [m] to which a cold solve comes back from perturbed ones."""
    # The same on every rank, and in every replay.
    noise = np.random.default_rng(7).uniform(-1.0, 1.0, state.x.shape) * state.problem.boundary.free
    noise[len(state.mesh.X) :] = 0.0
    cold.goal = FARTHER * state.solver.goal
    for part in PERTURBATIONS:
        way = part * _size(state) * noise
        # From the other side of a layer it would come back to another rest.
        x = state.x + state.problem.step_share(state.x, way) * way
        if cold.refine(x, ConvergenceReport()):
            return x
    raise ReplayProblem("the cloth does not come back from perturbed positions")


def _size(state: RelaxationState) -> float:
    """The larger side [m] of the box around the pattern."""
    return float(np.ptp(state.mesh.X, axis=0).max())


def _energy_difference(state: RelaxationState, cold: ClothProblem, x: np.ndarray) -> float:
    """The largest difference of the energies from those at cold positions x (n, 3), over the sum of their sizes."""

    def energies(problem: ClothProblem, x: np.ndarray) -> np.ndarray:
        return np.array([problem.energy(x), problem.membrane_energy(x), problem.bending_energy(x)])

    kept, reference = energies(state.problem, state.x), energies(cold, x)
    size, found = float(np.abs(reference).sum()), float(np.abs(kept - reference).max())
    return found / size if size else found


def _cold_problem(state: RelaxationState) -> ClothProblem:
    """The problem of this frame set up again, with the same history of friction."""
    mesh = state.problem.mesh
    problem = cloth_problem(mesh, cloth_arguments(state.scene, state.plan, mesh))
    if problem.contact:
        problem.contact.history = state.problem.contact.history
    if problem.self_contact:
        problem.self_contact.history = state.problem.self_contact.history
    return problem
