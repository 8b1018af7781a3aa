"""An equilibrium of cloth beside that of a cold solve."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from restshape.algebra.gathering import gather_matrix, matrix_difference
from restshape.analysis.analysis import Comparison
from restshape.physics.cloth.problem import ClothProblem
from restshape.physics.cloth.relaxation.equilibrium import EquilibriumSolver
from restshape.physics.cloth.relaxation.report import ConvergenceReport
from restshape.physics.cloth.relaxation.state import RelaxationState
from restshape.physics.cloth.scene import cloth_arguments, cloth_problem

FARTHER = 0.01
"""Part of the tolerance to which a cold solve goes on."""


def compare_cold(state: RelaxationState, make_solver: Callable[[ClothProblem, str], EquilibriumSolver]) -> Comparison:
    """How far tangent and positions are from those of a cold solve, on a new problem with the same friction.

    Entries by the largest one. Positions from those to which Newton's method goes on, by the forces over the weight
    that the difference takes, for that is what equilibria are measured by.

    Args:
        state: of the last equilibrium.
        make_solver: of a problem, and a prefix of options in PETSc's database.
    """
    solver, comm = state.solver, state.solver.comm
    cold = make_solver(_cold_problem(state), "drape_cold_")
    warm, fresh = (gather_matrix(each.newton.tangent(state.x), comm) for each in (solver, cold))
    x, goal = state.x.copy(), solver.goal
    cold.goal = FARTHER * goal
    found = cold.refine(x, ConvergenceReport())
    # Loose cloth turns on its way; the mean of both tangents is good to third order.
    mean = 0.5 * (fresh + gather_matrix(cold.newton.tangent(x), comm))
    forces = (mean @ (state.x - x).ravel()).reshape(x.shape) * state.problem.boundary.free
    distance = float(np.linalg.norm(forces)) / solver.scale(state.x) if found else cold.residual_norm(x)
    if not state.report.converged:
        # It says so, and how far it is: no farther it must be.
        distance *= min(1.0, goal / state.report.residual)
    cold.destroy()
    return Comparison(matrix_difference(warm, fresh), distance)


def _cold_problem(state: RelaxationState) -> ClothProblem:
    """The problem of this frame set up again, with the same history of friction."""
    mesh = state.problem.mesh
    problem = cloth_problem(mesh, cloth_arguments(state.scene, state.plan, mesh))
    if problem.contact:
        problem.contact.history = state.problem.contact.history
    return problem
