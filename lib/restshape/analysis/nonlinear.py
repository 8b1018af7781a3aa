"""Solids of large deformation at rest: Newton's method on kept patterns and factors, in steps of load where it must."""

from dataclasses import replace

import numpy as np
from petsc4py import PETSc

from restshape.algebra.gather import System, whole_matrix
from restshape.algebra.linear import COMPLETE, LinearSolver
from restshape.algebra.linear_report import LinearReport
from restshape.algebra.newton import Newton
from restshape.algebra.newton_convergence import INDEFINITE, Outcome
from restshape.algebra.stages import Stages
from restshape.analysis.buckling import BucklingAnalysis
from restshape.analysis.equilibrium import Equilibrium
from restshape.analysis.frame import Frame
from restshape.analysis.guess import CurvedGuess
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
from restshape.analysis.load_stepping import LoadPath, step_load
from restshape.analysis.steady import SCALE_SLACK, StaticAnalysis
from restshape.calibration import Calibration
from restshape.errors import ReplayProblem, UserError
from restshape.mesh.mesh import Mesh
from restshape.policy import Policy, policy
from restshape.scene.model import Scene
from restshape.scene.plan import Plan

ROUGH = 1e-3
"""Tolerance of the states between steps of load."""
NEAR = 2
"""Newton's steps from a guess so near that the equilibrium is believed to be stable as the one before."""
MOST_BELIEVED = 10
"""Of as many frames of a drag one at least shows by a factor of its tangent that the equilibrium is stable."""


def static_analysis(
    scene: Scene, plan: Plan, comm: PETSc.Comm, policy: Policy, calibration: Calibration, stages: Stages
) -> StaticAnalysis:
    """The analysis of a solid at rest that its plan calls for; arguments as in `StaticAnalysis`."""
    made = StaticAnalysis
    if plan.solver.equations == "nonlinear":
        made = NonlinearStatic
    elif plan.on("buckling"):
        made = BucklingAnalysis
    return made(scene, plan, comm, policy, calibration, stages)


