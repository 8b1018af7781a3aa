"""Equilibrium by motion: semi-implicit steps whose velocities are taken away, as a SNES of type python."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass, replace
from sys import maxsize
from typing import Protocol

import numpy as np
from petsc4py import PETSc

from restshape.algebra.at_exit import destroyed_at_exit
from restshape.algebra.nodal import NodalVectors
from restshape.algebra.nonlinear.step_share import StepShare, whole_step
from restshape.algebra.nonlinear.step_solver import StepSolver
from restshape.algebra.weak_calls import weak_call
from restshape.arrays import Integers, Reals
from restshape.errors import ReplayProblem

log = logging.getLogger("restshape.algebra")

Reason = PETSc.SNES.ConvergedReason
PEAK = 3
"""Samples of the kinetic energy that show a peak."""
LONGER, SHORTER = 1.5, 0.35
"""Factors of the time step after a step that was good, and after one that was not."""
SLACK = 1e-13
"""Rounding of an energy, over its size."""
SHORTEST = 1e-9
"""Time step, over the first one, below which there is no use in shorter ones."""
PLAIN, BALANCED = 2, 0.1
"""Newton's steps of a time step that may end before energy falls, and the forces left over, of the first ones, at which
it ends."""
NO_SOLUTION = "a step of the motion has no solution: part of it has neither mass nor support"


class MovingEquations(Protocol):
    """Equations r(x) = 0 with a mass, whose tangent may be made positive semidefinite."""

    @property
    def constrained(self) -> Integers:
        """Unknowns, of all n f, that are constrained."""

    def residual(self, x: Reals, out: Reals) -> None:
        """Set `out` (n, f) to r; 0 at constrained unknowns."""

    def energy(self, x: Reals) -> float:
        """The energy whose gradient is r."""

    def step_matrix(self, x: Reals, inertia: float, blocks: bool, out: Reals | None = None) -> PETSc.Mat:
        """The stabilised tangent plus `inertia` [1/s^2] times the mass; with `blocks` it may be of type BAIJ.

        Sets `out` (n, f), where it is given, as `residual` does.
        """


@dataclass(frozen=True)
class Steps:
    """How the motion is followed.

    Args:
        time_step: the first one [s].
        longest: the longest one [s]; equal to the first: all are the same, and none is rejected.
        damping: "kinetic", or "rayleigh" by `alpha` [1/s] and `beta` [s].
        tolerance: residual of the linear solves over their right side.
        reach: farthest way of a node in one step [m], for bodies are not to be passed through.
        most: steps.
        preconditioner: of PETSc for the linear solves: "sor", "ilu" without fill, or "cholesky", which solves alone.
        newton: steps of Newton's method in a time step, each on a tangent of its own; 1: steps are semi-implicit.
    """

    time_step: float = 1.0 / 60.0
    longest: float = 1.0
    damping: str = "kinetic"
    alpha: float = 0.0
    beta: float = 0.0
    tolerance: float = 1e-2
    reach: float = np.inf
    most: int = 500
    preconditioner: str = "sor"
    newton: int = 1

    @property
    def adaptive(self) -> bool:
        """Whether time steps are chosen, and steps that gain energy rejected."""
        return self.longest > self.time_step


@dataclass(frozen=True)
class SNESContext:
    """What a SNES of type python calls.

    Args:
        solve: with the SNES, the right side and the unknowns, which it changes.
    """

    solve: Callable[[PETSc.SNES, PETSc.Vec | None, PETSc.Vec], None]


# More than 15 attributes: what is called on the way, and how the last run went.
class KineticDamping:
    """Semi-implicit steps (M/h^2 + K) d = -r + M v/h; v = d/h is set to zero when the kinetic energy has passed a peak.

    K is the tangent without its compressed part. Further steps of Newton's method, where there are any, bring a step
    near to the implicit one, (M/h^2) (d - h v) = -r(x + d), which turns farther where the body hardly stretches.

    A step that makes kinetic and potential energy together larger is
    rejected and the next one shorter, so that without friction potential energies at successive resets never rise.

    Args:
        comm: PETSc communicator.
        prefix: of the options of SNES and KSP in PETSc's database.
        motion: the equations.
        mass: (n,) of the nodes [kg].
        shape: (n, f) of the unknowns; rows: this rank's, of n f.
        steps: how the motion is followed.

    Attributes:
        resets: potential energies [J] at resets; rejected: steps taken back; matrices: made in the last run.
        on_step: called with positions (n, f) and the norm of the residual before each step; a true answer ends it.
        on_move: called with positions (n, f) after each step; returns whether it changed the equations.
        step_share: of positions (n, f) and a step (n, f), the largest share of it, at most 1, that may be gone.

    Source: docs/theory/cloth.md; Baraff and Witkin, SIGGRAPH 1998, 43; Barnes 1999.
    """

    def __init__(
        self,
        comm: PETSc.Comm,
        prefix: str,
        motion: MovingEquations,
        mass: Reals,
        shape: tuple[int, ...],
        rows: slice,
        steps: Steps,
    ) -> None:
        self.motion, self.steps = motion, steps
        self.set_mass(mass)
        self.nodal = NodalVectors(comm, shape, rows)
        self.time_step = steps.time_step
        self.resets: list[float] = []
        self.rejected = self.matrices = 0
        self.stuck: ReplayProblem | None = None
        self.on_step = self.on_move = lambda *_: False
        self.step_share: StepShare = whole_step
        self.x, unused = self.nodal.vector(), self.nodal.vector()
        self.snes = destroyed_at_exit(PETSc.SNES().create(comm))
        self.snes.setOptionsPrefix(prefix)
        self.snes.setType("python")
        self.snes.setPythonContext(SNESContext(weak_call(self.solve)))
        # SNES checks that there is a function; the context evaluates the residual itself.
        self.snes.setFunction(lambda *_: None, unused)
        unused.destroy()
        self.linear = StepSolver(comm, f"{prefix}step_", self.nodal, steps.tolerance, steps.preconditioner)

    def set_mass(self, mass: Reals) -> None:
        """Take in the masses (n,) of the nodes [kg]."""
        self.mass = mass[:, None]

    @property
    def iterations(self) -> int:
        """Iterations of CG in the last `run`."""
        return self.linear.iterations

    def free(self) -> None:
        """Free PETSc's objects."""
        for part in (self.snes, self.x):
            part.destroy()
        self.linear.free()

    @property
    def uninterrupted(self) -> int:
        """Steps of a run: any number, for it would lose its velocities."""
        return maxsize

    def run(self, x: Reals, goal: float, most: int | None = None) -> float:
        """Go on from x (n, f), which is changed, until the residual's norm is at `goal`; returns the norm then.

        Args:
            most: steps; None: those of its settings.

        Raises:
            ReplayProblem: no step leads on from the positions in x.
        """
        self.goal, self.resets, self.rejected, self.matrices = goal, [], 0, 0
        self.steps = replace(self.steps, most=self.steps.most if most is None else most)
        self.stuck = None
        self.linear.begin()
        self.nodal.put(x, self.x)
        self.snes.solve(None, self.x)
        x[:] = self.nodal.values(self.x)
        if self.stuck:
            raise self.stuck
        return self.norm

    def solve(self, snes: PETSc.SNES, b: PETSc.Vec | None, X: PETSc.Vec) -> None:
        """What SNES calls: moves X until it rests, or until the steps are over."""
        motion, steps = self.motion, self.steps
        x = self.nodal.values(X).copy()
        v, force = np.zeros_like(x), np.zeros_like(x)
        self.time_step, seen = steps.time_step, [0.0, 0.0]
        try:
            potential = self._potential(x)
            for k in range(steps.most + 1):
                matrix = self._matrix(x, force)
                self.norm = float(np.linalg.norm(force))
                snes.setIterationNumber(k)
                log.debug("%3d TS dt %.3e Function norm %.12e", k, self.time_step, self.norm)
                reason = self._reason(x, k)
                if reason:
                    break
                x, v, potential = self._time_step(x, v, force, potential, matrix)
                if self.on_move(x):
                    potential = self._potential(x)
                seen = [*seen[1 - PEAK :], self._kinetic(v)]
                if steps.damping == "kinetic" and len(seen) == PEAK and seen[0] <= seen[1] > seen[2]:
                    v, seen = np.zeros_like(v), [0.0]
                    self.resets.append(motion.energy(x))
                    log.debug("%3d TS kinetic-energy peak, velocities set to 0; energy %.12e", k, self.resets[-1])
        except ReplayProblem as problem:
            # SNES ends as usual: an exception through it would leave its events open in PETSc's log.
            self.stuck, reason = problem, Reason.DIVERGED_INNER
        self.nodal.put(x, X)
        snes.setConvergedReason(reason)

    def _reason(self, x: Reals, k: int) -> int:
        """Why it ends at x (n, f) after k steps; 0 where it goes on."""
        if not np.isfinite(self.norm):
            return Reason.DIVERGED_FNORM_NAN
        if self.norm <= self.goal:
            return Reason.CONVERGED_FNORM_ABS
        if self.on_step(x, self.norm):
            return Reason.CONVERGED_ITS
        return Reason.DIVERGED_MAX_IT if k == self.steps.most else Reason.ITERATING

    @property
    def _damped(self) -> float:
        """What damping by stiffness makes of the factor of the tangent in a step."""
        return 1.0 + self.steps.beta / self.time_step

    @property
    def _inertia(self) -> float:
        """What the mass is multiplied with in a step's matrix [1/s^2]."""
        return (1.0 / self.time_step**2 + self.steps.alpha / self.time_step) / self._damped

    def _time_step(
        self, x: Reals, v: Reals, force: Reals, potential: float, matrix: PETSc.Mat
    ) -> tuple[Reals, Reals, float]:
        """Positions, velocities and potential energy after one step that is accepted, from the first one's matrix."""
        steps = self.steps
        before = potential + self._kinetic(v) if steps.adaptive else 0.0
        while True:
            h = self.time_step
            right = (self.mass * v / h - force) / self._damped
            right.ravel()[self.motion.constrained] = 0.0
            # Each iterate, of CG and guesses, goes down in the step's own energy, so that a short enough step does too.
            d = self.linear.solve(matrix, right)
            if d is not None:
                d = self._shortened(x, d)
                if not steps.adaptive:
                    return x + d, d / h, potential
                after = self.motion.energy(x + d)
                if steps.newton > 1:
                    d, after = self._balanced(x, v, d, after, before, float(np.linalg.norm(right)))
                far = self._farthest(d) > (np.inf if steps.newton > 1 else steps.reach)
                if not (far or self._gained(d, after, before)):
                    break
            elif not steps.adaptive or h < SHORTEST * steps.time_step:
                raise ReplayProblem(NO_SOLUTION)
            self.rejected += 1
            self.time_step *= SHORTER
            log.debug("    TS step rejected, dt %.3e", self.time_step)
            if d is not None and self.time_step < SHORTEST * steps.time_step:
                raise ReplayProblem("no time step is short enough: the energy is no number, or nothing moves")
            matrix = self._matrix(x)
        self.time_step = min(LONGER * self.time_step, steps.longest)
        return x + d, d / h, after

    def _balanced(self, x: Reals, v: Reals, d: Reals, after: float, before: float, first: float) -> tuple[Reals, float]:
        """A step d (n, f) from x (n, f) brought nearer to the implicit one by Newton's method, and the potential there.

        Args:
            v: (n, f) velocities.
            after: potential after the step; before: potential and kinetic energy before it.
            first: norm of the forces that it was made from.
        """
        h, force = self.time_step, np.empty_like(x)
        for taken in range(1, self.steps.newton):
            if taken >= PLAIN and not self._gained(d, after, before):
                break
            self.motion.residual(x + d, force)
            right = self.mass * (v - d / h) / h - force
            right.ravel()[self.motion.constrained] = 0.0
            if float(np.linalg.norm(right)) <= BALANCED * first:
                break
            more = self.linear.solve(self._matrix(x + d), right)
            if more is None:
                break
            d = d + self._shortened(x + d, more)
            after = self.motion.energy(x + d)
        return d, after

    def _matrix(self, x: Reals, out: Reals | None = None) -> PETSc.Mat:
        """The matrix of a step at x (n, f); `out` (n, f), where it is given, is set to the residual there."""
        self.matrices += 1
        return self.motion.step_matrix(x, self._inertia, self.linear.blocks, out)

    def _shortened(self, x: Reals, d: Reals) -> Reals:
        """A step d (n, f) from x (n, f) as far as nothing is passed, and one of several no farther than the reach."""
        if self.steps.newton > 1 and (far := self._farthest(d)) > self.steps.reach:
            d = d * (self.steps.reach / far)
        return d * self.step_share(x, d)

    def _farthest(self, d: Reals) -> float:
        """The farthest way in a step d (n, f) of what has mass: slopes move at once however short a step is."""
        return float(np.abs(d[self.mass[:, 0] > 0.0]).max(initial=0.0))

    def _gained(self, d: Reals, after: float, before: float) -> bool:
        """Whether a step d (n, f) has more energy, with `after` as its potential, than there was before, or none."""
        return not after + self._kinetic(d / self.time_step) <= before + SLACK * abs(before)

    def _potential(self, x: Reals) -> float:
        """The potential energy where steps may be rejected for it; 0 where none is."""
        return self.motion.energy(x) if self.steps.adaptive else 0.0

    def _kinetic(self, v: Reals) -> float:
        return 0.5 * float((self.mass * v * v).sum())
