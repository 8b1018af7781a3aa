"""The solution strategy of cloth: motion with kinetic damping, descent, and Newton refinement at the end."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from petsc4py import PETSc

from restshape.algebra.linear import LinearSolver
from restshape.algebra.nonlinear.descent import MEMORY, Descent
from restshape.algebra.nonlinear.kinetic_damping import KineticDamping, Steps
from restshape.algebra.nonlinear.newton import Newton
from restshape.algebra.reuse.tries import Tries
from restshape.algebra.stages import Stages
from restshape.algebra.weak_calls import weak_call
from restshape.errors import ReplayProblem
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.relaxation.cloth_slide import SLIDES, ClothSlide, slides_on
from restshape.physics.cloth.relaxation.relaxation_equations import ClothEquations
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport

log = logging.getLogger("restshape.physics")

NEAR = 1e-3
"""Residual over load at which Newton's method takes over."""
ROUGH = 0.05
"""Residual over load at which a fall, or its part on a mesh or with a softness, ends."""
FALL_STEP, FALL_NEWTON, FALLING = 0.2, 4, 500
"""Of a fall: the longest time step, over `ClothProblem.swing_time`, and the most steps of Newton's method in one; the
most time steps."""
STALLED = 1e-4
"""Part of its energy that a fall must lose in `MEMORY` steps to go on."""
SLIPPING = 1e-2
"""Slip distance that friction may still have at an equilibrium, over that at which it is all there."""
STIFFER = 10.0
"""Factor of the inertia where a descent does not get on."""
SLOW = 1e3
"""Factor of the inertia of a run after one in which cloth has begun to slide."""
LEAST = 1e-9
"""Strain whose forces are the least that residuals of cloth without weight are measured against."""
FIXED = 200
"""Steps of a frame after which anchors of friction are dragged: descents may cycle about those that stay."""
ROUND_OFF = 4e-16
"""Rounding of a force, over the membrane's stiffness times the place of its node."""
CAUGHT, KEPT = 1e-5, 0.9
"""Way of a descent, over the cloth's size, below which nothing moves, where so much of the residual is left."""
TRIES = 4
"""Descents in a row that may fail before the cloth is said not to converge."""


