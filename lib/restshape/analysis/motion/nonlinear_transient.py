"""Nonlinear problems in time while the rest shape is edited: Newton's method in each implicit step."""

# More than 15 modules: here time steps and Newton's method of a frame meet, a module each.
from dataclasses import dataclass, replace
from typing import cast

import numpy as np
import scipy.sparse as sp

from restshape.algebra.factors.gathering import gather_matrix
from restshape.algebra.linear_report import LinearReport
from restshape.algebra.nonlinear.newton import Newton
from restshape.analysis.analysis import Context, RowValues
from restshape.analysis.correction import KeptOperation
from restshape.analysis.frame import Frame
from restshape.analysis.motion.motion_equations import MotionSystem
from restshape.analysis.motion.transient import TransientAnalysis
from restshape.analysis.motion.transient_state import TransientState
from restshape.analysis.static.equilibrium_search import least_scale, rounding
from restshape.analysis.static.nonlinear import rounding_note
from restshape.analysis.time_error import StepMatrix, element_product
from restshape.errors import ReplayProblem
from restshape.fem.problem import TransientProblem
from restshape.fem.semidiscrete import SemiDiscrete
from restshape.fem.time_integration import TimeIntegration, TimeState
from restshape.scene.model import Scene
from restshape.scene.plan import Plan

GAIN = 0.5
"""Energy that a motion may gain from nothing, over the largest that it has had less this gain."""


@dataclass(frozen=True)
class EnergyGain:
    """The energy that a motion has gained from nothing since the start, or since the scene got the values that it has.

    Args:
        gained: in all [J].
        largest: that the motion has had [J].
        scene: with these values.
    """

    gained: float = 0.0
    largest: float = 0.0
    scene: Scene | None = None


# More than 15 attributes: those of a state in time, and what Newton's iteration goes on from.
@dataclass(frozen=True, eq=False)
class NonlinearTransientState(TransientState):
    """A motion of a nonlinear problem; further arguments:

    Args:
        scale: that the last step's residual is measured against.
        residual: the largest of the frame's steps over it.
        gain: of energy.
    """

    scale: float = 0.0
    residual: float = 0.0
    gain: EnergyGain = EnergyGain()

    # All that a linear system is used for is overridden.
    @property
    def system(self) -> MotionSystem:  # type: ignore[override]
        """What outlives frames on the space."""
        return cast(MotionSystem, super().system)


