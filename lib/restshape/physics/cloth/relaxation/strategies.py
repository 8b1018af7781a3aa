"""Solution strategies of cloth, by name: the usual one, and those that it is compared with."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Protocol

import numpy as np

from restshape.algebra.nonlinear.descent import Descent
from restshape.algebra.nonlinear.kinetic_damping import KineticDamping
from restshape.errors import ReplayProblem
from restshape.physics.cloth.relaxation.equilibrium import SLIPPING, EquilibriumSolver
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport

Strategy = Callable[[EquilibriumSolver, np.ndarray, int, ConvergenceReport], ConvergenceReport]
FREELY = 1e-7
"""Inertia of plain and stabilised Newton's methods, times the square of `ClothProblem.swing_time`: enough for a factor
where cloth lies loosely."""
ALPHA, BETA = 1.25, 3e-3
"""Rayleigh damping, times and over `ClothProblem.swing_time`: about half of the critical one of a cloth that swings by
half of its size."""
ROUNDS = 200
"""Runs of a method, between which friction follows, after which it is given up."""


class Method(Protocol):
    """Goes to an equilibrium from where it is.

    Attributes:
        uninterrupted: steps of a run at most, after which friction follows; iterations: of CG in the last run.
    """

    @property
    def uninterrupted(self) -> int: ...
    @property
    def iterations(self) -> int: ...
    def run(self, x: np.ndarray, goal: float, most: int) -> float:
        """Go on from x (n, 3), which is changed, to a residual of norm `goal`, in `most` steps; the norm reached."""


def moved(
    solver: EquilibriumSolver, x: np.ndarray, most: int, report: ConvergenceReport, damping: str = "kinetic"
) -> ConvergenceReport:
    """Motion alone, with kinetic damping, until it converges."""
    if damping == "kinetic":
        return _in_rounds(solver, solver.moving, lambda: solver.moving.snes.getIterationNumber(), x, most, report)
    time = solver.problem.swing_time
    steps = replace(solver.motion, damping="rayleigh", alpha=ALPHA / time, beta=BETA * time)
    equations = solver.equations
    moving = KineticDamping(solver.comm, "drape_rayleigh_", equations, equations.mass, x.shape, equations.rows, steps)
    moving.on_step, moving.on_move = solver.moving.on_step, solver.moving.on_move
    moving.step_share = solver.problem.step_share
    try:
        return _in_rounds(solver, moving, lambda: moving.snes.getIterationNumber(), x, most, report)
    finally:
        moving.free()


def descended(
    solver: EquilibriumSolver,
    x: np.ndarray,
    most: int,
    report: ConvergenceReport,
    kind: str,
    stabilised: bool = True,
) -> ConvergenceReport:
    """One kind of SNES alone, until it converges."""
    equations = solver.equations
    equations.stabilised, equations.inertia = stabilised, FREELY / solver.problem.swing_time**2
    reach = solver.motion.reach
    descent = Descent(solver.comm, f"drape_{kind}_", equations, x.shape, equations.rows, kind, reach=reach)
    # Friction follows after each run, however far the cloth slides in it.
    descent.on_step, descent.step_share = solver.note, solver.problem.step_share
    try:
        return _in_rounds(solver, descent, lambda: descent.steps, x, most, report)
    finally:
        equations.stabilised = True
        descent.destroy()


def _in_rounds(
    solver: EquilibriumSolver,
    method: Method,
    steps: Callable[[], int],
    x: np.ndarray,
    most: int,
    report: ConvergenceReport,
) -> ConvergenceReport:
    """Runs of a method from x (n, 3), which is changed, with friction following in between, until all converges."""
    for _ in range(ROUNDS):
        report.slip = solver.problem.update_friction(x)
        report.residual = solver.residual_norm(x)
        if report.residual <= solver.goal and report.slip <= SLIPPING * solver.slip_distance:
            report.converged, report.why = True, ""
            return report
        left = most - report.steps
        before = x.copy()
        try:
            # Without friction that follows cloth would slide off what it lies on.
            norm = method.run(x, solver.goal * solver.scale(x), min(left, method.uninterrupted))
            report.iterations += method.iterations
        except ReplayProblem as problem:
            report.why = str(problem)
            return report
        report.steps += steps()
        if not solver.is_valid(x):
            x[:], report.why = before, "it goes where positions, or their energy, are no numbers"
            return report
        report.residual = norm / solver.scale(x)
        if solver.problem.falls(x):
            report.falls, report.why = True, solver.problem.why_it_falls
            return report
        if steps() == 0 or report.steps >= most:
            break
    report.why = f"{report.steps} steps are over" if report.steps >= most else "no step gets any further"
    return report


def converged(solver: EquilibriumSolver, x: np.ndarray, most: int, report: ConvergenceReport) -> ConvergenceReport:
    """Descent, then Newton's method."""
    return solver.converge(x, most, report)


STRATEGIES: dict[str, Strategy] = {
    "auto": converged,
    "kinetic": moved,
    "rayleigh": lambda *a: moved(*a, damping="rayleigh"),
    "newton": lambda *a: descended(*a, kind="newton", stabilised=False),
    "stabilised": lambda *a: descended(*a, kind="newton"),
    "cg": lambda *a: descended(*a, kind="cg"),
}
"""By the name that a scene gives in ``effects.drape.strategy``."""
