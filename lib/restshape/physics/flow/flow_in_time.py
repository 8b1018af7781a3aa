"""Flow in time while its walls are being edited: implicit steps by backward differences on a mesh that moves."""

# More than 15 modules: here time steps, Newton's method and the mesh's motion of a frame meet, a module each.
from __future__ import annotations

import logging
from dataclasses import dataclass, field, replace
from itertools import accumulate, pairwise
from typing import cast

import numpy as np

from restshape.algebra.factors.gathering import GatheredSystem, gather_matrix
from restshape.algebra.linear import LinearSolver
from restshape.algebra.linear_report import LinearReport
from restshape.algebra.nonlinear.newton_convergence import Outcome
from restshape.analysis.analysis import Comparison, Context, RowValues, State
from restshape.analysis.frame import Frame
from restshape.analysis.static.nonlinear import COLD, NonlinearState, NonlinearSteadyAnalysis, NonlinearSystem
from restshape.analysis.static.residual_equations import ResidualEquations
from restshape.errors import ReplayProblem, UserError
from restshape.fem.problem import Problem
from restshape.first_use import made
from restshape.physics.flow.carry import Carrier, VelocityCorrection, pressure_spread
from restshape.physics.flow.extrapolation import TimeGuess
from restshape.physics.flow.flow_declaration import FlowSettings
from restshape.physics.flow.flow_quantities import swinging_lifts
from restshape.physics.flow.flow_search import FlowSearch
from restshape.physics.flow.history import Level, Past
from restshape.physics.flow.incompressible_flow import IncompressibleFlow, TimeStep
from restshape.physics.flow.sudden import IMPULSE, after_impulse, is_sudden, projected_note, with_jumps
from restshape.physics.flow.swing import Swings, still_note
from restshape.policy import policy
from restshape.scene.model import Scene
from restshape.scene.plan import Plan

log = logging.getLogger("restshape.analysis")


@dataclass(frozen=True, eq=False)
class FlowState(NonlinearState):
    """A flow in time; further arguments:

    Args:
        past: what the next step goes on from.
        swings: of lifts, over all time steps, where the scene asks for them.
    """

    past: Past | None = None
    swings: Swings = field(default_factory=Swings)


