"""Linear problems in time while the rest shape is edited: implicit steps on kept patterns and factors."""

# More than 15 modules: here time steps, solver, projections and energies of a frame meet, a module each.
import logging
from dataclasses import replace
from functools import partial
from typing import Unpack, cast

import numpy as np
import scipy.sparse as sp
from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.factors.gathering import gather_matrix, gather_vector, matrix_difference
from restshape.algebra.linear import LinearSolver
from restshape.algebra.linear_report import LinearReport
from restshape.analysis.analysis import Comparison, Context, RowValues, State
from restshape.analysis.beside import step_beside
from restshape.analysis.correction import KeptOperation, matrix_product
from restshape.analysis.effective_system import EffectiveSystem
from restshape.analysis.frame import Frame
from restshape.analysis.motion.displacement_projection import project_displacement
from restshape.analysis.motion.increment_subspace import IncrementProjection
from restshape.analysis.motion.modes_beside import ModesBeside
from restshape.analysis.motion.new_mesh_samples import CellSamples
from restshape.analysis.motion.repeated_motion import RepeatedMotion
from restshape.analysis.motion.transient_state import BoundMotion, TransientState
from restshape.analysis.motion.velocity_projection import project_velocity
from restshape.analysis.settings import modal_settings
from restshape.analysis.solution import Solution, moduli_of
from restshape.analysis.time_error import StepMatrix, local_error
from restshape.application import application_of
from restshape.errors import ReplayProblem, UserError
from restshape.fem.error_estimate import RecoveryEstimate
from restshape.fem.problem import MASS, STIFFNESS, Fields, Problem, TransientProblem
from restshape.fem.residuals import Operation
from restshape.fem.semidiscrete import SemiDiscrete
from restshape.fem.space import Space
from restshape.fem.time_integration import IntegrationChanges, TimeIntegration, TimeState
from restshape.first_use import made
from restshape.mesh.transfer import transfer
from restshape.scene.model import Scene
from restshape.scene.plan import Plan
from restshape.scene.plan import plan as planned

LARGEST = 1e100
"""Of unknowns: the squares of stresses of larger ones are no numbers."""
ROUNDING = 1e-10
"""Relative distance that a step has from the same one by another formula where both are solved to rounding."""

NEAR = 2
"""Iterations of a step with an old complete factor up to which estimates take the factor for the matrix's own."""

log = logging.getLogger("restshape.analysis")


