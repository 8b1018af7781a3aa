"""Newton's method for cloth near its rest, with tensions as unknowns of their own: large steps do not mislead it."""

from __future__ import annotations

import logging
from collections.abc import Generator

import numpy as np

from restshape.fem.assembled import Assembled
from restshape.fem.problem import INTERNAL
from restshape.physics.cloth.relaxation.equilibrium import EquilibriumSolver
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport
from restshape.physics.cloth.relaxation.saddle_escape import SaddleEscape

log = logging.getLogger("restshape.physics")

EXACT = 1e-3
"""Part of the forces that a linear solve may leave."""
MOST, FEW, PATIENCE, BETTER = 40, 6, 7, 0.7
"""Steps; those in a frame that is left out, see `Tries`; steps in a row that leave more than a part of the least forces
so far, after which it is given up."""
SELDOM = 5
"""Steps in a row without a definite true tangent, from which on it is tried in one of as many."""
RECOVERED = 4
"""Steps after which the energy that the first one has brought in by the stretch of what it turns is to be out again."""
NEAR_SADDLE, CREEPING, ESCAPES = 1e-2, 5e-2, 2
"""Residual over load at which a tangent that is not definite shows a saddle nearby; that at which it does so where a
step has left more than a part of the least forces so far; saddles that are left."""


class MixedNewton:
    """Newton's method whose tangent has tensions that are followed along its steps, to first order.

    A step d along the tangent stretches cloth that turns by the square of d, and the tension of that stretch makes the
    next tangent much too stiff. Tensions of their own, of the mixed form of the same equations, do not have it; what is
    converged to is the same.

    Args:
        solver: of the equilibria, whose linear solver keeps its factor.
        report: counts steps, factors and iterations.
        tensions: (ne, 3) [N/m] to begin with, as of cloth whose material has moved; None: those where it begins.

    Attributes:
        lost: the last step had a tangent without compression: the true one is not positive definite there,
            or was not when it was tried last.

    Source: docs/theory/cloth.md; Magisano, Leonetti and Garcea, Comput. Methods Appl. Mech. Engrg. 313 (2017) 986.
    """

    def __init__(
        self, solver: EquilibriumSolver, report: ConvergenceReport, tensions: np.ndarray | None = None
    ) -> None:
        self.solver, self.problem, self.report = solver, solver.problem, report
        self.lost, self._since = False, 0
        # Other laws are no polynomials of the positions.
        self._follows = self.problem.fabric.law == "stvk"
        self._tensions = tensions if self._follows else None

    def way(self, x: np.ndarray, forces: np.ndarray, given: np.ndarray, norm: float | None = None) -> np.ndarray | None:
        """The step (n, 3) [m] from x (n, 3) that takes away forces (n, 3) [N] while prescribed unknowns go as given.

        Args:
            x: unknowns.
            forces: at them.
            given: (n, 3) [m], 0 where nothing is prescribed.
            norm: residual over load; far from rest a true tangent that has not been definite for some steps is left out
                in most of the next ones. None: it is tried.

        Returns: None where neither the tangent nor the one without compression has a solution.
        """
        solver, problem = self.solver, self.problem
        right = -forces
        if given.any():
            right -= Assembled(problem.integrals(INTERNAL)).tangent_product(x, given)
        right *= problem.boundary.free
        far = norm is not None and norm > NEAR_SADDLE
        left_out = far and self._since >= SELDOM and self._since % SELDOM != 0
        for stabilised in (True,) if left_out else (False, True):
            matrix = solver.equations.mixed_tangent(x, self._tensions, stabilised)
            d = solver.newton.solve_linear(matrix, right, EXACT)
            iterations, factors = solver.newton.linear_work
            self.report.iterations, self.report.factors = (
                self.report.iterations + iterations,
                self.report.factors + factors,
            )
            if d is not None and np.isfinite(d).all():
                self.lost, self._since = stabilised, self._since + 1 if stabilised else 0
                return d * problem.boundary.free + given
        return None

    def go(self, x: np.ndarray, d: np.ndarray) -> np.ndarray:
        """Positions (n, 3) [m] after as much of a step d (n, 3) from x (n, 3) as nothing passes."""
        problem = self.problem
        share = problem.step_share(x, d)
        reached = x + share * d
        if self._follows:
            # Strains are quadratic in positions: what is linear in the step is all but those of the step itself.
            square = problem.tensions(d) - problem.tensions(np.zeros_like(d))
            self._tensions = problem.tensions(reached) - share**2 * square
        self.report.newton, self.report.steps = self.report.newton + 1, self.report.steps + 1
        return reached

    def converge(self, x: np.ndarray, most: int = MOST, begun: float = np.inf) -> tuple[np.ndarray | None, bool]:
        """The equilibrium near x (n, 3) with friction that has followed, and whether it is found in few steps.

        Else the positions with the least energy; None where supports did not get where they are, or where the energy
        is above that which the cloth begins with: steps have torn it.

        Args:
            most: steps at most.
            begun: energy [J] where the cloth begins. It must be below that after `RECOVERED` steps.
        """
        steps = self.steps(x, most, begun)
        while True:
            try:
                next(steps)
            except StopIteration as end:
                found: tuple[np.ndarray | None, bool] = end.value
                return found

    def steps(
        self, x: np.ndarray, most: int = MOST, begun: float = np.inf
    ) -> Generator[np.ndarray, None, tuple[np.ndarray | None, bool]]:
        """The same by single steps, each of which gives where it leads; the value is what `converge` gives."""
        solver, problem, report = self.solver, self.problem, self.report
        least, since, escapes, forces = np.inf, 0, 0, np.empty_like(x)
        best: tuple[float, np.ndarray | None] = (np.inf, None)
        for taken in range(most):
            given = problem.constrain(x) - x
            problem.residual(x, forces)
            norm = float(np.linalg.norm(forces)) / solver.scale(x)
            solver.on_iterate(solver, x, norm)
            log.debug("    mixed Newton: residual over load %.3e", norm)
            if not np.isfinite(norm):
                break
            if not given.any() and (energy := problem.energy(x)) < best[0]:
                best = energy, x.copy()
            if norm <= solver.goal and not given.any():
                if solver.rests(x, report):
                    return x, True
                problem.residual(x, forces)
                # Friction has followed: these are other equations.
                least, since = np.inf, 0
                best = problem.energy(x), x.copy()
            since = 0 if norm <= BETTER * least else since + 1
            least = min(norm, least)
            saddle = self.lost and norm <= (CREEPING if since else NEAR_SADDLE)
            if saddle and escapes < ESCAPES and SaddleEscape(solver).escape(x):
                log.info("Newton's method from the last rest: a saddle is left along the lowest mode")
                report.saddles += 1
                escapes, least, since, self._tensions = escapes + 1, norm, 0, None
                problem.residual(x, forces)
            torn = taken == RECOVERED and begun < best[0] < np.inf
            if torn or since > PATIENCE or (d := self.way(x, forces, given, norm)) is None:
                break
            x = self.go(x, d)
            yield x
        return best[1] if best[0] <= begun else None, False
