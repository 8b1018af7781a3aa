"""Nonlinear problems without time: Newton's method on kept patterns and factors, in steps of load where it must."""

# More than 15 modules: here problem, Newton's method, load steps and guesses of a frame meet, a module each.
from dataclasses import dataclass, replace
from typing import cast

import numpy as np
from petsc4py import PETSc

from restshape.algebra.factors.gathering import GatheredSystem, gather_matrix
from restshape.algebra.linear import COMPLETE, LinearSolver
from restshape.algebra.linear_report import LinearReport
from restshape.algebra.nonlinear.newton import Newton
from restshape.algebra.nonlinear.newton_convergence import INDEFINITE
from restshape.algebra.operator import Operator
from restshape.analysis.analysis import Context, RowValues
from restshape.analysis.frame import Frame
from restshape.analysis.guess import CurvedGuess
from restshape.analysis.restorable import KeptUnknowns
from restshape.analysis.static.equilibrium_search import EquilibriumSearch
from restshape.analysis.static.residual_equations import ResidualEquations
from restshape.analysis.static.steady import SteadyAnalysis, SteadyState
from restshape.errors import ReplayProblem, UserError
from restshape.fem.problem import SteadyProblem
from restshape.fem.residuals import energy
from restshape.first_use import made
from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.mesh.mesh import Mesh
from restshape.policy import policy
from restshape.scene.model import Scene
from restshape.scene.plan import Plan

MOST_BELIEVED = 10
"""Of as many frames of a drag one at least shows by a factor of its tangent that the equilibrium is stable."""
COLD = 1e-4
"""A cold solve's tolerance over the scene's."""