class NonlinearStatic(StaticAnalysis):
    """The equilibrium of a solid of large deformation, frame after frame.

    Newton's method starts at the guess along the drag. Where that fails, the force that the last state lacks on the new
    shape is put on as a load that keeps it, and taken away in steps; then the same from the rest shape, where these
    steps are those of the load. An equilibrium counts if no cell is inverted and, unless the guess was near, if the
    tangent is positive definite.

    Arguments as in `StaticAnalysis`.

    Source: docs/theory.md, section 2.
    """

    def __init__(
        self, scene: Scene, plan: Plan, comm: PETSc.Comm, policy: Policy, calibration: Calibration, stages: Stages
    ) -> None:
        super().__init__(scene, plan, comm, policy, calibration, stages)
        self.guess = CurvedGuess(policy.extrapolate)
        self.newton: Newton | None = None
        self.equations: Equilibrium | None = None
        self.made: list[Newton] = []
        self.frames = 0
        # Frames since the tangent of an equilibrium, or of a guess at one, was last factored.
        self.believed, self.tested = 0, False
        self.left_over = 0.0

    def solve(self, frame: Frame) -> LinearReport:
        """Bring the displacement `x` (n, 2) [m] up to date with a frame.

        Raises:
            ReplayProblem: no equilibrium is found, or a value has no number somewhere.
            UserError: the scene's supports no longer hold the body. In both cases `mesh` and `x` stay as they were.
        """
        try:
            report = super().solve(frame)
        except (ReplayProblem, UserError):
            # The tangent that is assembled is that of the frame that failed.
            if self.newton:
                self.newton.take(self.equations)
            raise
        finally:
            free(self.made, self.newton)
        return self._settled(report) if frame.settled and self.believed else report

    def linear_solve(self, rhs: np.ndarray, tolerance: float) -> np.ndarray:
        """The s (n, 2) of K s = rhs with the tangent stiffness K of the present state, on the kept preconditioner.

        Arguments as in `StaticAnalysis.linear_solve`. K is not symmetric where pressures follow the boundary.
        """
        return self._solve_aside(self._tangent(), rhs, tolerance)

    def accept(self, x: np.ndarray) -> None:
        """Take displacements x (n, 2) [m] for those of the mesh as it lies now, without a solve."""
        super().accept(x)
        self.equations.begin()
        self.left_over = 0.0

    def row(self) -> dict[str, str]:
        """What the frame's row tells besides."""
        return rounding_note(self.left_over, self.solver.tolerance)

    def residual(self) -> float:
        """The forces out of balance over the load, or over internal forces where supports move; norms at free nodes."""
        # Newton's last one was of this very displacement, unless it was predicted.
        if not self.accepted:
            return self.left_over
        norm = float(np.linalg.norm(self.equations.whole_residual(self.x)))
        return norm / self.scale if self.scale else norm

    # --- a frame --------------------------------------------------------------------------------------------------

    def _make_solver(self, scene: Scene) -> LinearSolver:
        return tangent_solver(self, "solid_", scene)

    def _allocate(self, mesh: Mesh) -> None:
        """Make what solves for the unknowns of a new mesh."""
        rows = self.operator.rows
        self.newton = Newton(self.comm, "solid_newton_", self.solver, mesh.X.shape, rows)
        self.made.append(self.newton)
        self.mesh_places = mesh.X[rows.start // 2 : rows.stop // 2]

    def _solve(self, frame: Frame, new_mesh: bool) -> LinearReport:
        mesh, physics = frame.mesh, self.physics
        if self.equations is None or self.equations.physics is not physics:
            self.equations = Equilibrium(physics, self.operator, self.stages)
            self.newton.take(self.equations)
        with self.stages("values"):
            physics.move()
            self.equations.begin()
            self.load = self._load()
        # The solver may have met the mesh of a frame that failed, which is gone.
        patched = not new_mesh and mesh.topology != self.topology
        self.newton.begin(new_mesh or self.failed, patched, self.mesh_places)
        # A drag goes on from a stable equilibrium in small steps; other edits may leap over a limit.
        dragged = not (new_mesh or self.accepted) and frame.scene is self.scene
        self.tested = False
        outcome, x = self._find(self.guess(self.x, frame.hand), dragged and self.believed + 1 < MOST_BELIEVED)
        refreshed = outcome.refreshed or (self.tested and self._told)
        self.believed = 0 if self.tested else 1 if refreshed else self.believed + 1
        self.left_over = outcome.norm / (self.scale or 1.0)
        self.guess.keep(x, frame.hand)
        self.x, self.observed, self.accepted = x, None, False
        self.frames = 0 if refreshed else self.frames + 1
        return LinearReport(outcome.iterations, refreshed, self.frames, self.solver.name, outcome.newton)

    def _find(self, guess: np.ndarray, near: bool) -> tuple[Outcome, np.ndarray]:
        """The equilibrium (n, 2) near a guess, by steps of load where Newton's method does not reach it."""
        x = guess.copy()
        self._hold(x)
        outcome, problem = self._attempt(x, near=near)
        if not problem:
            return outcome, x
        starts = [self.x] if self.x.any() else []
        for start in [*starts, np.zeros_like(x)]:
            found = self._stepped(start, outcome)
            outcome = found.outcome
            if found.reached == 1.0:
                return outcome, found.x
        raise ReplayProblem(f"no equilibrium found beyond {100 * found.reached:.3g} % of the load: {found.why}")

    def _stepped(self, start: np.ndarray, before: Outcome) -> LoadPath:
        """Load steps to this frame's equilibrium from a state (n, 2) [m], after other runs of Newton's method."""
        constrained, prescribed = self.physics.constrained, self.physics.prescribed.ravel()
        equations, at_rest = self.equations, not start.any()

        def put_on(x: np.ndarray, part: float) -> None:
            held = (1.0 - part) * start.ravel() + part * prescribed
            x.ravel()[constrained] = held[constrained]
            if at_rest and equations.pressed != part:
                equations.pressed = part

        steps = self.plan.settings("large_deformation").load_steps
        try:
            equations.pressed = 0.0 if at_rest else 1.0
            return step_load(self._attempt, start, equations.whole_residual(start), put_on, before, steps)
        finally:
            equations.pressed = 1.0

    def _attempt(
        self, x: np.ndarray, added: np.ndarray | None = None, searched: bool = False, near: bool = False
    ) -> tuple[Outcome, str]:
        """Newton's method from x (n, 2), which is changed, under an added load: what came of it, and what is wrong.

        Near a stable equilibrium, one that takes few steps is believed to be stable.
        """
        total = None
        while True:
            self.scale = self._scale(x)
            goal = (self.solver.aim if added is None else ROUGH) * self.scale
            outcome = self.newton.solve(x, goal, self.scale, searched, added, rounding(self.physics))
            total = outcome if total is None else outcome.after(total)
            if not outcome.converged:
                return total, outcome.why
            if added is not None or self.scale <= SCALE_SLACK * self._scale(x) or not outcome.newton:
                return total, self._objection(x, near and total.monotone and total.newton <= NEAR)

    def _objection(self, x: np.ndarray, stable: bool) -> str:
        """What speaks against the equilibrium x (n, 2) that Newton's method has found."""
        problem = inversion(self.physics, self.equations.inverted_cells(x)) or vanishing(self.physics, x)
        if problem or stable:
            return problem
        self.tested = True
        return "" if self.newton.definite(x) else INDEFINITE

    def _settled(self, report: LinearReport) -> LinearReport:
        """The report of a frame at the end of a drag, whose equilibrium is stable, as it was believed to be."""
        if self.newton.definite(self.x):
            self.believed = self.frames = 0
            return replace(report, refreshed=self._told, age=0) if self._told else report
        before, self.believed = self.believed, MOST_BELIEVED
        raise ReplayProblem(f"{INDEFINITE}; so may be those of up to {before} frames before")

    @property
    def _told(self) -> bool:
        """Tell whether a test of stability makes a factor, for others cannot tell."""
        return self.solver.kind in COMPLETE

    def _hold(self, x: np.ndarray) -> None:
        """Set the held unknowns of x (n, 2)."""
        constrained = self.physics.constrained
        x.ravel()[constrained] = self.physics.prescribed.ravel()[constrained]

    def _tangent(self) -> PETSc.Mat:
        """The tangent stiffness at the last solution."""
        return self.newton.tangent(self.x)

    def _load(self) -> float:
        """The norm of the loads at free nodes [N]."""
        return float(np.linalg.norm(self.equations.load()))

    def _scale(self, x: np.ndarray) -> float:
        """What residuals are measured against [N]: the load, and internal forces where supports move."""
        if not self.physics.displaced:
            return self.load
        return max(self.load, self.physics.internal_force(x), least_scale(self.physics, x, self.solver.tolerance))

    # --- for comparison with a cold solve -----------------------------------------------------------------------

    def system(self) -> System:
        """The tangent stiffness and the solution as they stand, whole on every rank."""
        energy = float(self.physics.energies(self.x).sum())
        return System(whole_matrix(self._tangent(), self.comm), self.x.ravel().copy(), energy)

    def cold_system(self) -> System:
        """The tangent at this frame's solution on a new pattern, and the solution of a cold analysis from nothing."""
        rebuild = policy("rebuild")
        cold = NonlinearStatic(self.scene, self.plan, self.comm, rebuild, self.calibration, self.stages)
        cold.solver.tolerance *= COLD
        none = np.empty(0, dtype=np.int32)
        cold.solve(Frame(self.mesh, none, None, self.scene, (None, (0.0, 0.0))))
        solution = cold.x.ravel().copy()
        matrix = whole_matrix(cold.newton.tangent(self.x), self.comm)
        cold.newton.destroy()
        return System(matrix, solution)
