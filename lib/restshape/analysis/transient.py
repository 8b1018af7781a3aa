"""Linear solids that vibrate while their rest shape is edited: Newmark steps on kept patterns and factors."""

from dataclasses import replace

import numpy as np
import scipy.sparse as sp
from petsc4py import PETSc
from scipy.sparse.linalg import spsolve

from restshape.algebra.gather import System, whole_matrix, whole_vector
from restshape.algebra.linear import LinearSolver
from restshape.algebra.linear_report import LinearReport, true_residual
from restshape.algebra.stages import Stages
from restshape.analysis.velocity_projection import project_velocity
from restshape.analysis.correction import preconditioner
from restshape.analysis.effective import EffectiveSystem, State
from restshape.analysis.estimated import Estimated
from restshape.analysis.frame import Frame
from restshape.analysis.increment_subspace import IncrementProjection
from restshape.analysis.shown import DisplacedSolid
from restshape.analysis.time_error import local_error
from restshape.application import application
from restshape.calibration import Calibration
from restshape.errors import ReplayProblem, UserError
from restshape.mesh.mesh import Mesh
from restshape.mesh.transfer import transfer
from restshape.physics.elasticity.dynamics import Ground, Newmark
from restshape.physics.elasticity.motion import Motion, MotionObserver
from restshape.physics.elasticity.quantities import von_mises
from restshape.physics.elasticity.moving_solid import VibratingSolid
from restshape.policy import Policy
from restshape.scene.model import Scene
from restshape.scene.plan import Plan
from restshape.scene.plan import plan as planned

NO_SHAKING = np.zeros(2)