class NonlinearSystem:
    """Holds what lives as long as a mesh does: the operator's pattern, and Newton's method.

    Args:
        comm: PETSc communicator.
        problem: on the mesh.
        backend: of the operator.
        solver: of linear systems, which outlives meshes.
        prefix: of the options of Newton's method in PETSc's database.
    """

    def __init__(
        self, comm: PETSc.Comm, problem: SteadyProblem, backend: str | None, solver: LinearSolver, prefix: str
    ) -> None:
        mask = problem.boundary.mask
        fields = mask.shape[1]
        self.operator = Operator(
            comm, fields, problem.space.node_offsets, backend, solver.symmetric, solver.traits.definite
        )
        self.operator.set_topology(problem.blocks(), mask)
        self.rows = rows = self.operator.rows
        self.newton = Newton(comm, prefix, solver, mask.shape, rows)
        self.places = problem.space.dof_X[rows.start // fields : rows.stop // fields]


@dataclass(frozen=True, eq=False)
class NonlinearState(SteadyState[SteadyProblem]):
    """A solution of a nonlinear problem; further arguments:

    Args:
        equations: of the problem.
        residual: over its scale.
        believed: frames since the tangent of a solution, or of a guess at one, was last factored.
        age: frames since the preconditioner was made.
    """

    equations: ResidualEquations | None = None
    residual: float = 0.0
    believed: int = 0
    age: int = 0

    # All that a linear system is used for is overridden.
    @property
    def system(self) -> NonlinearSystem:  # type: ignore[override]
        """What outlives frames on the space."""
        return cast(NonlinearSystem, super().system)


class NonlinearSteadyAnalysis(SteadyAnalysis[SteadyProblem]):
    """The solution of a nonlinear problem, frame after frame, by `EquilibriumSearch`; arguments as `SteadyAnalysis`.

    Source: docs/theory/solids.md.
    """

    state: NonlinearState

    def __init__(self, scene: Scene, plan: Plan, context: Context, make: type[SteadyProblem]) -> None:
        super().__init__(scene, plan, context, make)
        self.state = NonlinearState(plan, scene)
        self.guess = CurvedGuess(context.policy.extrapolate, context.policy.warm)
        self._made: list[Newton] = []
        self._recalled: KeptUnknowns | None = None

    @property
    def quantity_errors(self) -> None:
        """None: errors of quantities are not estimated."""

    def solve(self, frame: Frame) -> LinearReport:
        """Bring the unknowns `x` up to date with a frame.

        Raises:
            ReplayProblem: no solution is found, or a value has no number somewhere.
            UserError: the scene makes no sense for the problem any more. In both cases the state is that of before.
        """
        try:
            report = super().solve(frame)
        except (ReplayProblem, UserError):
            # The tangent that is assembled is that of the frame that failed.
            if self.state.equations:
                self.state.system.newton.set_equations(self.state.equations)
            raise
        finally:
            self._recalled = None
            self._destroy_unused()
        return self._confirmed(report) if frame.edit_ended and self.state.believed else report

    def linear_solve(self, rhs: np.ndarray, tolerance: float) -> np.ndarray:
        """The s (n, f) of K s = rhs with the tangent K of the present state, on the kept preconditioner.

        Arguments as in `SteadyAnalysis.linear_solve`.
        """
        return self._auxiliary_solve(self.tangent(), rhs, tolerance)

    def set_values(self, x: np.ndarray) -> None:
        """Take unknowns x (n, f) for those of the space as it lies now, without a solve."""
        super().set_values(x)
        made(self.state.equations).begin()
        self.state = replace(self.state, residual=0.0)

    def row(self) -> RowValues:
        """What the frame's row reports besides."""
        return rounding_note(self.state.residual, self.solver.tolerance)

    def residual_norm(self) -> float:
        """The residual over the load, or over internal forces where supports move; norms at free unknowns."""
        state = self.state
        # Newton's last one was of these very unknowns, unless they were predicted.
        if not state.predicted:
            return state.residual
        norm = float(np.linalg.norm(made(state.equations).full_residual(state.x)))
        return norm / state.scale if state.scale else norm

    def tangent(self) -> PETSc.Mat:
        """The tangent at the last solution."""
        return self.state.system.newton.tangent(self.state.x)

    # --- a frame ------------------------------------------------------------------------------------------------------

    def _directions(self) -> int:
        return 0

    def _starts_from_guess(self, problem: SteadyProblem, operator: Operator) -> bool:
        return True

    def _make_system(self, problem: SteadyProblem) -> NonlinearSystem:  # type: ignore[override]
        context = self.context
        prefix = f"{self.make.name}_newton_"
        backend = context.policy.backend or (self.make.backend if context.comm.size == 1 else None)
        system = NonlinearSystem(context.comm, problem, backend, self.solver, prefix)
        self._made.append(system.newton)
        return system

    def _solve(self, frame: Frame, new_mesh: bool) -> LinearReport:
        state, stages = self.state, self.context.stages
        problem, system, equations = state.problem, state.system, state.equations
        if equations is None or equations.problem is not problem:
            equations = ResidualEquations(problem, system.operator, stages)
            system.newton.set_equations(equations)
        with stages("values"):
            problem.update()
            equations.begin()
            search = self._search(equations)
        # The solver may have met the mesh of a frame that failed, which is gone.
        patched = not new_mesh and frame.mesh.topology != state.topology
        system.newton.begin(new_mesh or state.interrupted, patched, self._rigid_places)
        # A drag goes on from a stable equilibrium in small steps; other edits may leap over a limit.
        dragged = not (new_mesh or state.predicted or state.interrupted) and frame.scene is state.scene
        guess = self._guessed(frame)
        outcome, x = search.find(guess, state.x, dragged and state.believed + 1 < MOST_BELIEVED)
        refreshed = outcome.refreshed or (search.tested and self._tests_factor)
        self.guess.keep(x, frame.hand)
        self.state = replace(
            state,
            scene=frame.scene,
            equations=equations,
            x=x,
            topology=frame.mesh.topology,
            geometry=frame.mesh.geometry,
            scale=search.scale,
            residual=outcome.norm / (search.scale or 1.0),
            believed=0 if search.tested else 1 if refreshed else state.believed + 1,
            age=0 if refreshed else state.age + 1,
            predicted=False,
            interrupted=False,
        )
        return LinearReport(outcome.iterations, refreshed, self.state.age, self.solver.name, outcome.newton)

    @property
    def recalling(self) -> "NonlinearSteadyAnalysis | None":
        """Itself, for it may have several answers: see `analysis.restorable`."""
        return self

    def kept_answer(self) -> KeptUnknowns:
        """The unknowns of the last solution."""
        return KeptUnknowns(self.state.mesh, self.state.topology, self.state.x)

    def recall(self, kept: KeptUnknowns) -> None:
        """Let the search of the next frame start from unknowns that there were, where the mesh has the same cells."""
        self._recalled = kept

    def _guessed(self, frame: Frame) -> np.ndarray:
        """Unknowns (n, f) that the search of a frame starts from."""
        known = self._recalled
        same = known is not None and known.mesh is frame.mesh and known.topology == frame.mesh.topology
        if known is not None and same and known.x.shape == self.state.x.shape:
            return known.x
        return self.guess(self.state.x, frame.hand)

    def _search(self, equations: ResidualEquations) -> EquilibriumSearch:
        steps = equations.problem.load_steps
        return EquilibriumSearch(
            equations, self.state.system.newton, lambda: self.solver.aim, self.solver.tolerance, steps
        )

    def _confirmed(self, report: LinearReport) -> LinearReport:
        """The report of a frame at the end of a drag, whose solution is stable, as it was believed to be."""
        state = self.state
        if state.system.newton.definite(state.x):
            self.state = replace(state, believed=0, age=0)
            return replace(report, refreshed=True, age=0) if self._tests_factor else report
        self.state = replace(state, believed=MOST_BELIEVED)
        raise ReplayProblem(f"{INDEFINITE}; so may be those of up to {state.believed} frames before")

    @property
    def _tests_factor(self) -> bool:
        """Whether a test of stability makes a factor: others can show nothing."""
        return self.solver.kind in COMPLETE

    def _destroy_unused(self) -> None:
        """Free all of Newton's methods but the present one.

        Matrices and factors of those that are not used any more are freed at once.
        """
        kept = self.state.system.newton if self.state.bound else None
        for newton in self._made:
            if newton is not kept:
                newton.destroy()
        self._made[:] = [kept] if kept else []

    # --- for comparison with a cold solve -----------------------------------------------------------------------------

    def warm_system(self) -> GatheredSystem:
        """The tangent and the solution as they stand, whole on every rank."""
        matrix = gather_matrix(self.tangent(), self.context.comm)
        known = energy(self.problem, self.x) if self.solver.traits.minimises else None
        return GatheredSystem(matrix, self.x.ravel().copy(), known)

    def cold_system(self) -> GatheredSystem:
        """The tangent at this frame's solution on a new pattern, and the solution of a cold analysis from nothing."""
        state, context = self.state, replace(self.context, policy=policy("rebuild"))
        cold = type(self)(state.scene, state.plan, context, self.make)
        cold.solver.tolerance *= COLD
        none = np.empty(0, dtype=np.int32)
        cold.solve(Frame(cast(Mesh | LagrangeSpace, state.space), none, None, state.scene, (None, (0.0, 0.0))))
        newton = cold.state.system.newton
        matrix = gather_matrix(newton.tangent(self.x), context.comm)
        newton.destroy()
        return GatheredSystem(matrix, cold.x.ravel().copy())

    def cold_unknowns(self) -> np.ndarray:
        """The unknowns (n, f) of such an analysis on the space as it lies."""
        return self.cold_system().solution.reshape(self.x.shape)


def rounding_note(residual: float, tolerance: float) -> RowValues:
    """What a frame's row reports besides where rounding leaves more of the load, or of the forces, than the
    tolerance."""
    return {"note": f"a tolerance of {tolerance:g} is out of reach of rounding"} if residual > tolerance else {}
