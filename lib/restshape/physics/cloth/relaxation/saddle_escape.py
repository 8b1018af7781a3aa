"""Stability of an equilibrium of cloth, and how one that is not stable is left."""

import numpy as np
from petsc4py import PETSc

from restshape.algebra.gathering import whole_cholesky
from restshape.errors import ReplayProblem
from restshape.physics.cloth.relaxation.equilibrium import STIFFER, EquilibriumSolver

MOST_INERTIA = 1e13
"""Inertia over that of descents above which there is no use in more."""
INVERSE_STEPS, LEAP = 4, 1e-3
"""Steps of the inverse iteration for the lowest mode of an unstable equilibrium; how far that is left along it, over
the size of the cloth."""
DOUBLINGS = 8
"""Doublings of that way at most, while the energy falls."""
FAINT = 1e-4
"""Inertia over that of descents below which an unstable motion is too slow to be one."""


class SaddleEscape:
    """Whether equilibria of one cloth are stable, and leaves those that are not.

    Args:
        solver: of the equilibria.

    Source: docs/theory/cloth.md.
    """

    def __init__(self, solver: EquilibriumSolver) -> None:
        self.solver = solver

    def is_stable(self, x: np.ndarray) -> bool:
        """Whether the true tangent at x (n, 3) is positive definite, by a factor of all of it on each rank."""
        solver = self.solver
        if solver.comm.size == 1:
            return solver.newton.definite(x)
        matrix, pc = whole_cholesky(solver.newton.tangent(x), solver.comm)
        negative, zero, _ = pc.getFactorMatrix().getInertia()
        for part in (pc, matrix):
            part.destroy()
        return negative == 0 and zero == 0

    def escape(self, x: np.ndarray) -> bool:
        """Leave an unstable equilibrium x (n, 3), which is changed, along its lowest mode; False where it is stable."""
        solver, equations = self.solver, self.solver.equations
        inertia = least = FAINT * equations.supporting_inertia
        most = MOST_INERTIA * equations.supporting_inertia
        while not solver.linear.definite(matrix := equations.true_tangent(x, inertia), solver.places, False):
            inertia *= STIFFER
            if inertia > most:
                # What has no mass is not supported by any.
                return False
        if inertia == least:
            return False
        mode = self._lowest_mode(matrix)
        sides = [x + solver.problem.step_share(x, way) * way for way in (mode, -mode)]
        best = self._far(x, min(sides, key=solver.problem.energy) - x)
        if not mode.any() or not solver.is_valid(best):
            return False
        x[:] = best
        return True

    def _far(self, x: np.ndarray, way: np.ndarray) -> np.ndarray:
        """Positions (n, 3) so far from x (n, 3) along a way (n, 3) that the energy falls no more, by doubling it."""
        problem, energy = self.solver.problem, self.solver.problem.energy(x + way)
        for _ in range(DOUBLINGS):
            farther = 2.0 * way
            if problem.step_share(x, farther) < 1.0 or not (found := problem.energy(x + farther)) < energy:
                break
            way, energy = farther, found
        return x + way

    def _lowest_mode(self, matrix: PETSc.Mat) -> np.ndarray:
        """The lowest mode (n, 3) of a definite tangent, as long as the way off a saddle [m]; 0 where none is found."""
        solver, problem = self.solver, self.solver.problem
        nodal, mass = solver.moving.nodal, solver.equations.mass
        rows = nodal.vector(), nodal.vector()
        mode = np.random.default_rng(0).uniform(-1.0, 1.0, (problem.n_nodes, 3)) * problem.boundary.free
        try:
            for _ in range(INVERSE_STEPS):
                nodal.put(mass[:, None] * mode, rows[0])
                rows[1].set(0.0)
                solver.linear.solve(matrix, *rows, False, same_matrix=True, places=solver.places, auxiliary=True)
                mode = nodal.values(rows[1]).copy()
                if not (size := np.abs(problem.corners(mode)).max()):
                    break
                mode *= LEAP * problem.size / size
        except ReplayProblem:
            mode = np.zeros_like(mode)
        finally:
            for row in rows:
                row.destroy()
        return mode