class TransientAnalysis(Estimated, DisplacedSolid):
    """The motion of a linear elastic solid relative to the ground, frame after frame.

    A frame takes the time steps that ``[effects.dynamics]`` asks for, on one matrix; the first frame takes none. When
    the rest shape changes, displacement and velocity stay with the nodes, the acceleration never: equilibrium on the
    new shape gives it anew. What is stale is read from the versions of mesh topology, node places and scene.

    Args:
        scene: what the user wrote.
        plan: which effects are on.
        comm: PETSc communicator.
        policy: what is reused.
        calibration: seconds a unit of counted work.
        stages: takes the time of each stage.

    Source: docs/theory.md, sections 1 and 2.
    """

    def __init__(
        self, scene: Scene, plan: Plan, comm: PETSc.Comm, policy: Policy, calibration: Calibration, stages: Stages
    ) -> None:
        self.plan, self.comm, self.policy, self.stages = plan, comm, policy, stages
        self.scene: Scene | None = None
        self.mesh: Mesh | None = None
        self.topology = self.geometry = -1
        self.age = 0
        self.body: VibratingSolid | None = None
        self.ground: Ground | None = None
        self.state = self.previous = State(np.zeros((0, 2)), np.zeros((0, 2)), None, 0.0)
        self.motion = Motion(self.state.v)
        self.energy_before = 0.0
        # The largest displacement that errors of time steps have been related to.
        self.farthest = 0.0
        self.unsolved, self.exact, self.failed = True, False, False
        self.observed: dict[str, float] | None = None
        self.calibration = calibration
        self.solver = self._make_solver(scene)

    def _make_solver(self, scene: Scene) -> LinearSolver:
        """The linear solver that outlives all frames."""
        return LinearSolver(
            self.comm,
            "motion_",
            self.policy.solver,
            scene.solve.tolerance,
            self.calibration,
            self.stages,
            memory=scene.solve.factor_memory,
            symmetric=self.plan.solver.symmetric,
        )

    def solve(self, frame: Frame) -> LinearReport:
        """Bring the displacement `x` (n, 2) [m] and the velocity `v` (n, 2) [m/s] up to date with a frame.

        Raises:
            ReplayProblem: a solve does not converge, or a value has no number somewhere.
            UserError: the scene's new values make no sense. In both cases mesh, motion and time stay as they were.
        """
        kept, motion = self.__dict__.copy(), replace(self.motion)
        try:
            stale, new_mesh = self._follow(frame)
            # The solver may have met the mesh of a frame that failed, which is gone.
            report = self._run(stale, new_mesh or self.failed, 0 if kept["mesh"] is None else self.steps)
        except (ReplayProblem, UserError):
            # Without a scene the next frame binds anew.
            self.__dict__.update(kept, scene=None, failed=True)
            vars(self.motion).update(vars(motion))
            raise
        mesh, self.failed = frame.mesh, False
        self.mesh, self.scene, self.topology, self.geometry = mesh, frame.scene, mesh.topology, mesh.geometry
        return report

    def begin(self, u: np.ndarray, v: np.ndarray, time: float = 0.0) -> None:
        """Let the motion go on from displacements u (n, 2) [m] and velocities v (n, 2) [m/s] at a time [s]."""
        self.increments = self._no_increments()
        self._enter(u - self.body.solid.prescribed, v, time)
        self.energy_before = self.energy() if self.tracked else 0.0

    @property
    def x(self) -> np.ndarray:
        """Displacements (n, 2) [m] relative to the ground."""
        return self.state.y if self.body is None else self.state.y + self.body.solid.prescribed

    @property
    def v(self) -> np.ndarray:
        """Velocities (n, 2) [m/s] relative to the ground."""
        return self.state.v

    @property
    def time(self) -> float:
        """Simulated time [s]: that of all steps so far."""
        return self.state.time

    @property
    def unknowns(self) -> int:
        """Unknowns of the linear system, prescribed ones included."""
        return self.state.y.size

    def observe(self) -> dict[str, float]:
        """The scene's quantities of interest after the last step, evaluated once a frame."""
        if self.observed is None:
            self.observed = self.observer(self.x)
        return self.observed

    def von_mises(self) -> np.ndarray:
        """Equivalent stress (ne,) [Pa] of each cell after the last step."""
        return von_mises(self.body.solid.stress(self.x))

    def energy(self) -> float:
        """Strain energy and kinetic energy relative to the ground [J]."""
        return self.body.energy(self.state.y, self.state.v)

    def residual(self) -> float:
        """The true residual of the last step's solve, relative to its right side."""
        return true_residual(self.system_now.mat, self.system_now.b, self.system_now.solution)

    def estimate(self) -> float:
        """The estimated relative error of the mesh in the displacement after the last step, in the energy norm."""
        return self.estimator_of(self.body.solid).relative(self.x)

    def estimate_time(self) -> float:
        """The estimated error of the last step alone over the largest displacement of a frame so far, or NaN."""
        before, now = self.previous, self.state
        if not before.time < now.time or before.y.shape != now.y.shape:
            return float("nan")
        shaken = self._shaking(before.time), self._shaking(now.time)
        kept = preconditioner(self.solver, self.system_now.rows)
        error = local_error(self.body, self.newmark, (before, now), shaken, kept)
        self.farthest = max(self.farthest, float(np.linalg.norm(self.x, axis=1).max()))
        return float(np.linalg.norm(error, axis=1).max()) / self.farthest if self.farthest else float("nan")

    # --- a new frame ----------------------------------------------------------------------------------------------

    def _follow(self, frame: Frame) -> tuple[bool, bool]:
        """Take up the frame's mesh and scene; tells whether the matrix is stale, and the mesh another one."""
        mesh = frame.mesh
        new_mesh, new_scene = mesh is not self.mesh, frame.scene is not self.scene
        flipped = mesh.topology != self.topology
        if not (new_mesh or new_scene or flipped or mesh.geometry != self.geometry):
            return False, False
        if frame.reseats:
            prescribed = self.body.solid.prescribed
            self.state = self.state._replace(y=frame.reseat(self.x) - prescribed, v=frame.reseat(self.v))
        if new_scene:
            self._read(frame.scene)
        if new_mesh or new_scene:
            self._bind(frame.scene, mesh, new_mesh)
        else:
            if flipped:
                with self.stages("pattern"):
                    self.system_now.patch(frame.changed_cells)
            self.body.move()
            if self.newmark.a5 or frame.reseats:
                self._enter(self.state.y, self.state.v, self.time)
        if self.tracked:
            energy = self.energy()
            self.motion.edit += energy - self.energy_before
            self.energy_before = energy
        return True, new_mesh

    def _read(self, scene: Scene) -> None:
        """Take the settings of a scene, whose values may be others."""
        if self.mesh is not None:
            self.plan = planned(scene, application(scene.app))
        settings = self.plan.settings("dynamics")
        self.newmark, self.steps = Newmark(settings.beta, settings.gamma, settings.time_step), settings.steps
        shaking = self.plan.settings("ground")
        self.ground = None if shaking is None else Ground(shaking, self.ground, self.time)
        self.tracked = any(quantity.energy in ("edit", "remesh") for quantity in scene.quantities.values())

    def _bind(self, scene: Scene, mesh: Mesh, new_mesh: bool) -> None:
        """Set up what depends on the mesh topology or on the scene's values, and bring the motion there."""
        before = self.body
        with self.stages("pattern"):
            self.body = VibratingSolid(scene, self.plan, mesh)
            if new_mesh:
                self.system_now = self._make_system()
                self.increments = self._no_increments()
            else:
                self.system_now.bind(self.body, self.newmark)
        if before is None:
            self._enter(np.zeros_like(mesh.X), np.zeros_like(mesh.X), 0.0)
        elif new_mesh:
            with self.stages("map"):
                self._carry(before)
        else:
            self._enter(self.state.y, self.state.v, self.time)
        self.observer = MotionObserver(self.body.solid, self.body.inertia, self.motion, scene.quantities)

    def _make_system(self) -> EffectiveSystem:
        """What solves for the steps on a new mesh."""
        return EffectiveSystem(self.comm, self.body, self.newmark, self.policy.backend)

    def _carry(self, before: VibratingSolid) -> None:
        """Bring the motion to a new mesh: displacements interpolated, velocities projected."""
        x, v = self.state.y + before.solid.prescribed, self.state.v
        if self.tracked:
            # The nodes of the mesh before already lie on the new shape, wherever they could follow it.
            energy = before.energy(self.state.y, v)
            self.motion.edit += energy - self.energy_before
        y = transfer(before.mesh, self.body.mesh, x) - self.body.solid.prescribed
        self._enter(y, project_velocity(before.inertia, self.body.inertia, v), self.time)
        if self.tracked:
            self.energy_before = self.energy()
            self.motion.remesh += self.energy_before - energy

    def _enter(self, y: np.ndarray, v: np.ndarray, time: float) -> None:
        """Make y and v the state, at rest where the body is held, with the acceleration that equilibrium asks for."""
        y, v = (np.where(self.body.held, 0.0, values) for values in (y, v))
        a = self.body.acceleration(y, v, self._shaking(time)) if self.newmark.a5 else None
        self.state = self.previous = State(y, v, a, time)
        self.motion.v, self.observed = v, None

    # --- time steps -----------------------------------------------------------------------------------------------

    def _run(self, stale: bool, new_system: bool, steps: int) -> LinearReport:
        """Take the time steps of a frame; the matrix of a frame without any is made too."""
        if stale and not steps:
            self._make_matrix()
        self.age += 1
        if not steps:
            return LinearReport(0, False, 0, self.solver.name)
        iterations, newton, refreshed = 0, 0, False
        if self.observer.watched:
            self.observer.begin()
        for k in range(steps):
            report = self._step(stale and k == 0, new_system and k == 0)
            iterations, refreshed = iterations + report.iterations, refreshed or report.refreshed
            newton += report.newton
        self.age = 0 if refreshed else self.age
        if self.tracked:
            self.energy_before = self.energy()
        self.observed = None
        return LinearReport(iterations, refreshed, self.age, self.solver.name, newton)

    def _make_matrix(self) -> None:
        """The matrix of a frame without steps, for looking at."""
        with self.stages("values"):
            self.system_now.assemble(self.state, NO_SHAKING)
        self.system_now.rhs[:] = 0.0

    def _step(self, stale: bool, new_system: bool) -> LinearReport:
        """One time step."""
        system, state, step = self.system_now, self.state, self.newmark
        time = state.time + step.dt
        with self.stages("values"):
            shaking = self._shaking(time) + step.a3 * self._shaking(state.time)
            (system.assemble if stale else system.right_side)(state, shaking)
        if stale:
            self.exact = self.solver.prepare(system.mat, new_system, self.steps)
        guessed = self.policy.extrapolate and not self.exact
        if self.exact:
            report = self.solver.apply(system.b, system.solution)
        else:
            system.full[:] = state.y.ravel()
            system.solution.stateIncrease()
            if guessed:
                system.full += self.increments(system.force())
                system.solution.stateIncrease()
            report = self.solver.solve(system.mat, system.b, system.solution, new_system, not stale)
        whole_vector(system.full, system.rows, self.comm)
        y = system.full.reshape(-1, 2).copy()
        moved = y - state.y
        v = step.a1 * moved - step.a4 * state.v
        a = None
        if state.a is not None:
            v -= step.a5 * state.a
            a = step.a0 * moved - step.a2 * state.v - step.a3 * state.a
        if guessed:
            self.increments.keep(moved.ravel())
        self.previous, self.state = state, State(y, v, a, time)
        self.motion.v, self.unsolved = v, False
        if self.observer.watched:
            self.observer.step(self.x)
        return report

    def _no_increments(self) -> IncrementProjection:
        rows = self.system_now.rows
        return IncrementProjection(self.body.mesh.X.size, rows.stop - rows.start, self.comm)

    def _shaking(self, time: float) -> np.ndarray:
        return NO_SHAKING if self.ground is None else self.ground.acceleration(time)

    # --- for comparison with other solves -------------------------------------------------------------------------

    def matrices(self) -> tuple[sp.csr_matrix, sp.csr_matrix, sp.csr_matrix]:
        """Stiffness, mass and damping of the free unknowns (ascending; 2 i + a at node i), whole on each rank."""
        solid, inertia, X = self.body.solid, self.body.inertia, self.body.mesh.X
        free = np.flatnonzero(~self.body.held.ravel())
        found = []
        for element, params in ((solid.element, solid.stiffness_params), (inertia.element, inertia.params)):
            operator = self.system_now.mass
            matrix = operator.assemble([(0, element, X, np.zeros_like(X), params, 1.0)], None)
            found.append(whole_matrix(matrix, self.comm)[free][:, free])
        self.system_now.products_current = False
        stiffness, mass = found
        return stiffness, mass, self.body.rayleigh.alpha * mass + self.body.rayleigh.beta * stiffness

    def system(self) -> System:
        """The matrix and the solution of the last step as they stand, whole on every rank."""
        return System(whole_matrix(self.system_now.mat, self.comm), self.system_now.full.copy())

    def cold_system(self) -> System:
        """Matrix and solution of the last step with new pattern, values and factor, and no guess."""
        body = VibratingSolid(self.scene, self.plan, self.mesh)
        cold = EffectiveSystem(self.comm, body, self.newmark, "coo")
        before, now = self.previous, self.state
        cold.assemble(before, self._shaking(now.time) + self.newmark.a3 * self._shaking(before.time))
        matrix, b = whole_matrix(cold.mat, self.comm), whole_vector(cold.rhs.ravel(), cold.rows, self.comm)
        if self.unsolved:
            return System(matrix, np.zeros_like(b))
        return System(matrix, spsolve(matrix.tocsc(), b))