class FlowInTimeAnalysis(NonlinearSteadyAnalysis):
    """Flow in time, frame after frame; arguments as `analysis.steady.SteadyAnalysis`.

    Each step is a nonlinear problem with the older velocities as nodal coefficients. The first frame shows the fluid
    at rest and takes no step. A new mesh takes both past velocities by interpolation, so that the order stays.

    Source: docs/theory/flow.md.
    """

    state: FlowState
    predictor = None
    recalling = None
    why_not = "only steady states and modes are predicted: time integration depends on the past, not on the shape alone"

    def __init__(self, scene: Scene, plan: Plan, context: Context, make: type[IncompressibleFlow]) -> None:
        super().__init__(scene, plan, context, make)
        self.state = FlowState(plan, scene)
        self._ahead = self._time_guess()

    def solve(self, frame: Frame) -> LinearReport:
        """Bring the flow up to date with a frame: take its time steps.

        Raises:
            ReplayProblem: a step finds no flow, or a value has no number somewhere.
            UserError: the scene's new values make no sense. In both cases the state is that of before, time included.
        """
        before, mesh = self.state, frame.mesh
        new_mesh, new_scene = mesh is not before.mesh, before.interrupted or frame.scene is not before.scene
        try:
            if new_mesh or new_scene:
                self._bind(frame, new_mesh)
            if not new_mesh and mesh.topology != before.topology:
                with self.context.stages("pattern"):
                    self._flip(frame)
            return self._run(frame, new_mesh, before)
        except (ReplayProblem, UserError):
            self.state = replace(before, interrupted=True)
            if before.equations:
                before.system.newton.set_equations(before.equations)
            raise
        finally:
            self._destroy_unused()

    def begin(self, x: np.ndarray, time: float = 0.0) -> None:
        """Let the flow go on from unknowns x (n, f) at a time [s], as if it had not been there before."""
        past, swings = Past(time, Level.of(self.state.problem, x)), Swings(self.state.swings.lifts)
        self.state = replace(self.state, x=x, past=past, swings=swings)

    @property
    def settings(self) -> FlowSettings:
        """Of the time steps."""
        return self.state.plan.settings("flow")

    @property
    def time(self) -> float:
        """Simulated time [s]: that of all steps so far."""
        return made(self.state.past).time

    def row(self) -> RowValues:
        """What the frame's row reports besides: the simulated time [s]."""
        sudden = {"note": IMPULSE} if made(self.state.past).sudden else {}
        notes = still_note(self._strouhal()) | projected_note(made(self.state.past).projected) | sudden
        return notes | super().row() | {"time": self.time}

    def observe(self) -> dict[str, float]:
        """The scene's quantities of interest at the last solution; Strouhal numbers of all steps until then."""
        return super().observe() | self._strouhal()

    def _strouhal(self) -> dict[str, float]:
        return self.state.swings.numbers(self.state.scene.quantities)

    def observed_on(
        self, frame: Frame, before: State[Problem] | None, solved: State[Problem], earlier: bool
    ) -> dict[str, float]:
        """None: how a flow jumps where meshes change is not reported; see `Analysis.observed_on`."""
        return {}

    # --- a frame ------------------------------------------------------------------------------------------------------

    def _bind(self, frame: Frame, new_mesh: bool) -> None:
        before = self.state
        super()._bind(frame, new_mesh)
        problem = self.state.problem
        swings = replace(before.swings, lifts=swinging_lifts(problem, frame.scene.quantities))
        self.state = replace(self.state, swings=swings)
        if not new_mesh:
            return
        if before.past is None:
            x = problem.initial()
            self.state = replace(self.state, x=x, past=Past(0.0, Level.of(problem, x)))

    def _goes_on_from(
        self, equations: ResidualEquations, frame: Frame, before: FlowState
    ) -> tuple[np.ndarray, Past, Outcome | None, float]:
        """Unknowns and past on the mesh as it lies, what it took to take them there, and `Carrier.pressure`."""
        past, old = made(self.state.past), None
        if before.bound is None:
            return self.state.x, past, None, 0.0
        if frame.mesh is not before.mesh:
            old = frame.old_mesh or before.problem.space
        carrier = Carrier(equations, self.state.system.newton, self.settings, self.solver.aim)
        with self.context.stages("map"):
            return *carrier(before.x, past, old), carrier.pressure

    def _run(self, frame: Frame, new_mesh: bool, before: FlowState) -> LinearReport:
        """Take the time steps of a frame; the first one takes none."""
        state, stages = self.state, self.context.stages
        problem, system, equations = state.problem, state.system, state.equations
        if equations is None or equations.problem is not problem:
            equations = ResidualEquations(problem, system.operator, stages)
            system.newton.set_equations(equations)
        again = new_mesh or before.interrupted
        system.newton.begin(again, not again and frame.mesh.topology != before.topology, None)
        x, past, total, pressure = self._goes_on_from(equations, frame, before)
        if before.bound is not None and frame.scene is not before.scene:
            past = with_jumps(past, problem)
        swings, residual, projected = state.swings, 0.0, 0.0
        # Walls move in the first step of a frame, and push what they move: its end is what the lift has come to.
        moved = frame.mesh.geometry != before.geometry
        for k in range(0 if before.bound is None else self.settings.steps):
            past = self._fitting(past, equations)
            step = past.step(problem.space.X, self.settings)
            outcome, x, scale = self._step(equations, step, x, past)
            past = self._after(past, step, problem, x)
            projected = projected or pressure / (pressure_spread(x) or 1.0)
            if not moved or k == self.settings.steps - 1:
                swings = swings.after(step.time, x)
            residual = max(residual, outcome.norm / (scale or 1.0))
            total = outcome if total is None else outcome.after(total)
        total = total or Outcome(True, 0, 0, False, True)
        self.state = replace(
            state,
            scene=frame.scene,
            equations=equations,
            x=x,
            past=replace(past, projected=projected),
            swings=swings,
            topology=frame.mesh.topology,
            geometry=frame.mesh.geometry,
            residual=residual,
            age=0 if total.refreshed else state.age + 1,
            interrupted=False,
        )
        return LinearReport(total.iterations, total.refreshed, self.state.age, self.solver.name, total.newton)

    def _fitting(self, past: Past, equations: ResidualEquations) -> Past:
        """The past whose older velocity fits the newer one."""
        if not past.sudden or self.settings.scheme == "backward_euler":
            return past
        newton, dt = self.state.system.newton, self.settings.time_step
        problem = cast(IncompressibleFlow, equations.problem)
        return after_impulse(past, VelocityCorrection(problem, equations, newton, dt, self.solver.aim))

    @staticmethod
    def _after(past: Past, step: TimeStep, problem: IncompressibleFlow, x: np.ndarray) -> Past:
        """The past after a step to unknowns x (n, f), which was an impulse where the flow began suddenly."""
        begins, last, past = past.before is None, past.last, past.after(step, problem, x)
        return replace(past, sudden=begins and is_sudden(last, past.last, problem))

    def _step(
        self, equations: ResidualEquations, step: TimeStep, x: np.ndarray, past: Past
    ) -> tuple[Outcome, np.ndarray, float]:
        """One time step from the unknowns x (n, 3): what Newton's method took, the unknowns after it, and their scale.

        Raises:
            ReplayProblem: no flow is found.
        """
        problem = cast(IncompressibleFlow, equations.problem)
        with self.context.stages("values"):
            problem.take(step)
            problem.update()
            equations.begin()
        search = self._search(equations)
        outcome, found = search.near(self._guess(x, past.time, step), x)
        if not outcome.converged:
            outcome, found = search.thinned(outcome, x)
        if not outcome.converged:
            raise ReplayProblem(
                f"no flow is found at {step.time:.6g} s: {outcome.why}; make effects.flow.time_step smaller"
            )
        if self.context.policy.extrapolate:
            self._ahead.keep(found, step.time)
        return outcome, found, search.scale

    def _search(self, equations: ResidualEquations) -> FlowSearch:  # type: ignore[override]
        problem = cast(IncompressibleFlow, equations.problem)
        return FlowSearch(problem, equations, self.state.system.newton, lambda: self.solver.aim)

    def _time_guess(self) -> TimeGuess:
        """What foretells the unknowns; those of one name, such as the velocity, alike."""
        ends = [0, *accumulate(len(unknown.components) for unknown in self.make.unknowns)]
        return TimeGuess([slice(*columns) for columns in pairwise(ends)])

    def _guess(self, x: np.ndarray, time: float, step: TimeStep) -> np.ndarray:
        """Unknowns (n, f) after a step from x (n, f) at a time [s]."""
        if not self.context.policy.warm:
            return made(self.state.bound).problem.start()
        return self._ahead(x, time, step.time) if self.context.policy.extrapolate else x.copy()

    # --- for comparison with a cold solve -----------------------------------------------------------------------------

    def compare_cold(self) -> Comparison:
        """The state beside its last time step, taken again with new pattern, values and factor."""
        if self.state.problem.step is None:
            return Comparison(0.0, None)
        return super().compare_cold()

    def cold_system(self) -> GatheredSystem:
        """The tangent after the last step on a new pattern, and the unknowns after that step, from those before."""
        state, context = self.state, replace(self.context, policy=policy("rebuild"))
        problem = self.make(state.scene, state.plan, made(state.bound).mesh)
        problem.take(state.problem.step)
        problem.update()
        tolerance = COLD * self.tolerance
        solver = LinearSolver(
            context.comm,
            f"{self.make.name}_",
            context.policy.solver,
            tolerance,
            context.calibration,
            context.stages,
            traits=self.make.traits(state.plan),
        )
        system = NonlinearSystem(context.comm, problem, None, solver, f"{self.make.name}_newton_")
        equations = ResidualEquations(problem, system.operator, context.stages)
        system.newton.set_equations(equations)
        equations.begin()
        system.newton.begin(True, False, None)
        outcome, x = FlowSearch(problem, equations, system.newton, lambda: tolerance).near(state.x, state.x)
        if not outcome.converged:
            raise ReplayProblem(f"the step has no cold solution: {outcome.why}")
        matrix = gather_matrix(system.newton.tangent(self.x), context.comm)
        system.newton.destroy()
        return GatheredSystem(matrix, x.ravel().copy())
