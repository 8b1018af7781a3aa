"""Stability of an equilibrium of cloth, and how one that is not stable is left."""

from collections.abc import Iterator
from contextlib import contextmanager, nullcontext

import numpy as np
from petsc4py import PETSc

from restshape.algebra.factors.shared_factor import NO_FACTOR, SharedFactor
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
        """Whether the true tangent at x (n, 3) is positive definite, by a complete factor, which ranks share."""
        if self.solver.comm.size == 1:
            return self.solver.newton.definite(x)
        with shared_factor() as factor:
            return self._definite(self.solver.newton.tangent(x), factor)

    def _definite(self, matrix: PETSc.Mat, factor: SharedFactor | None) -> bool:
        """Whether a matrix is positive definite: by a factor that ranks share, or on one rank that of the solver."""
        if factor is None:
            return self.solver.linear.definite(matrix, self.solver.places, False)
        try:
            return factor.make(matrix, matrix, 0.0) == 0
        except ReplayProblem as problem:
            if str(problem) != NO_FACTOR:
                # One that is too large shows nothing.
                raise
            return False

    def escape(self, x: np.ndarray) -> bool:
        """Leave an unstable equilibrium x (n, 3), which is changed, along its lowest mode; False where it is stable."""
        with shared_factor() if self.solver.comm.size > 1 else nullcontext() as factor:
            return self._escape(x, factor)

    def _escape(self, x: np.ndarray, factor: SharedFactor | None) -> bool:
        solver, equations = self.solver, self.solver.equations
        inertia = least = FAINT * equations.supporting_inertia
        most = MOST_INERTIA * equations.supporting_inertia
        while not self._definite(matrix := equations.true_tangent(x, inertia), factor):
            inertia *= STIFFER
            if inertia > most:
                # What has no mass is not supported by any.
                return False
        if inertia == least:
            return False
        mode = self._lowest_mode(matrix, factor)
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

    def _lowest_mode(self, matrix: PETSc.Mat, factor: SharedFactor | None) -> np.ndarray:
        """The lowest mode (n, 3) of a definite tangent, as long as the way off a saddle [m]; 0 where none is found."""
        solver, problem = self.solver, self.solver.problem
        nodal, mass = solver.moving.nodal, solver.equations.mass
        rows = nodal.vector(), nodal.vector()
        mode = np.random.default_rng(0).uniform(-1.0, 1.0, (problem.n_nodes, 3)) * problem.boundary.free
        try:
            for _ in range(INVERSE_STEPS):
                nodal.put(mass[:, None] * mode, rows[0])
                if factor:
                    factor.solve(*rows)
                else:
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


@contextmanager
def shared_factor() -> Iterator[SharedFactor]:
    """A factor of tangents that ranks share, in blocks of nodes as that of one rank."""
    factor = SharedFactor(3)
    try:
        yield factor
    finally:
        factor.forget()
