"""Linear solids at rest: one solve a frame, reusing pattern, factor and solution of the frames before."""

import numpy as np
from petsc4py import PETSc
from scipy.sparse.linalg import spsolve

from restshape.algebra.gather import System, whole_matrix, whole_vector
from restshape.algebra.linear import LinearSolver
from restshape.algebra.linear_report import LinearReport, true_residual
from restshape.algebra.operator import Operator
from restshape.algebra.stages import Stages
from restshape.analysis.correction import correction
from restshape.analysis.estimated import Estimated
from restshape.analysis.frame import Frame
from restshape.analysis.guess import Guess
from restshape.analysis.shown import DisplacedSolid
from restshape.application import application
from restshape.calibration import Calibration
from restshape.errors import ReplayProblem, UserError
from restshape.mesh.mesh import Mesh
from restshape.mesh.transfer import transfer
from restshape.physics.elasticity.quantities import Observer, von_mises
from restshape.physics.elasticity.plane_solid import PlaneSolid
from restshape.policy import Policy
from restshape.scene.model import Quantity, Scene
from restshape.scene.plan import Plan
from restshape.scene.plan import plan as planned

SCALE_SLACK = 1.1
"""A residual is measured against internal forces that are known up to this factor."""

ROUND_OFF = 1e-13
"""A residual below this share of the right side is rounding, as where supports only carry the body somewhere else."""