class NonlinearTransientAnalysis(TransientAnalysis):
    """The motion, or diffusion, of a nonlinear problem, frame after frame; arguments as in `TransientAnalysis`.

    Newmark's method keeps the energy of linear motions only: where a step is too long for a large one, the energy
    grows without end. So it is watched, on a base that stands still under dead loads.

    Source: docs/theory/solids.md.
    """

    state: NonlinearTransientState

    def __init__(self, scene: Scene, plan: Plan, context: Context, make: type[TransientProblem]) -> None:
        super().__init__(scene, plan, context, make)
        self.state = NonlinearTransientState(plan, scene)
        self._made: list[Newton] = []

    def solve(self, frame: Frame) -> LinearReport:
        """Bring the motion up to date with a frame.

        Raises:
            ReplayProblem: a step finds no solution, gains energy, or a value has no number somewhere.
            UserError: the scene's new values make no sense. In both cases the state is that of before, time included.
        """
        try:
            return super().solve(frame)
        finally:
            self._destroy_unused()

    def residual_norm(self) -> float:
        """The residual of the last step, relative to its forces of inertia or to the load."""
        state = self.state
        if state.unsolved or state.scale == 0.0:
            return 0.0
        return float(np.linalg.norm(state.system.equations.full_residual(self.x))) / state.scale

    def row(self) -> RowValues:
        """What the frame's row reports besides."""
        return super().row() | rounding_note(self.state.residual, self.solver.tolerance)

    def _last_matrix(self) -> StepMatrix:
        """The matrix at the end of the last step, which is not assembled, nor need the factor be one like it."""
        state, kept = self.state, KeptOperation(self.solver, self.state.system.rows)
        product = element_product(state.body, state.integration.scheme, state.now.y)
        return StepMatrix(product, kept, exact=False, complete=False)

    # --- a new frame --------------------------------------------------------------------------------------------------

    def _read(self, scene: Scene) -> None:
        super()._read(scene)
        # The frame after a refused one takes up the scene again, whose values are not new.
        if scene is not self.state.gain.scene:
            self.state = replace(self.state, gain=replace(self.state.gain, scene=scene, gained=0.0))

    def _make_system(  # type: ignore[override]
        self, body: SemiDiscrete, integration: TimeIntegration
    ) -> MotionSystem:
        comm, stages, backend, solver = self.context.comm, self.context.stages, self.context.policy.backend, self.solver

        def newton(shape: tuple[int, ...], rows: slice) -> Newton:
            return Newton(comm, f"{self.prefix}newton_", solver, shape, rows)

        made = MotionSystem(comm, body, integration.scheme, newton, backend, stages, solver.symmetric)
        self._made.append(made.newton)
        return made

    def _make_matrix(self) -> None:
        self.state.system.equations.begin()

    def _run(self, stale: bool, new_system: bool, steps: int) -> LinearReport:
        state, equations = self.state, self.state.system.equations
        second, still = state.integration.scheme.order == 2, state.integration.excitation is None
        watched = steps and second and still and equations.potential
        if stale and steps:
            with self.context.stages("values"):
                equations.begin()
        before = self.total_energy() if watched else 0.0
        self.state = replace(state, residual=0.0)
        report = super()._run(stale, new_system, steps)
        if watched:
            self._watch(before)
        return report

    def _watch(self, before: float) -> None:
        """Refuse a frame that has gained too much energy [J] from nothing."""
        gain = self.state.gain
        gained = gain.gained + (self.total_energy() - before)
        largest = max(gain.largest, self.energy())
        self.state = replace(self.state, gain=replace(gain, gained=gained, largest=largest))
        if not gained <= GAIN * (largest - max(gained, 0.0)):
            raise ReplayProblem(
                f"the motion has gained {gained:.3g} J from nothing: the time step is too long for so large a "
                f"deformation; make {self.problem.time_step_key} smaller"
            )

    def _destroy_unused(self) -> None:
        """Free all of Newton's methods but the present one; see `NonlinearSteadyAnalysis`."""
        kept = self.state.system.newton if self.state.bound else None
        for newton in self._made:
            if newton is not kept:
                newton.destroy()
        self._made[:] = [kept] if kept else []

    # --- time steps ---------------------------------------------------------------------------------------------------

    def _step(self, stale: bool, new_system: bool, steps: int) -> LinearReport:
        """One time step."""
        system, state, scheme = self.state.system, self.state.now, self.state.integration.scheme
        equations, newton, problem = system.equations, system.newton, self.problem
        time = state.time + scheme.dt
        with self.context.stages("values"):
            equations.start(state, self._base_acceleration(state.time), self._base_acceleration(time))
        newton.begin(new_system, stale, system.places if self.solver.traits.rigid_motions else None)
        x = self._guess(state)
        least = least_scale(problem, x, self.solver.tolerance)
        scale = max(equations.load_norm, equations.force_norm, least)
        goal, rounded = self.solver.aim * scale, rounding(problem)
        outcome = newton.solve(x, goal, scale, rounding=rounded)
        if not outcome.converged or problem.objection(x):
            x = equations.before.copy()
            outcome = newton.solve(x, goal, scale, searched=True, rounding=rounded).after(outcome)
            why = problem.objection(x) or outcome.why
            if why:
                mend = f"make {problem.time_step_key} smaller, or the load"
                if problem.nested is not problem:
                    mend += ", or nu while the shape moves, which changes volumes"
                raise ReplayProblem(f"no state is found at {time:.6g} s: {why}; {mend}")
        residual = max(self.state.residual, outcome.norm / scale if scale else 0.0)
        self.state = replace(self.state, scale=scale, residual=residual)
        self._set_motion(scheme.after(state, x - problem.boundary.values))
        return LinearReport(outcome.iterations, outcome.refreshed, self.solver.age, self.solver.name, outcome.newton)

    def _guess(self, state: TimeState) -> np.ndarray:
        """Unknowns (n, f) after a step, at the mean rate of change of the rates in the step before."""
        x, previous = self.state.system.equations.before, self.state.previous
        if not self.context.policy.warm:
            return self.problem.boundary.values.copy()
        if not self.context.policy.extrapolate:
            return x.copy()
        dt = self.state.integration.scheme.dt
        same = previous.time < state.time and previous.v.shape == state.v.shape
        gained = state.v - previous.v if same else 0.0
        return x + dt * (state.v + 0.5 * gained)

    def total_energy(self) -> float:
        """Internal and kinetic energy less the work of the dead loads [J]: constant on a still base, undamped."""
        return self.state.system.equations.total_energy(self.x, self.v)

    # --- for comparison with other solves -----------------------------------------------------------------------------

    def step_matrix(self) -> sp.csr_matrix:
        """The tangent after the last step as it stands, whole on every rank."""
        return gather_matrix(self.state.system.newton.tangent(self.x), self.context.comm)