class TransientAnalysis:
    """The motion, or diffusion, of a linear problem, frame after frame; an `analysis.Analysis`.

    A frame takes the time steps that the problem's integration asks for, on one matrix; the first frame takes none.
    When the rest shape changes, unknowns and rates stay with the nodes, accelerations never: equilibrium on the new
    shape gives them. What is stale is read from the versions of mesh topology, node places and scene.

    Args:
        scene: what the user wrote.
        plan: which effects are on.
        context: what all parts of the replay share.
        make: the class of the problem, made of scene, plan and space.

    Source: docs/theory/levels-of-reuse.md and solids.md.
    """

    predictor = quantity_errors = None
    why_not = "only steady states and modes are predicted: time integration depends on the past, not on the shape alone"

    def __init__(self, scene: Scene, plan: Plan, context: Context, make: type[TransientProblem]) -> None:
        self.context, self.make = context, make
        self.state = TransientState(plan, scene)
        self.solver = self._make_solver(scene)
        self.estimated_quantity = f"{make.unknowns[0].name} in the energy norm"
        # The largest unknowns that errors of time steps have been related to.
        self._largest = 0.0
        self._observed: tuple[TransientState | None, dict[str, float]] = (None, {})
        self.modes = ModesBeside(modal_settings(plan).modes) if plan.on("modal") else None
        self._unknowns: tuple[TransientState | None, np.ndarray] = (None, self.state.now.y)
        # Of the last solve that was iterative.
        self._iterations = 0
        self._operations: tuple[PETSc.Mat | None, Operation, Operation] = (None, np.copy, np.copy)
        self._estimate: tuple[SemiDiscrete | None, RecoveryEstimate | None] = (None, None)

    def _make_solver(self, scene: Scene) -> LinearSolver:
        """The linear solver that outlives all frames."""
        context = self.context
        return LinearSolver(
            context.comm,
            self.prefix,
            context.policy.solver,
            scene.solve.tolerance,
            context.calibration,
            context.stages,
            memory=scene.solve.factor_memory,
            traits=self.make.traits(self.state.plan),
        )

    @property
    def prefix(self) -> str:
        """Of the options of its solvers in PETSc's database."""
        return f"{self.make.name_in_time or self.make.name}_"

    def solve(self, frame: Frame) -> LinearReport:
        """Bring the motion up to date with a frame.

        Raises:
            ReplayProblem: a solve does not converge, or a value has no number somewhere.
            UserError: the scene's new values make no sense. In both cases the state is that of before, time included.
        """
        before, mesh = self.state, frame.mesh
        try:
            stale, new_mesh = self._follow(frame)
            self.state = self.state.started(None if new_mesh or frame.interpolations else before)
            # The solver may have met the mesh of a frame that failed, which is gone.
            steps = 0 if before.bound is None else self.state.integration.steps
            report = self._run(stale, new_mesh or before.interrupted, steps)
        except (ReplayProblem, UserError):
            self.state = replace(before, interrupted=True)
            raise
        versions = {"topology": mesh.topology, "geometry": mesh.geometry}
        self.state = self.state.changed(**versions, scene=frame.scene, interrupted=False)
        return report

    def begin(self, x: np.ndarray, v: np.ndarray, time: float = 0.0) -> None:
        """Let the motion go on from unknowns x (n, f) and rates v (n, f) at a time [s]."""
        bound = made(self.state.bound)
        bound = replace(bound, increments=self._no_increments(bound.body, bound.system))
        self.state = replace(self.state, bound=bound)
        self._enter(x - self.problem.boundary.values, v, time)
        account = self.state.account
        self.state = replace(self.state, account=replace(account, last=self.energy() if account.known else 0.0))

    def set_integration(self, **changes: Unpack[IntegrationChanges]) -> None:
        """Let the next steps be others: changes of the `TimeIntegration`, until the scene's settings are read again."""
        self.state = replace(self.state, in_time=replace(self.state.integration, **changes))

    def observed_on(
        self, frame: Frame, before: State[Problem] | None, solved: State[Problem], earlier: bool
    ) -> dict[str, float]:
        """The quantities of a frame on another mesh of its shape; see `Analysis.observed_on`.

        On the mesh before a change the frame's steps are taken once more, from the state before them; a state of the
        shape before is brought to the new mesh.
        """
        # Both states are those of an analysis of this kind.
        start = cast(TransientState, before)
        if start is None or start.bound is None:
            return {}
        self._follow(frame)
        if earlier:
            return self._observed_before(start)
        if start.now.y.shape[0] != len(frame.mesh.X):
            return {}
        now, integration = start.now, cast(TransientState, solved).integration
        self.begin(now.y + self.problem.boundary.values, now.v, now.time)
        # As in the replay the edit's work is accounted for.
        account = replace(start.account, known=self.state.account.known)
        self.state = replace(self.state, in_time=integration, account=account)
        if account.known:
            self._account(edited=True)
        self.state = self.state.started(None)
        self._run(True, True, integration.steps)
        return self.observe()

    def observed_beside(self, frame: Frame, before: State[Problem] | None) -> dict[str, float] | None:
        """The quantities of a single step on another mesh with the same nodes; see `Analysis.observed_beside`."""
        start, solved = cast(TransientState, before), self.state
        integration, scheme = solved.integration, solved.integration.scheme
        wanted = integration.steps == 1 and not scheme.a5 and self.problem.linear and self.modes is None
        if not (wanted and start and start.bound and self.solver.kept.ready) or solved.account.known:
            return None
        body = SemiDiscrete(self.make(frame.scene, solved.plan, frame.mesh), integration.damping)
        if not body.constrained.shape == start.now.y.shape == solved.now.y.shape:
            return None
        rest = ~body.constrained
        first = start.now._replace(y=start.now.y * rest, v=start.now.v * rest)
        base = integration.step_acceleration(first.time, first.y.shape[1])
        matrix = replace(self._last_matrix(), complete=self.solver.kept.exact)
        y = step_beside(body, solved.body, scheme, first, solved.now.y, base, matrix)
        if not np.isfinite(y).all():
            return None
        now = scheme.after(first, y)
        state = solved.beside(body, now)
        observer = body.problem.motion_observer(frame.scene.quantities, body.mass)
        return observer(body.unknowns(y), state.motion)

    def _observed_before(self, before: TransientState) -> dict[str, float]:
        """The quantities of a state brought to this mesh, of its shape; peaks over time steps have none."""
        old, new, now = before.body, self.body, before.now
        if old.problem.space.outline is not new.problem.space.outline:
            return {}
        # Where flips did not suffice they have moved nodes in the middle of edges, after this state.
        space = old.problem.space
        y, rates = (space.interpolate(field, space.interpolations) for field in (old.unknowns(now.y), now.v))
        x, v = self._brought(old, y, rates, before.integration.scheme.order == 2)
        self.begin(x, v, now.time)
        account = before.account
        if account.known:
            account = replace(account, remesh=account.remesh + (self.energy() - account.last))
        self.state = replace(self.state, account=account)
        watched = self.state.observer.watched
        return {name: value for name, value in self.observe().items() if name not in watched}

    # --- what is asked of a state -------------------------------------------------------------------------------------

    @property
    def x(self) -> np.ndarray:
        """Unknowns (n, f) after the last step, relative to the base; made once a state, not to be changed."""
        state = self.state
        if self._unknowns[0] is not state:
            self._unknowns = (state, state.now.y if state.bound is None else state.body.unknowns(state.now.y))
        return self._unknowns[1]

    @property
    def v(self) -> np.ndarray:
        """Their rates (n, f) [1/s]."""
        return self.state.now.v

    @property
    def time(self) -> float:
        """Simulated time [s]: that of all steps so far."""
        return self.state.now.time

    @property
    def inertia(self) -> bool:
        """Whether it is of second order in time, so that there is an energy of motion."""
        return self.state.integration.scheme.order == 2

    @property
    def body(self) -> SemiDiscrete:
        """What moves."""
        return self.state.body

    @property
    def problem(self) -> TransientProblem:
        """The problem of what moves."""
        return self.state.body.problem

    @property
    def space(self) -> Space | None:
        """Where the unknowns live; None before the first solution."""
        return self.state.space

    @property
    def unknowns(self) -> int:
        """Unknowns of the linear system, prescribed ones included."""
        return self.state.now.y.size

    @property
    def tolerance(self) -> float:
        """That repeated steps meet, in the norm of their matrix; not below what rounding may leave."""
        return max(self.state.scene.solve.tolerance, ROUNDING)

    def observe(self) -> dict[str, float]:
        """The scene's quantities of interest after the last step, evaluated once a frame."""
        if self._observed[0] is not self.state:
            motion = self.state.motion if self.modes is None else replace(self.state.motion, modes=self._frequencies)
            self._observed = (self.state, self.state.observer(self.x, motion))
        return self._observed[1]

    def row(self) -> RowValues:
        """Columns of the frame's row that only this analysis has: the simulated time [s], and those of modes."""
        return {"time": self.time} | (self.modes.row(self) if self.modes else {})

    def _frequencies(self) -> np.ndarray:
        """Eigenfrequencies (k,) [Hz] of the present shape."""
        return made(self.modes)(self).frequencies

    def linear_displacement(self) -> np.ndarray | None:
        """The unknowns (n, f), where they are displacements [m] of linear theory; no copy."""
        return self.problem.linear_displacement(self.x)

    def solution(self) -> Solution:
        """The unknowns and, of second order in time, their rates, and what their energies are measured by."""
        state, problem, name = self.state, self.problem, self.problem.unknowns[0].name
        large, averaged = not problem.linear, problem.nested is not problem
        found = Solution(name, self.x.copy(), moduli=moduli_of(problem), large=large, averaged=averaged)
        if state.integration.scheme.order < 2:
            return found
        mass = np.array(np.broadcast_to(state.body.mass.params, (len(problem.space.cells), 1)))[:, 0]
        return replace(found, rate=self.v.copy(), mass=mass)

    def fields(self) -> Fields:
        """What a recording shows of the unknowns after the last step."""
        return self.problem.fields(self.x)

    def blank_fields(self, space: Space) -> Fields:
        """The same fields, all NaN, on a space that has not been solved on."""
        return self.make.blank_fields(space)

    def energy(self) -> float:
        """Internal energy and kinetic energy relative to the base [J]."""
        return self.state.body.energy(self.state.now.y, self.state.now.v)

    def residual_norm(self) -> float:
        """The true residual of the last step's solve, relative to its right side."""
        return self.state.system.residual()

    def errors(self) -> dict[str, float]:
        """The estimated relative error of the mesh in the unknowns after the last step, and that of the step alone."""
        return {"estimate": self.error_estimate.relative(self.x), "estimate_time": self._time_error()}

    @property
    def error_estimate(self) -> RecoveryEstimate:
        """The estimate on the problem's space, kept until there is another problem."""
        body, estimate = self._estimate
        if estimate is None or body is not self.body:
            estimate = made(self.problem.error_estimate())
            self._estimate = (self.body, estimate)
        return estimate

    def _time_error(self) -> float:
        """The estimated error of the last step over the largest unknowns of a frame so far, or NaN."""
        state = self.state
        before, now, scheme = state.previous, state.now, state.integration.scheme
        if not before.time < now.time or before.y.shape != now.y.shape:
            return float("nan")
        accelerations = self._base_acceleration(before.time), self._base_acceleration(now.time)
        error = local_error(state.body, scheme, (before, now), accelerations, self._last_matrix())
        self._largest = max(self._largest, _kernels.largest_norm(self.x))
        return _kernels.largest_norm(error) / self._largest if self._largest else float("nan")

    def _last_matrix(self) -> StepMatrix:
        """The matrix of the last step."""
        system, solver = self.state.system, self.solver
        if self._operations[0] is not system.mat:
            product = matrix_product(system.mat, system.rows, self.context.comm)
            self._operations = (system.mat, product, KeptOperation(solver, system.rows))
        exact = solver.factored or (solver.kept.complete and self._iterations <= NEAR)
        return StepMatrix(*self._operations[1:], exact, solver.kept.complete)

    # --- a new frame --------------------------------------------------------------------------------------------------

    def _follow(self, frame: Frame) -> tuple[bool, bool]:
        """Take up the frame's mesh and scene; returns whether the matrix is stale, and the mesh another one."""
        mesh, before = frame.mesh, self.state
        new_mesh = mesh is not before.space
        new_scene = before.interrupted or before.bound is None or frame.scene is not before.scene
        flipped = mesh.topology != before.topology
        if not (new_mesh or new_scene or flipped or mesh.geometry != before.geometry):
            return False, False
        if frame.interpolations:
            prescribed, now = self.problem.boundary.values, before.now
            moved = now._replace(y=frame.interpolate(self.x) - prescribed, v=frame.interpolate(now.v))
            self.state = replace(before, now=moved)
        if new_scene:
            self._read(frame.scene)
        if new_mesh or new_scene:
            self._bind(frame.scene, mesh, new_mesh)
        else:
            if flipped:
                with self.context.stages("pattern"):
                    self.state.system.patch(frame.changed_cells)
            self.state.body.update()
            if self.state.integration.scheme.a5 or frame.interpolations:
                self._enter(self.state.now.y, self.state.now.v, self.time)
        if self.state.account.known:
            self._account(edited=True)
        return True, new_mesh

    def _account(self, edited: bool) -> None:
        """Take in the present energy, and its change as work of the edit where one was made."""
        account, found = self.state.account, self.energy()
        edit = account.edit + (found - account.last) if edited else account.edit
        self.state = replace(self.state, account=replace(account, last=found, edit=edit))

    def _read(self, scene: Scene) -> None:
        """Take the settings of a scene, whose values may be others."""
        state = self.state
        plan = state.plan if scene is state.scene else planned(scene, application_of(scene))
        in_time = self.make.time_integration(plan, state.in_time, self.time)
        known = self.make.accounts_energy(scene.quantities)
        account = replace(state.account, known=known)
        self.state = replace(state, plan=plan, in_time=in_time, account=account)

    def _bind(self, scene: Scene, mesh: Space, new_mesh: bool) -> None:
        """Set up what depends on the mesh topology or on the scene's values, and bring the motion there."""
        before, integration = self.state, self.state.integration
        with self.context.stages("pattern"):
            problem = self.make(scene, before.plan, mesh)
            problem.share(self.context.comm)
            body = SemiDiscrete(problem, integration.damping)
            if new_mesh:
                system = self._make_system(body, integration)
                increments = self._no_increments(body, system)
            else:
                system, increments = before.system, made(before.bound).increments
                system.bind(body, integration.scheme)
        observer = problem.motion_observer(scene.quantities, body.mass)
        self.state = replace(before, bound=BoundMotion(body, system, observer, increments))
        if before.bound is None:
            first = body.problem.initial() - body.problem.boundary.values
            self._enter(first, np.zeros_like(first), 0.0)
        elif new_mesh:
            with self.context.stages("map"):
                self._project(before.body)
        else:
            self._enter(self.state.now.y, self.state.now.v, self.time)

    def _make_system(self, body: SemiDiscrete, integration: TimeIntegration) -> EffectiveSystem:
        """What solves for the steps on a new mesh."""
        return EffectiveSystem(self.context.comm, body, integration.scheme, self.context.policy.backend)

    def _project(self, before: SemiDiscrete) -> None:
        """Bring the motion to a new mesh."""
        state = self.state
        body, now, account = state.body, state.now, state.account
        if account.known:
            # The nodes of the mesh before already lie on the new shape, wherever they could follow it.
            energy = before.energy(now.y, now.v)
            account = replace(account, edit=account.edit + (energy - account.last))
        second = state.integration.scheme.order == 2
        x, v = self._brought(before, before.unknowns(now.y), now.v, second)
        log.info("Unknowns %s to %d nodes", "and velocities projected" if second else "interpolated", len(x))
        self._enter(x - body.problem.boundary.values, v, self.time)
        if account.known:
            last = self.energy()
            account = replace(account, last=last, remesh=account.remesh + (last - energy))
        self.state = replace(self.state, account=account)

    def _brought(self, old: SemiDiscrete, x: np.ndarray, v: np.ndarray, second: bool) -> tuple[np.ndarray, np.ndarray]:
        """Unknowns and rates (n, f) on a new mesh: projected where the problem is of second order in time.

        Those of diffusion are interpolated, and their rates are new. So are both where an edit has changed the order of
        the elements. The operator of the steps lends its pattern.
        """
        new, space = self.body, self.problem.space
        if not second:
            there = transfer(old.problem.space, space, x)
            return there, np.zeros_like(there)
        if old.problem.space.cells.shape[1] != space.cells.shape[1]:
            return transfer(old.problem.space, space, x), transfer(old.problem.space, space, v)
        samples = CellSamples(old.problem.space, space)
        shared = self.state.system.operator if self.context.comm.size == 1 else None
        factor = partial(self.solver.factor_beside, uses=self.state.integration.steps)
        there = project_displacement(old, new, x, samples, shared, factor)
        return there, project_velocity(old.mass, new.mass, v, samples, shared)

    def _enter(self, y: np.ndarray, v: np.ndarray, time: float) -> None:
        """Make y and v the state, at rest where prescribed, with the acceleration that equilibrium asks for."""
        body = self.state.body
        y, v = (np.where(body.constrained, 0.0, values) for values in (y, v))
        a = body.acceleration(y, v, self._base_acceleration(time)) if self.state.integration.scheme.a5 else None
        now = TimeState(y, v, a, time)
        self.state = replace(self.state, now=now, previous=now)

    # --- time steps ---------------------------------------------------------------------------------------------------

    def _run(self, stale: bool, new_system: bool, steps: int) -> LinearReport:
        """Take the time steps of a frame; the matrix of a frame without any is made too."""
        if stale and not steps:
            self._make_matrix()
        age = self.state.age + 1
        if not steps:
            self.state = replace(self.state, age=age)
            return LinearReport(0, False, 0, self.solver.name)
        iterations, newton, refreshed = 0, 0, False
        if self.state.observer.watched:
            self.state.observer.begin()
        for k in range(steps):
            report = self._step(stale and k == 0, new_system and k == 0, steps - k)
            iterations, refreshed = iterations + report.iterations, refreshed or report.refreshed
            newton += report.newton
            self._refuse_growth()
        self.state = self.state.changed(age=0 if refreshed else age)
        if self.state.account.known:
            self._account(edited=False)
        return LinearReport(iterations, refreshed, self.state.age, self.solver.name, newton)

    def _refuse_growth(self) -> None:
        """Raises `ReplayProblem` where the motion is so large that squares of its stresses have no number."""
        largest = _kernels.largest_size(self.state.now.y)
        if not largest < LARGEST:
            what = f"the motion grows without bound: its largest value is {largest:.1e}"
            raise ReplayProblem(f"{what}; take a shorter time_step, or settings of its method that are stable for any")

    def _make_matrix(self) -> None:
        """The matrix of a frame without steps, for looking at."""
        system = self.state.system
        with self.context.stages("values"):
            system.assemble(self.state.now, np.zeros(system.right.shape[1]))
        system.right[:] = 0.0

    def _step(self, stale: bool, new_system: bool, steps: int) -> LinearReport:
        """One time step, the first of so many."""
        bound, state, integration = made(self.state.bound), self.state.now, self.state.integration
        system, scheme = bound.system, integration.scheme
        components = state.y.shape[1]
        with self.context.stages("values"):
            base_acceleration = integration.step_acceleration(state.time, components)
            (system.assemble if stale else system.right_side)(state, base_acceleration)
        if stale:
            self.solver.prepare(system.mat, new_system, steps)
        factored = self.solver.factored
        guessed = self.context.policy.extrapolate and not factored
        if factored:
            report = self.solver.apply(system.b, system.solution)
        else:
            system.full[:] = state.y.ravel() if self.context.policy.warm else 0.0
            system.solution.stateIncrease()
            if guessed:
                system.force(bound.increments.next_force)
                bound.increments.add_to(system.full)
                system.solution.stateIncrease()
            report = self.solver.solve(system.mat, system.b, system.solution, new_system, not stale, uses=steps)
            self._iterations = report.iterations
        if self.context.comm.size > 1:
            gather_vector(system.full, system.rows, self.context.comm)
        y = system.full.reshape(state.y.shape).copy()
        if guessed:
            bound.increments.keep(y, state.y)
        self._set_motion(self._settled(scheme.after(state, y)))
        return report

    def _settled(self, now: TimeState) -> TimeState:
        """The state after a step, with the acceleration that equilibrium asks for where its recursion is unstable.

        The recursion multiplies the rounding of the acceleration by -a3 each step, and the system, which takes M a from
        the forces, does not correct that: with a3 > 1, so beta < 1/4, the acceleration is solved for.
        """
        if now.a is None or self.state.integration.scheme.a3 <= 1.0:
            return now
        return now._replace(a=self.state.body.acceleration(now.y, now.v, self._base_acceleration(now.time)))

    def _set_motion(self, now: TimeState) -> None:
        """Take in the state after a step."""
        self.state = state = self.state.after(now)
        observer = state.observer
        if observer.watched:
            observer.step(self.x, state.motion)

    def _no_increments(self, body: SemiDiscrete, system: EffectiveSystem) -> IncrementProjection:
        rows = system.rows
        return IncrementProjection(body.static.size, rows.stop - rows.start, self.context.comm)

    def _base_acceleration(self, time: float) -> np.ndarray:
        return self.state.integration.base_acceleration(time, self.state.body.static.shape[1])

    # --- for comparison with other solves -----------------------------------------------------------------------------

    def matrices(self) -> tuple[sp.csr_matrix, sp.csr_matrix, sp.csr_matrix]:
        """Stiffness, mass and damping of the free unknowns (ascending; f i + a at node i), whole on each rank."""
        body = self.state.body
        free, zero, found = np.flatnonzero(~body.constrained.ravel()), np.zeros_like(body.static), []
        for kind in (STIFFNESS, MASS):
            terms = [part.term(zero) for part in body.problem.integrals(kind)]
            matrix = self.state.system.mass.assemble(terms, None)
            found.append(gather_matrix(matrix, self.context.comm)[free][:, free])
        stiffness, mass = found
        return stiffness, mass, body.damping_of.alpha * mass + body.damping_of.beta * stiffness

    def compare_cold(self) -> Comparison:
        """The steps of the frame beside the same ones repeated from its first state, by matrices made from nothing.

        The first state is that of the frame before, unless the nodes are others now. A frame without steps gives its
        matrix alone.
        """
        state = self.state
        body = SemiDiscrete(self.make(state.scene, state.plan, self.problem.space), state.integration.damping)
        repeated = RepeatedMotion(body, state.integration)
        matrix = self.step_matrix()[repeated.free][:, repeated.free]
        entries = matrix_difference(matrix, repeated.tangent(state.now.y))
        if state.start is state.now:
            return Comparison(entries, None)
        jump = 0.0 if state.last_end is None else repeated.distance(state.start, state.last_end)
        distance = repeated.distance(state.now, repeated(state.start))
        return Comparison(entries, max(jump, distance / state.integration.steps))

    def step_matrix(self) -> sp.csr_matrix:
        """The matrix of the last step as it stands, whole on every rank."""
        return gather_matrix(self.state.system.mat, self.context.comm)