class StaticAnalysis(Estimated, DisplacedSolid):
    """The equilibrium of a linear elastic solid, frame after frame.

    What is stale is read from the versions of mesh topology, node places and scene; nobody tells the analysis.

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
        self.calibration = calibration
        self.scene: Scene | None = None
        self.mesh: Mesh | None = None
        self.physics: PlaneSolid | None = None
        self.operator: Operator | None = None
        self.topology = self.geometry = -1
        self.scale: float | None = None
        self.failed = self.accepted = False
        self.x = np.zeros((0, 2))
        self.observed: dict[str, float] | None = None
        self.guess = Guess(policy.extrapolate)
        self.solver = self._make_solver(scene)

    def _make_solver(self, scene: Scene) -> LinearSolver:
        """The linear solver that outlives all frames."""
        solve, policy = scene.solve, self.policy
        return LinearSolver(
            self.comm,
            "solid_",
            policy.solver,
            solve.tolerance,
            self.calibration,
            self.stages,
            memory=solve.factor_memory,
            directions=policy.directions,
            symmetric=self.plan.solver.symmetric,
        )

    def solve(self, frame: Frame) -> LinearReport:
        """Bring the displacement `x` (n, 2) [m] up to date with a frame.

        Raises:
            ReplayProblem: the solve does not converge, or a value has no number somewhere.
            UserError: the scene's supports no longer hold the body. In both cases `mesh` and `x` stay as they were.
        """
        mesh = frame.mesh
        new_mesh, new_scene = mesh is not self.mesh, frame.scene is not self.scene
        if not (new_mesh or new_scene or mesh.topology != self.topology or mesh.geometry != self.geometry):
            self.solver.age += 1
            return LinearReport(0, False, self.solver.age, self.solver.name)
        kept = self.__dict__.copy()
        try:
            if new_mesh or new_scene:
                self._bind(frame, new_mesh)
            if not new_mesh and mesh.topology != self.topology:
                with self.stages("pattern"):
                    self._flip(frame)
            report = self._solve(frame, new_mesh)
        except (ReplayProblem, UserError):
            # Mesh, solution and observer stay those of the last solution; without a scene the next frame binds anew.
            self.__dict__.update(kept, scene=None, failed=True)
            raise
        self.failed = False
        self.mesh, self.scene, self.topology, self.geometry = mesh, frame.scene, mesh.topology, mesh.geometry
        return report

    @property
    def unknowns(self) -> int:
        """Unknowns of the linear system, prescribed ones included."""
        return self.x.size

    def linear_solve(self, rhs: np.ndarray, tolerance: float) -> np.ndarray:
        """The s (n, 2) of K s = rhs with the stiffness K of the last solve, on the kept preconditioner.

        Args:
            rhs: (n, 2), ignored at held unknowns, where s is 0.
            tolerance: of the residual, relative to rhs.

        Raises:
            ReplayProblem: the solve does not converge.
        """
        return self._solve_aside(self.mat, rhs, tolerance, same_matrix=True)

    def accept(self, x: np.ndarray) -> None:
        """Take displacements x (n, 2) [m] for those of the mesh as it lies now, without a solve.

        Supports hold what they prescribe there, whatever x says. The next frame solves, from them.
        """
        physics = self.physics
        physics.move()
        if physics.moving:
            x = np.where(physics.mask, physics.prescribed, x)
        self.x, self.observed, self.geometry, self.accepted = x, None, -1, True
        self.guess.restart()

    def observe(self) -> dict[str, float]:
        """The scene's quantities of interest at the last solution, evaluated once a solution."""
        if self.observed is None:
            self.observed = self.observer(self.x)
        return self.observed

    def von_mises(self) -> np.ndarray:
        """Equivalent stress (ne,) [Pa] of each cell at the last solution."""
        return von_mises(self.physics.stress(self.x))

    def residual(self) -> float:
        """The true residual over the right side, or over internal forces where supports move."""
        if not self.accepted:
            return true_residual(self.mat, self.b, self.solution, self.scale)
        physics = self.physics
        scale = physics.internal_force(self.x) if physics.displaced else unbalanced(physics, physics.prescribed)
        error = unbalanced(physics, self.x)
        return error / scale if scale > 0 else error

    def estimate(self) -> float:
        """The estimated relative error of the displacement, in the energy norm: that of the mesh, recovery-based.

        Of a prediction its distance from the solution on the same mesh, by a correction with the kept preconditioner.
        """
        estimator = self.estimator_of(self.physics)
        if not self.accepted:
            return estimator.relative(self.x)
        missing = correction(self.physics, self.x, self.solver, self.operator.rows)
        return estimator.distance(self.x, self.x + missing)

    @property
    def foretold(self) -> np.ndarray | None:
        """The prediction that is shown, for `prediction_error` after the next solve; None where there is none."""
        return self.x if self.accepted else None

    def prediction_error(self, foretold: np.ndarray) -> float:
        """The distance of a prediction on this mesh from the solution, relative, in the norm of `estimate`."""
        return self.estimator_of(self.physics).distance(foretold, self.x)

    def _bind(self, frame: Frame, new_mesh: bool) -> None:
        """Set up what depends on the mesh topology or on the scene's values."""
        mesh = frame.mesh
        with self.stages("pattern"):
            self.plan = planned(frame.scene, application(frame.scene.app))
            self.physics = PlaneSolid(frame.scene, self.plan, mesh)
            self.observer = self._make_observer(frame.scene.quantities)
            if new_mesh:
                self.operator = Operator(
                    self.comm, 2, mesh.node_offsets, self.policy.backend, symmetric=self.solver.symmetric
                )
                self.operator.set_topology(self._blocks(mesh), self.physics.mask)
                self._allocate(mesh)
            else:
                self.operator.set_constraints(self.physics.mask)
            self.terms = [(0, self.physics.element, mesh.X, self.physics.prescribed, self.physics.params, 1.0)]
        if new_mesh:
            carried = None
            if self.policy.transfer and self.mesh is not None:
                with self.stages("map"):
                    carried = transfer(self.mesh, mesh, frame.reseat(self.x))
            self.x = carried if carried is not None else np.zeros((len(mesh.X), 2))
            self.guess.restart()

    def _make_observer(self, quantities: dict[str, Quantity]) -> Observer:
        """What evaluates quantities of the displacement."""
        return Observer(self.physics, quantities)

    def _flip(self, frame: Frame) -> None:
        """Follow flipped edges: with the pattern and, where such edges have nodes, with the last solutions."""
        self.operator.patch(0, frame.changed_cells)
        if frame.reseats:
            self.x = frame.reseat(self.x)
            self.guess.reseat(frame.reseat)
            self.solver.reseat(frame.reseat)

    def _blocks(self, mesh: Mesh) -> list[np.ndarray]:
        """Nodes (m, k) of what has a tangent, block by block."""
        return [mesh.cells, *(load.facets for load in self.physics.followers)]

    def _solve_aside(self, mat: PETSc.Mat, rhs: np.ndarray, tolerance: float, same_matrix: bool = False) -> np.ndarray:
        """Solve mat s = rhs beside the sequence of solves; arguments as in `linear_solve`.

        `same_matrix`: mat is that of the last solve.
        """
        rows, n = self.operator.rows, rhs.size
        right, full = rhs.ravel().copy(), np.zeros(n)
        right[self.physics.constrained] = 0.0
        size = (rows.stop - rows.start, n)
        b, s = (PETSc.Vec().createWithArray(array[rows], size=size, comm=self.comm) for array in (right, full))
        norm = b.norm()
        if norm > 0.0:
            scale = norm * tolerance / self.solver.tolerance
            self.solver.solve(
                mat, b, s, False, same_matrix=same_matrix, places=self.mesh_places, scale=scale, aside=True
            )
            whole_vector(full, rows, self.comm)
        for vector in (b, s):
            vector.destroy()
        return full.reshape(-1, 2)

    def _allocate(self, mesh: Mesh) -> None:
        """Make the vectors of a new mesh; `rhs` and `full` hold all nodes, PETSc's vectors this rank's rows of them."""
        n, rows = mesh.X.size, self.operator.rows
        self.rhs, self.full = np.zeros((len(mesh.X), 2)), np.zeros(n)
        size = (rows.stop - rows.start, n)
        self.b = PETSc.Vec().createWithArray(self.rhs.ravel()[rows], size=size, comm=self.comm)
        self.solution = PETSc.Vec().createWithArray(self.full[rows], size=size, comm=self.comm)
        self.mesh_places = mesh.X[rows.start // 2 : rows.stop // 2]

    def _solve(self, frame: Frame, new_mesh: bool) -> LinearReport:
        physics, mesh = self.physics, frame.mesh
        with self.stages("values"):
            physics.move()
            if physics.moving:
                self.terms = [(0, physics.element, mesh.X, physics.prescribed, physics.params, 1.0)]
            physics.loads(self.rhs)
            self.mat = self.operator.assemble(self.terms, self.rhs.ravel())
        # PETSc keeps a vector's norm until it is told that the array behind it has changed.
        self.b.stateIncrease()
        np.subtract(self.guess(self.x, frame.hand), physics.prescribed, out=self.full.reshape(-1, 2))
        self.full[physics.constrained] = 0.0
        self.solution.stateIncrease()
        # The solver may have met the mesh of a frame that failed, which is gone.
        report, x = self._converge(new_mesh or self.failed, patched=not new_mesh and mesh.topology != self.topology)
        self.guess.keep(x, frame.hand)
        self.x, self.observed, self.accepted = x, None, False
        return report

    def _converge(self, new_system: bool, patched: bool) -> tuple[LinearReport, np.ndarray]:
        """Solve until the residual is small against the loads, or against internal forces where supports move.

        Where they move, the right side is the force of a jump over one layer of elements, which says nothing of the
        forces in the body; and those are known only with the solution, hence the second look.
        """
        physics, rows, total = self.physics, self.operator.rows, None
        places = self.mesh_places
        while True:
            self.scale = self._force_scale(self._displacement()) if physics.displaced else None
            report = self.solver.solve(
                self.mat,
                self.b,
                self.solution,
                new_system and total is None,
                same_matrix=total is not None,
                patched=patched,
                places=places,
                scale=self.scale,
            )
            whole_vector(self.full, rows, self.comm)
            x = self._displacement()
            total = report if total is None else total.followed_by(report)
            if self.scale is None or self.scale <= SCALE_SLACK * self._force_scale(x) or not report.iterations:
                return total, x

    def _force_scale(self, x: np.ndarray) -> float:
        """Internal forces [N] at the displacement x (n, 2), but not less than what round-off lets a residual tell."""
        return max(self.physics.internal_force(x), ROUND_OFF / self.solver.tolerance * self.b.norm())

    def _displacement(self) -> np.ndarray:
        return self.full.reshape(-1, 2) + self.physics.prescribed

    # --- for comparison with a cold solve -----------------------------------------------------------------------

    def system(self) -> System:
        """The matrix and the free part of the solution as they stand, whole on every rank."""
        energy = float(self.physics.energies(self.x).sum())
        return System(whole_matrix(self.mat, self.comm), self.full.copy(), energy)

    def cold_system(self) -> System:
        """Matrix and solution of this frame with new pattern, values and factor, and no guess."""
        physics = PlaneSolid(self.scene, self.plan, self.mesh)
        operator = Operator(self.comm, 2, self.mesh.node_offsets, "coo")
        operator.set_topology([self.mesh.cells], physics.mask)
        rhs = np.zeros_like(self.mesh.X)
        physics.loads(rhs)
        mat = operator.assemble(
            [(0, physics.element, self.mesh.X, physics.prescribed, physics.params, 1.0)], rhs.ravel()
        )
        matrix = whole_matrix(mat, self.comm)
        return System(matrix, spsolve(matrix.tocsc(), whole_vector(rhs.ravel(), operator.rows, self.comm)))


def unbalanced(physics: PlaneSolid, x: np.ndarray) -> float:
    """The norm [N] of the forces that are left over at free unknowns at the displacement x (n, 2) [m]."""
    rest = physics.imbalance(x)
    rest.ravel()[physics.constrained] = 0.0
    return float(np.linalg.norm(rest))