# More than 15 attributes: all methods that lead to one equilibrium, and what they know of each other.
class EquilibriumSolver:
    """Finds the equilibrium of one cloth, again and again, with patterns, factors and solvers that are kept.

    Args:
        problem: the cloth.
        comm: PETSc communicator.
        stages: takes the time of values, factors and Krylov iterations.
        linear: solves for Newton's steps; None: Newton's method is not used.
        goal: residual over load at an equilibrium.
        motion: how kinetic damping steps.
        backend: of the operator.
        prefix: of options in PETSc's database.

    Attributes:
        tries: when frames of a drag are tried by Newton's method.
        on_iterate: called with this solver, positions (n, 3) and residual over load at each iterate of any method.

    Source: docs/theory/cloth.md.
    """

    def __init__(
        self,
        problem: ClothProblem,
        comm: PETSc.Comm,
        stages: Stages,
        linear: LinearSolver | None,
        goal: float = 1e-4,
        motion: Steps | None = None,
        backend: str | None = None,
        prefix: str = "drape_",
    ) -> None:
        self.problem, self.comm, self.stages, self.linear, self.goal = problem, comm, stages, linear, goal
        self.motion = motion or Steps()
        self.equations = ClothEquations(problem, comm, stages, backend)
        rows, shape, mass = self.equations.rows, (problem.n_nodes, 3), self.equations.mass
        self._moving = KineticDamping(comm, f"{prefix}kinetic_", self.equations, mass, shape, rows, self.motion)
        self._falling = KineticDamping(comm, f"{prefix}fall_", self.equations, mass, shape, rows, self._fall_steps)
        reach = self.motion.reach
        self.descent = Descent(comm, f"{prefix}descent_", self.equations, shape, rows, reach=reach)
        self._newton = Newton(comm, f"{prefix}newton_", linear, shape, rows) if linear else None
        self._met, self._noted, self.tries = -1, 0, Tries()
        self.on_iterate: Callable[[EquilibriumSolver, np.ndarray, float], None] = lambda *_: None
        self._slide = ClothSlide(problem)
        self.descent.on_step, self.descent.step_share = weak_call(self._note_descent), weak_call(self._descent_share)
        self._moving.on_step, self._falling.on_step = weak_call(self.note), weak_call(self._note_fall)
        self._fell, self._fell_from = np.inf, np.empty((0, 3))
        for motion in (self._moving, self._falling):
            motion.step_share = problem.step_share
            # Friction that followed at peaks alone would be none for what slides ever faster and has no peak.
            motion.on_move = problem.follow_friction
        if self._newton:
            self._newton.step_share = problem.step_share

    def destroy(self) -> None:
        """Free PETSc's objects."""
        for motion in (self._moving, self._falling):
            motion.free()
        for part in (self.descent, self._newton):
            if part:
                part.destroy()
        # Matrices go with the operator, which must not wait until Python looks for cycles.
        del self.equations, self._moving, self._falling, self.descent, self._newton

    @property
    def newton(self) -> Newton | None:
        """Newton's method for the problem as it is now."""
        if self._newton and self._met != self.problem.stiffness_version:
            self._newton.set_equations(self.equations)
            self._newton.begin(self._met < 0, False, self.places)
            self._met = self.problem.stiffness_version
        return self._newton

    @property
    def moving(self) -> KineticDamping:
        """Kinetic damping of the problem as it is now."""
        self._moving.set_mass(self.equations.mass)
        return self._moving

    @property
    def places(self) -> np.ndarray:
        """Material coordinates (k, 2) [m] of this rank's nodes."""
        rows = self.equations.rows
        return self.problem.X[rows.start // 3 : rows.stop // 3]

    def set_tolerance(self, goal: float) -> None:
        """Converge to another residual over the load."""
        self.goal = self.linear.tolerance = goal

    def set_reach(self, reach: float) -> None:
        """Let no node go farther in one step than so much [m]."""
        self.motion = replace(self.motion, reach=reach)
        self._moving.steps, self._falling.steps, self.descent.reach = self.motion, self._fall_steps, reach

    @property
    def _fall_steps(self) -> Steps:
        """How cloth falls: implicit steps, by few steps of Newton's method with a complete factor each."""
        longest = FALL_STEP * self.problem.swing_time
        first = min(self.motion.time_step, longest)
        return replace(
            self.motion, time_step=first, longest=longest, preconditioner="cholesky", newton=FALL_NEWTON, most=FALLING
        )

    def scale(self, x: np.ndarray) -> float:
        """What residuals are measured against [N]: the weight, or without any the forces at supports."""
        problem, lumped = self.problem, self.problem.lumped
        if lumped.load > 0.0:
            return lumped.load
        forces = np.empty_like(x)
        problem.internal_forces(x, forces)
        least = LEAST * problem.fabric.membrane.max() * lumped.area.sum() ** 0.5
        return max(float(np.linalg.norm(forces[problem.boundary.mask.astype(bool)])), least)

    def fall(self, x: np.ndarray, goal: float, most: int, report: ConvergenceReport) -> None:
        """Fall from x (n, 3), which is changed, until the residual over the load is at `goal`, in `most` steps.

        The motion of cloth with kinetic damping, in implicit steps, each of which lowers its energy and moves friction.
        """
        report.take_softness(self.problem.softness)
        self.problem.update_friction(x)
        falling, self._fell, self._fell_from = self._falling, np.inf, np.empty((0, 3))
        falling.set_mass(self.equations.mass)
        try:
            with self.stages("krylov"):
                falling.run(x, goal * self.scale(x), min(most, FALLING))
        except ReplayProblem as problem:
            # From where it has come to, other methods may get on.
            report.why = str(problem)
        report.residual = self.residual_norm(x)
        steps = falling.snes.getIterationNumber()
        report.steps, report.factors = report.steps + steps, report.factors + falling.matrices
        report.iterations += falling.iterations
        if self.problem.falls(x):
            report.falls, report.why = True, self.problem.why_it_falls
        log.info(
            "TS fall to %g: %d steps, %d matrices, %d kinetic-energy peaks, %d rejected, dt %.1e, residual/load %.3e",
            goal,
            steps,
            falling.matrices,
            len(falling.resets),
            falling.rejected,
            falling.time_step,
            report.residual,
        )

    def descend(self, x: np.ndarray, goal: float, most: int, report: ConvergenceReport) -> bool:
        """Quasi-Newton steps from x (n, 3), which is changed, on a fresh tangent every few steps; returns success."""
        equations, failed, taken, last = self.equations, 0, 0, np.inf
        report.take_softness(self.problem.softness)
        least = equations.inertia = equations.supporting_inertia
        report.why = ""
        while taken < most:
            report.slip = self.problem.update_friction(x, moving=True)
            if self._slide.begin(x, taken == 0):
                # Sliding is slow then, and normal forces get right, for contact is far stiffer.
                equations.inertia = SLOW * least
            before = x.copy()
            with self.stages("krylov"):
                norm = self.descent.run(x, goal * self.scale(x), min(MEMORY, most - taken))
            steps = self.descent.steps
            report.factors, report.iterations = report.factors + 1, report.iterations + steps
            report.steps, taken = report.steps + steps, taken + max(steps, 1)
            report.residual = norm / self.scale(x)
            log.info(
                "SNES descent to %g on a new tangent: %d steps, inertia %.3e, residual over load %.3e",
                goal,
                steps,
                equations.inertia,
                report.residual,
            )
            if not self.is_valid(x):
                x[:] = before
            if report.residual <= goal:
                return True
            if self.problem.falls(x) or self._slide.endless(x):
                report.falls, report.why = True, self.problem.why_it_falls if self.problem.falling else SLIDES
                # Nothing is left of friction then.
                self.problem.update_friction(x)
                return False
            # A descent that ends at once has a tangent that does not fit: more inertia makes steps shorter. One that
            # goes nowhere, far from rest, is caught by layers that cross.
            still = np.abs(x - before).max() <= CAUGHT * self.problem.size
            caught, last = still and report.residual > max(1.0, KEPT * last), report.residual
            short = (steps < 2 or caught) and not self._slide.ended
            failed = failed + 1 if short else 0
            if failed >= TRIES:
                report.why = "no step makes the energy smaller"
                return False
            equations.inertia = equations.inertia * STIFFER if short else max(equations.inertia / STIFFER, least)
        return False

    def refine(self, x: np.ndarray, report: ConvergenceReport) -> bool:
        """Newton's method from x (n, 3) near an equilibrium, which it is set to where one is found; returns whether."""
        scale, start = self.scale(x), x.copy()
        try:
            outcome = self.newton.solve(x, self.goal * scale, scale, searched=True, rounding=self.rounding)
        except ReplayProblem as problem:
            log.info("Newton refinement failed: %s", problem)
            x[:] = start
            return False
        log.info("Newton refinement %s: %d iterations", outcome.why or "converged", outcome.newton)
        report.newton += outcome.newton
        report.steps += outcome.newton
        report.iterations += outcome.iterations
        if not outcome.converged or not np.isfinite(x).all():
            x[:] = start
            return False
        report.residual = outcome.norm / scale
        self.note(x, outcome.norm)
        return True

    def converge(self, x: np.ndarray, most: int, report: ConvergenceReport) -> ConvergenceReport:
        """Descent and Newton's method from x (n, 3), which is changed, until nothing moves, friction included."""
        near, begun = max(NEAR, self.goal), report.steps
        if self.rests(x, report):
            report.converged, report.why = True, ""
            return report
        until = min(FIXED, most) if self.problem.frame_begun else most
        while True:
            taken = report.steps - begun
            if taken >= until or not self.descend(x, near, until - taken, report):
                if until < most and not report.falls:
                    self.problem.end_frame(x)
                    until = most
                    continue
                report.why = report.why or f"{most} steps are over"
                break
            if self.newton and not self.refine(x, report):
                # Where the true tangent is of no use yet, descent goes on alone.
                near = max(0.1 * near, self.goal)
                if near > self.goal or report.residual > self.goal:
                    continue
            if self.rests(x, report):
                report.converged, report.why = True, ""
                break
            if report.residual > self.goal and report.residual * self.scale(x) <= self.rounding * np.abs(x).max():
                report.why = "rounding leaves no smaller residual"
                break
            near = max(near, self.goal)
        return report

    def rests(self, x: np.ndarray, report: ConvergenceReport) -> bool:
        """Whether nothing moves at x (n, 3), when friction has followed; notes residual and slip distance."""
        report.slip = self.problem.update_friction(x)
        report.residual = self.residual_norm(x)
        return report.residual <= self.goal and report.slip <= SLIPPING * self.slip_distance

    @property
    def rounding(self) -> float:
        """Forces [N] a metre of the places below which a residual that steps do not lower any more is rounding."""
        return ROUND_OFF * float(self.problem.fabric.membrane.max()) * len(self.problem.mesh.X) ** 0.5

    def residual_norm(self, x: np.ndarray) -> float:
        """The norm of the residual over the load, at x (n, 3)."""
        out = np.empty_like(x)
        self.problem.residual(x, out)
        return float(np.linalg.norm(out)) / self.scale(x)

    def is_valid(self, x: np.ndarray) -> bool:
        """Whether positions x (n, 3), their energy and their residual are numbers."""
        return bool(np.isfinite([np.abs(x).max(), self.problem.energy(x), self.residual_norm(x)]).all())

    @property
    def slip_distance(self) -> float:
        """Way at which friction is all there [m]; infinite without contact."""
        return self.problem.contact.slip if self.problem.contact else np.inf

    def note(self, x: np.ndarray, norm: float) -> bool:
        """Hand on an iterate x (n, 3) and its residual's norm [N]; returns whether the cloth falls without end."""
        self.on_iterate(self, x, norm / self.scale(x))
        self._noted += 1
        # Looked at in every step it would cost a twentieth of it.
        return self._noted % MEMORY == 0 and self.problem.falls(x)

    def _note_descent(self, x: np.ndarray, norm: float) -> bool:
        """The same of a descent; true too where friction has to follow."""
        ends = self.note(x, norm)
        return self._slide.reached(x) or ends

    def _descent_share(self, x: np.ndarray, d: np.ndarray) -> float:
        """The share of a step d (n, 3) from x (n, 3) [m] that lets nothing pass, nor slide too far."""
        share = self._slide.share(x, d)
        return share * self.problem.step_share(x, share * d)

    def _note_fall(self, x: np.ndarray, norm: float) -> bool:
        """The same of a fall; true too where the energy hardly falls any more, as where something stands in the way."""
        ends = self.note(x, norm)
        if ends or self._noted % MEMORY:
            return ends
        before, self._fell = self._fell, self.problem.energy(x)
        places, self._fell_from = self._fell_from, self.problem.corners(x).copy()
        # Descents find out whether friction would hold it where it does not get faster and faster.
        slides = len(places) > 0 and slides_on(self.problem, places, self._fell_from, self.problem.size)
        return slides or before - self._fell < STALLED * abs(self._fell)
