"""Solids of large deformation that move while their rest shape is edited: Newton's method in each Newmark step."""

import numpy as np
from petsc4py import PETSc

from restshape.algebra.gather import System, whole_matrix
from restshape.algebra.linear import LinearSolver
from restshape.algebra.linear_report import LinearReport
from restshape.algebra.newton import Newton
from restshape.algebra.stages import Stages
from restshape.analysis.effective import State
from restshape.analysis.frame import Frame
from restshape.analysis.large import (
    COLD,
    free,
    inversion,
    least_scale,
    rounding,
    rounding_note,
    tangent_solver,
    vanishing,
)
from restshape.analysis.newmark import MotionSystem
from restshape.analysis.transient import TransientAnalysis
from restshape.calibration import Calibration
from restshape.errors import ReplayProblem
from restshape.physics.elasticity.moving_solid import VibratingSolid
from restshape.policy import Policy, policy
from restshape.scene.model import Scene
from restshape.scene.plan import Plan

GAIN = 0.5
"""Energy that a motion may gain from nothing, over the largest that it has had less this gain."""


def transient_analysis(
    scene: Scene, plan: Plan, comm: PETSc.Comm, policy: Policy, calibration: Calibration, stages: Stages
) -> TransientAnalysis:
    """The analysis of a solid that moves that its plan calls for; arguments as in `TransientAnalysis`."""
    made = NonlinearTransient if plan.solver.equations == "nonlinear" else TransientAnalysis
    return made(scene, plan, comm, policy, calibration, stages)


class NonlinearTransient(TransientAnalysis):
    """The motion of a solid of large deformation relative to the ground, frame after frame.

    Newmark's method keeps the energy of linear motions only: where a step is too long for a large one, the energy
    grows without end. So it is watched, on ground that stands still under dead loads.

    Arguments as in `TransientAnalysis`.

    Source: docs/theory.md, section 2.
    """

    def __init__(
        self, scene: Scene, plan: Plan, comm: PETSc.Comm, policy: Policy, calibration: Calibration, stages: Stages
    ) -> None:
        super().__init__(scene, plan, comm, policy, calibration, stages)
        self.made: list[Newton] = []
        self.scale = 0.0
        # The gain of energy from nothing since the start, or since the scene got the values that it has.
        self.gained = self.largest = 0.0
        self.gained_under: Scene | None = None
        self.left_over = 0.0

    def solve(self, frame: Frame) -> LinearReport:
        """Bring the displacement `x` (n, 2) [m] and the velocity `v` (n, 2) [m/s] up to date with a frame.

        Raises:
            ReplayProblem: a step finds no solution, gains energy, or a value has no number somewhere.
            UserError: the scene's new values make no sense. In both cases mesh, motion and time stay as they were.
        """
        try:
            return super().solve(frame)
        finally:
            free(self.made, self.system_now.newton if self.body else None)

    def residual(self) -> float:
        """The residual of the last step, relative to its forces of inertia or to the load."""
        if self.unsolved or self.scale == 0.0:
            return 0.0
        return float(np.linalg.norm(self.system_now.equations.whole_residual(self.x))) / self.scale

    def row(self) -> dict[str, str]:
        """What the frame's row tells besides."""
        return rounding_note(self.left_over, self.solver.tolerance)

    # --- a new frame ----------------------------------------------------------------------------------------------

    def _read(self, scene: Scene) -> None:
        super()._read(scene)
        # The frame after a refused one takes up the scene again, whose values are not new.
        if scene is not self.gained_under:
            self.gained_under, self.gained = scene, 0.0

    def _make_solver(self, scene: Scene) -> LinearSolver:
        return tangent_solver(self, "motion_", scene)

    def _make_system(self) -> MotionSystem:
        return self._system_of(self.body, self.policy.backend, self.solver)

    def _system_of(self, body: VibratingSolid, backend: str | None, solver: LinearSolver) -> MotionSystem:
        def newton(shape: tuple[int, int], rows: slice) -> Newton:
            return Newton(self.comm, "motion_newton_", solver, shape, rows)

        made = MotionSystem(self.comm, body, self.newmark, newton, backend, self.stages, solver.symmetric)
        self.made.append(made.newton)
        return made

    def _make_matrix(self) -> None:
        self.system_now.equations.begin()

    def _run(self, stale: bool, new_system: bool, steps: int) -> LinearReport:
        watched = steps and self.ground is None and self.system_now.equations.potential
        if stale and steps:
            with self.stages("values"):
                self.system_now.equations.begin()
        before, self.left_over = self.whole_energy() if watched else 0.0, 0.0
        report = super()._run(stale, new_system, steps)
        if watched:
            self.gained += self.whole_energy() - before
            self.largest = max(self.largest, self.energy())
            if not self.gained <= GAIN * (self.largest - max(self.gained, 0.0)):
                raise ReplayProblem(
                    f"the motion has gained {self.gained:.3g} J from nothing: the time step is too long for so large a "
                    "deformation; make effects.dynamics.time_step smaller"
                )
        return report

    # --- time steps -----------------------------------------------------------------------------------------------

    def _step(self, stale: bool, new_system: bool) -> LinearReport:
        """One time step."""
        system, state, step = self.system_now, self.state, self.newmark
        equations, newton, time = system.equations, system.newton, state.time + step.dt
        with self.stages("values"):
            equations.start(state, self._shaking(state.time), self._shaking(time))
        newton.begin(new_system, stale, system.places)
        x = self._guess(state)
        solid, tolerance = self.body.solid, self.solver.tolerance
        self.scale = max(equations.load_norm, equations.force_norm, least_scale(solid, x, tolerance))
        goal, rounded = self.solver.aim * self.scale, rounding(solid)
        outcome = newton.solve(x, goal, self.scale, rounding=rounded)
        if not outcome.converged or len(equations.inverted_cells(x)) or vanishing(solid, x):
            x = equations.before.copy()
            outcome = newton.solve(x, goal, self.scale, searched=True, rounding=rounded).after(outcome)
            why = inversion(solid, equations.inverted_cells(x)) or vanishing(solid, x) or outcome.why
            if why:
                raise ReplayProblem(
                    f"no state is found at {time:.6g} s: {why}; make effects.dynamics.time_step smaller, or the load"
                )
        self.left_over = max(self.left_over, outcome.norm / self.scale if self.scale else 0.0)
        self.previous, self.state = state, self._after(state, x - self.body.solid.prescribed, time)
        self.motion.v, self.unsolved = self.state.v, False
        if self.observer.watched:
            self.observer.step(self.x)
        return LinearReport(outcome.iterations, outcome.refreshed, self.solver.age, self.solver.name, outcome.newton)

    def _after(self, state: State, y: np.ndarray, time: float) -> State:
        """The state with the displacement y (n, 2) [m] after a step from another."""
        step, moved = self.newmark, y - state.y
        v, a = step.a1 * moved - step.a4 * state.v, None
        if state.a is not None:
            v -= step.a5 * state.a
            a = step.a0 * moved - step.a2 * state.v - step.a3 * state.a
        return State(y, v, a, time)

    def _guess(self, state: State) -> np.ndarray:
        """Displacements (n, 2) [m] after a step, at the mean acceleration of the step before."""
        x = self.system_now.equations.before
        if not self.policy.extrapolate:
            return x.copy()
        dt = self.newmark.dt
        same = self.previous.time < state.time and self.previous.v.shape == state.v.shape
        gained = state.v - self.previous.v if same else 0.0
        return x + dt * (state.v + 0.5 * gained)

    def whole_energy(self) -> float:
        """Strain and kinetic energy less the work of the dead loads [J]: constant on still ground, undamped."""
        return self.system_now.equations.whole_energy(self.x, self.v)

    # --- for comparison with other solves -------------------------------------------------------------------------

    def system(self) -> System:
        """The tangent and the solution of the last step as they stand, whole on every rank."""
        solution = np.zeros(self.x.size) if self.unsolved else self.state.y.ravel().copy()
        newton = self.system_now.newton
        return System(whole_matrix(newton.tangent(self.x), self.comm), solution)

    def cold_system(self) -> System:
        """The tangent on a new pattern, and the last step's solution with a new factor and no guess."""
        body = VibratingSolid(self.scene, self.plan, self.mesh)
        solver = LinearSolver(
            self.comm,
            "cold_",
            policy("rebuild").solver,
            COLD * self.solver.tolerance,
            self.calibration,
            self.stages,
            symmetric=self.solver.symmetric,
        )
        cold = self._system_of(body, "coo", solver)
        equations, newton, before, now = cold.equations, cold.newton, self.previous, self.state
        equations.begin()
        solution = np.zeros_like(now.y)
        if not self.unsolved:
            equations.start(before, self._shaking(before.time), self._shaking(now.time))
            x = equations.before.copy()
            newton.begin(True, False, cold.places)
            newton.solve(x, solver.tolerance * self.scale, self.scale, rounding=rounding(body.solid))
            solution = x - body.solid.prescribed
        matrix = whole_matrix(newton.tangent(self.x), self.comm)
        solver.ksp.destroy()
        return System(matrix, solution.ravel())
