"""Linear problems without time: one solve a frame, reusing pattern, factor and solution of the frames before."""

# More than 15 modules: here problem, operator, solver, guesses and estimates of a frame meet, a module each.
import logging
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Generic, TypeVar, cast

import numpy as np
from petsc4py import PETSc

from restshape.algebra.factors.gathering import GatheredSystem, gather_matrix, gather_vector
from restshape.algebra.linear import LinearSolver
from restshape.algebra.linear_report import LinearReport, true_residual
from restshape.algebra.operator import Operator, same_blocks
from restshape.algebra.weak_calls import weak_call
from restshape.analysis.analysis import Comparison, Context, RowValues, State, Timeless
from restshape.analysis.beside import solution_beside
from restshape.analysis.comparison import compared
from restshape.analysis.correction import KeptOperation, correction, matrix_product
from restshape.analysis.frame import Frame
from restshape.analysis.guess import Guess
from restshape.analysis.late_array import LATE
from restshape.analysis.solution import Solution, moduli_of
from restshape.analysis.static.equilibrium_search import ROUND_OFF, SCALE_SLACK
from restshape.analysis.static.linear_system import LinearSystem, auxiliary_solve
from restshape.analysis.static.part_solves import PartSolves
from restshape.analysis.static.quantity_errors import SteadyQuantityErrors
from restshape.analysis.static.steady_predictor import SteadyPredictor
from restshape.analysis.time_error import StepMatrix
from restshape.application import application_of
from restshape.errors import ReplayProblem, UserError
from restshape.fem.assembled import Assembled
from restshape.fem.error_estimate import RecoveryEstimate
from restshape.fem.observer import Observer
from restshape.fem.problem import INTERNAL, Fields, Problem, SteadyProblem
from restshape.fem.residuals import dead_loads, energy, internal_norm, residual_norm
from restshape.fem.space import Space
from restshape.first_use import made
from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.mesh.mesh import Mesh
from restshape.scene.model import Quantity, Scene
from restshape.scene.plan import Plan
from restshape.scene.plan import plan as planned

if TYPE_CHECKING:
    from restshape.analysis.static.substructure import Substructure

log = logging.getLogger("restshape.analysis")

P = TypeVar("P", bound=SteadyProblem)


@dataclass(frozen=True, eq=False)
class BoundProblem(Generic[P]):
    """What is set up for a mesh and the values of a scene.

    Args:
        mesh: of the frame: the problem's space, or what that is over.
        problem: of the scene on its space.
        system: what outlives frames on the space.
        observer: of the scene's quantities.
    """

    mesh: Mesh | LagrangeSpace
    problem: P
    system: LinearSystem
    observer: Observer


@dataclass(frozen=True, eq=False)
class SteadyState(Generic[P]):
    """A solution, and what it was found with.

    Args:
        plan: which effects are on.
        scene: whose values it is for.
        bound: None before the first frame.
        x: (n, f) unknowns; those of a part that does not move may be found when they are asked for.
        topology, geometry: versions of the space that they were found at; -1: on none.
        scale: what residuals are measured against; None: the right side.
        predicted: the unknowns are a prediction.
        interrupted: the last frame has failed: what was set up for it must be set up again.
    """

    plan: Plan
    scene: Scene
    bound: BoundProblem[P] | None = None
    x: np.ndarray = LATE
    topology: int = -1
    geometry: int = -1
    scale: float | None = None
    predicted: bool = False
    interrupted: bool = False

    @property
    def problem(self) -> P:
        """The scene's problem on its space."""
        return (self.bound or made(self.bound)).problem

    @property
    def system(self) -> LinearSystem:
        """What outlives frames on the space."""
        return (self.bound or made(self.bound)).system

    @property
    def observer(self) -> Observer:
        """Of the scene's quantities."""
        return (self.bound or made(self.bound)).observer

    @property
    def space(self) -> Space | None:
        """Where the unknowns live; None before the first frame."""
        return None if self.bound is None else self.bound.problem.space

    @property
    def mesh(self) -> Mesh | LagrangeSpace | None:
        """Of the last frame, which the space is or is over; None before the first one."""
        return None if self.bound is None else self.bound.mesh


class SteadyAnalysis(Timeless, Generic[P]):
    """The solution of a linear problem, frame after frame; an `analysis.Analysis`.

    What is stale is read from the versions of mesh topology, node places and scene; nobody notifies the analysis.

    Args:
        scene: what the user wrote.
        plan: which effects are on.
        context: what all parts of the replay share.
        make: the class of the problem, made of scene, plan and space.

    Source: docs/theory/levels-of-reuse.md and solids.md.
    """

    why_not = ""

    def __init__(self, scene: Scene, plan: Plan, context: Context, make: type[P]) -> None:
        self.context, self.make = context, make
        self.state: SteadyState[P] = SteadyState(plan, scene)
        self.guess = Guess(context.policy.extrapolate, context.policy.warm)
        self.solver = self._make_solver(scene)
        self.parts = PartSolves(context, partial(weak_call(self._make_solver), scene))
        self.estimated_quantity = f"{make.unknowns[0].name} in the energy norm"
        self._observed: tuple[SteadyState[P] | None, dict[str, float]] = (None, {})
        self._estimate: tuple[P | None, RecoveryEstimate | None] = (None, None)
        self._missing: tuple[object, np.ndarray | None] = (None, None)

    def _make_solver(self, scene: Scene) -> LinearSolver:
        """The linear solver that outlives all frames."""
        solve, context = scene.solve, self.context
        return LinearSolver(
            context.comm,
            f"{self.make.name}_",
            context.policy.solver,
            solve.tolerance,
            context.calibration,
            context.stages,
            memory=solve.factor_memory,
            directions=self._directions(),
            traits=self.make.traits(self.state.plan),
        )

    def _directions(self) -> int:
        """Increments of the solution along which guesses are improved."""
        return self.context.policy.directions

    def _starts_from_guess(self, problem: SteadyProblem, operator: Operator) -> bool:
        """Whether the first solve on a mesh makes use of a guess; a new complete factor of a linear problem does not.

        Where supports move, residuals are measured against the forces of the guess.
        """
        solver = self.solver
        return solver.takes_guess and (problem.boundary.nonzero or solver.starts_from_guess(operator.core.mat))

    @property
    def predictor(self) -> SteadyPredictor:
        """Predicts frames from the state."""
        return SteadyPredictor(self)

    @property
    def quantity_errors(self) -> SteadyQuantityErrors | None:
        """Estimates errors of quantities at the last solution; None where the problem is not linear or symmetric."""
        return SteadyQuantityErrors(self) if self.solver.traits.symmetric else None

    def solve(self, frame: Frame) -> LinearReport:
        """Bring the unknowns `x` up to date with a frame.

        Raises:
            ReplayProblem: the solve does not converge, or a value has no number somewhere.
            UserError: the scene makes no sense for the problem any more. In both cases the state is that of before.
        """
        mesh, before = frame.mesh, self.state
        new_mesh, new_scene = mesh is not before.mesh, before.interrupted or frame.scene is not before.scene
        if not (new_mesh or new_scene or mesh.topology != before.topology or mesh.geometry != before.geometry):
            # A hand that takes hold finds the rest condensed.
            self._part(frame)
            self.solver.age += 1
            return LinearReport(0, False, self.solver.age, self.solver.name)
        try:
            if new_mesh or new_scene:
                self._bind(frame, new_mesh)
            if not new_mesh and mesh.topology != before.topology:
                with self.context.stages("pattern"):
                    self._flip(frame)
            part = None if new_mesh else self._part(frame)
            return self._solve(frame, new_mesh) if part is None else self._solve_part(frame, part)
        except (ReplayProblem, UserError):
            self.state = replace(before, interrupted=True)
            raise

    def rollback(self, state: SteadyState[P]) -> None:
        """Take back a frame that was solved, but of which others could make nothing: `state` is that of before."""
        self.state = replace(state, interrupted=True)
        # What was solved for may be of a mesh that is gone.
        self.guess.restart()

    # --- what is asked of a state -------------------------------------------------------------------------------------

    @property
    def x(self) -> np.ndarray:
        """The unknowns (n, f) at the last solution."""
        return self.state.x

    @property
    def problem(self) -> P:
        """What was solved last."""
        return self.state.problem

    @property
    def space(self) -> Space | None:
        """Where the unknowns live; None before the first solution."""
        return self.state.space

    @property
    def unknowns(self) -> int:
        """Unknowns of the linear system, prescribed ones included."""
        bound = self.state.bound
        return 0 if bound is None else bound.problem.boundary.mask.size

    @property
    def tolerance(self) -> float:
        """That solutions meet, in the energy norm."""
        return self.state.scene.solve.tolerance

    def observe(self) -> dict[str, float]:
        """The scene's quantities of interest at the last solution, evaluated once a solution."""
        state = self.state
        if self._observed[0] is not state:
            part = self.parts.found if self.parts.solved is state else None
            functions = state.observer.functions
            known = state.observer(state.x) if part is None else part.observe(functions, lambda: state.x)
            self._observed = (state, known)
        return self._observed[1]

    def row(self) -> RowValues:
        """Columns of the frame's row that only this analysis has: none."""
        return {}

    def linear_displacement(self) -> np.ndarray | None:
        """The unknowns (n, f), where they are displacements [m] of linear theory; no copy."""
        return self.problem.linear_displacement(self.x)

    def solution(self) -> Solution:
        """The first of the unknowns, and what its energy is measured by."""
        problem = self.problem
        first = problem.unknowns[0]
        # Others, such as a pressure, have another unit: they are in no norm with it.
        field = self.x[:, : len(first.components)].copy()
        averaged = problem.nested is not problem
        return Solution(first.name, field, moduli=moduli_of(problem), large=not problem.linear, averaged=averaged)

    def fields(self) -> Fields:
        """What a recording shows of the last solution."""
        return self.state.problem.fields(self.state.x)

    def blank_fields(self, space: Space) -> Fields:
        """The same fields, all NaN, on a space that has not been solved on."""
        return self.make.blank_fields(space)

    def residual_norm(self) -> float:
        """The true residual over the right side, or over internal forces where supports move."""
        state = self.state
        if self.parts.solved is state and self.parts.found is not None:
            return self.parts.found.residual()
        if not state.predicted:
            system = state.system
            return true_residual(system.mat, system.b, system.solution, state.scale)
        problem, boundary = state.problem, state.problem.boundary
        scale = internal_norm(problem, state.x) if boundary.nonzero else residual_norm(problem, boundary.values)
        error = residual_norm(problem, state.x)
        return error / scale if scale > 0 else error

    def errors(self) -> dict[str, float]:
        """The estimated relative error of the unknowns, in the energy norm: that of the mesh, recovery-based.

        Of a prediction its distance from the solution on the same mesh, by a correction with the kept preconditioner.
        """
        state, estimate = self.state, self.error_estimate
        if estimate is None:
            return {}
        if not state.predicted:
            return {"estimate": estimate.relative(state.x)}
        return {"estimate": estimate.distance(state.x, state.x + made(self.missing()))}

    def missing(self) -> np.ndarray | None:
        """About what predicted unknowns (n, f) lack to be the solution, found once a prediction; None of a solution."""
        state = self.state
        if not state.predicted or self.error_estimate is None:
            return None
        if self._missing[0] is not state:
            self._missing = state, correction(state.problem, state.x, self.solver, state.system.rows)
        return self._missing[1]

    def observed_beside(self, frame: Frame, before: State[Problem] | None) -> dict[str, float] | None:
        """The quantities on another mesh with the same nodes; see `Analysis.observed_beside`."""
        state = self.state
        if state.predicted or not (state.problem.linear and self.solver.symmetric and self.solver.kept.ready):
            return None
        problem = self.make(frame.scene, state.plan, frame.mesh)
        if problem.boundary.mask.shape != state.x.shape:
            return None
        rows = state.system.rows
        product = matrix_product(made(state.system.mat), rows, self.context.comm)
        matrix = StepMatrix(product, KeptOperation(self.solver, rows), False, self.solver.kept.exact)
        x = solution_beside(problem, state.problem, state.x, matrix)
        return problem.observer(self._observed_quantities(frame.scene.quantities))(x) if np.isfinite(x).all() else None

    @property
    def error_estimate(self) -> RecoveryEstimate | None:
        """The estimate on the problem's space, kept until there is another problem; None where it has none."""
        problem, estimate = self._estimate
        if estimate is None or problem is not self.problem:
            estimate = self.problem.error_estimate()
            self._estimate = (self.problem, estimate)
        return estimate

    # --- prediction ---------------------------------------------------------------------------------------------------

    def linear_solve(self, rhs: np.ndarray, tolerance: float) -> np.ndarray:
        """The s (n, f) of K s = rhs with the matrix K of the last solve, on the kept preconditioner.

        Args:
            rhs: (n, f), ignored at prescribed unknowns, where s is 0.
            tolerance: of the residual, relative to rhs.

        Raises:
            ReplayProblem: the solve does not converge.
        """
        return self._auxiliary_solve(self.state.system.mat, rhs, tolerance, same_matrix=True)

    def set_values(self, x: np.ndarray) -> None:
        """Take unknowns x (n, f) for those of the space as it lies now, without a solve.

        Supports prescribe what they do there, whatever x says. The next frame solves, from them.
        """
        problem = self.state.problem
        problem.update()
        if problem.varies:
            x = np.where(problem.boundary.mask, problem.boundary.values, x)
        self.state = replace(self.state, x=x, geometry=-1, predicted=True)
        self.guess.restart()

    def _auxiliary_solve(
        self, mat: PETSc.Mat, rhs: np.ndarray, tolerance: float, same_matrix: bool = False
    ) -> np.ndarray:
        """Solve mat s = rhs beside the sequence of solves; arguments as in `linear_solve`."""
        system, constrained = self.state.system, self.state.problem.boundary.constrained
        return auxiliary_solve(
            self.solver, system.operator, mat, rhs, tolerance, constrained, system.places, same_matrix
        )

    # --- a frame ------------------------------------------------------------------------------------------------------

    def _bind(self, frame: Frame, new_mesh: bool) -> None:
        """Set up what depends on the mesh topology or on the scene's values."""
        mesh, context, before = frame.mesh, self.context, self.state
        with context.stages("pattern"):
            known = frame.scene is before.scene
            plan = before.plan if known else planned(frame.scene, application_of(frame.scene))
            problem = self.make(frame.scene, plan, mesh)
            problem.share(context.comm)
            observer = problem.observer(self._observed_quantities(frame.scene.quantities))
            if new_mesh:
                system = self._make_system(problem)
            else:
                system = before.system
                if problem.space is before.space and same_blocks(problem.blocks(), before.problem.blocks()):
                    system.operator.set_constraints(problem.boundary.mask)
                else:
                    # Unknowns that are numbered over the mesh are numbered by each problem's own space; conditions with
                    # facets of their own may have gone to others.
                    system.operator.set_topology(problem.blocks(), problem.boundary.mask)
        x = before.x
        if new_mesh:
            projected = None
            old = before.space if context.policy.transfer else None
            if old is not None and self._starts_from_guess(problem, system.operator):
                with context.stages("map"):
                    projected = problem.space.project(old, old.interpolate(x, frame.interpolations))
            log.info("%s", "Cold start" if projected is None else f"Unknowns interpolated to {len(projected)} nodes")
            x = projected if projected is not None else problem.start()
            self.guess.restart()
        self.state = replace(before, plan=plan, bound=BoundProblem(mesh, problem, system, observer), x=x)

    def _observed_quantities(self, quantities: dict[str, Quantity]) -> dict[str, Quantity]:
        """The quantities of the scene that the problem knows."""
        return quantities

    def _make_system(self, problem: SteadyProblem) -> LinearSystem:
        """What outlives frames on a new mesh."""
        return LinearSystem(self.context.comm, problem, self.context.policy.backend, self.solver.traits)

    def _flip(self, frame: Frame) -> None:
        """Follow flipped edges: with the pattern and, where such edges have nodes, with the last solutions."""
        state, space = self.state, self.state.problem.space
        changed = space.follow(frame.changed_cells)
        state.system.operator.patch(0, changed)
        self.parts.flip(changed, bool(frame.interpolations))
        block = state.problem.blocks()[0]
        self.solver.flip((block[1] if isinstance(block, tuple) else block)[changed])
        if frame.interpolations:

            def interpolate(field: np.ndarray) -> np.ndarray:
                return space.interpolate(field, frame.interpolations)

            self.state = replace(state, x=interpolate(state.x))
            self.guess.interpolate(interpolate)
            self.solver.interpolate(lambda row: interpolate(row.reshape(state.x.shape)).ravel())

    def _solve(self, frame: Frame, new_mesh: bool) -> LinearReport:
        state, context = self.state, self.context
        bound = state.bound or made(state.bound)
        problem, system = bound.problem, bound.system
        with context.stages("values"):
            problem.update()
            dead_loads(problem, system.right)
            internal = Assembled(problem.integrals(INTERNAL), system.operator)
            system.mat = internal.system(problem.boundary.values, system.right)
        with context.stages("krylov"):
            system.start(self.guess.terms(state.x, frame.hand), problem.boundary)
        # The solver may have met the mesh of a frame that failed, which is gone.
        patched = not new_mesh and frame.mesh.topology != state.topology
        report, x, scale = self._converge(new_mesh or state.interrupted, patched)
        self.guess.keep(x, frame.hand)
        mesh = frame.mesh
        self.state = SteadyState(state.plan, frame.scene, state.bound, x, mesh.topology, mesh.geometry, scale)
        return report

    def _part(self, frame: Frame) -> "Substructure | None":
        """What solves for the part that alone has moved; None where the whole is to be solved for."""
        if frame.part is None or self.solver.on_solve is not None:
            return None
        system = self.state.system
        found = self.parts.of(frame.part, self.state.problem, system.operator)
        if self.parts.overwritten:
            # Its values are those of the cells that stay.
            system.late, self.parts.overwritten = self._assemble_late, False
        return found

    def _solve_part(self, frame: Frame, part: "Substructure") -> LinearReport:
        """Solve for the part that has moved alone; what else there is of the frame is found where it is asked for."""
        state, system, mesh = self.state, self.state.system, frame.mesh
        with self.context.stages("values"):
            dead_loads(state.problem, system.right)
        last = None if self.parts.solved is state else state.x
        report = part.solve(last, system.right, frame.hand, state.scale)
        system.late = self._assemble_late
        self.guess.restart()
        self.state = replace(
            state,
            scene=frame.scene,
            x=cast(np.ndarray, part.unknowns()),
            topology=mesh.topology,
            geometry=mesh.geometry,
            scale=part.scale,
            predicted=False,
            interrupted=False,
        )
        self.parts.solved = self.state
        return report

    def _assemble_late(self) -> PETSc.Mat:
        """The matrix of the whole where a part alone was solved for; right side and solution follow it."""
        state = self.state
        problem, system = state.problem, made(state.bound).system
        dead_loads(problem, system.right)
        mat = Assembled(problem.integrals(INTERNAL), system.operator).system(problem.boundary.values, system.right)
        np.subtract(state.x, problem.boundary.values, out=system.full.reshape(state.x.shape))
        system.full[problem.boundary.constrained] = 0.0
        system.b.stateIncrease()
        system.solution.stateIncrease()
        return mat

    def _converge(self, new_system: bool, patched: bool) -> tuple[LinearReport, np.ndarray, float | None]:
        """Solve until the residual is small against the loads, or against internal forces where supports move.

        Where they move, the right side is the force of a jump over one layer of elements, which says nothing of the
        forces in the body; and those are known only with the solution, hence the second look.
        """
        bound, total, stages = made(self.state.bound), None, self.context.stages
        system, boundary = bound.system, bound.problem.boundary
        places = self._rigid_places
        x: np.ndarray | None = None
        while True:
            scale = None
            if boundary.nonzero:
                with stages("values"):
                    scale = self._force_scale(system.with_prescribed(boundary) if x is None else x)
            report = self.solver.solve(
                system.mat,
                system.b,
                system.solution,
                new_system and total is None,
                same_matrix=total is not None,
                patched=patched,
                places=places,
                scale=scale,
            )
            with stages("krylov"):
                x = system.unknowns(boundary)
            total = report if total is None else total.followed_by(report)
            if scale is None:
                return total, x, scale
            with stages("values"):
                found = self._force_scale(x)
            if scale <= SCALE_SLACK * found or not report.iterations:
                return total, x, scale

    @property
    def _rigid_places(self) -> np.ndarray | None:
        """This rank's nodes, where rigid motions are what coarse grids must know."""
        return self.state.system.places if self.solver.traits.rigid_motions else None

    def _force_scale(self, x: np.ndarray) -> float:
        """Internal forces at the unknowns x (n, f), but not less than what round-off lets a residual resolve."""
        least = ROUND_OFF / self.solver.tolerance * self.state.system.b.norm()
        return max(internal_norm(self.state.problem, x), least)

    # --- for comparison with a cold solve -----------------------------------------------------------------------------

    def compare_cold(self) -> Comparison:
        """The state beside a solve with new pattern, values and factor, and no guess."""
        return compared(self.warm_system(), self.cold_system(), self.solver.traits.definite, self.least_norm)

    @property
    def least_norm(self) -> float:
        """Share of the free part's energy norm below which the norm of the whole solution is rounding."""
        return ROUND_OFF / self.solver.tolerance

    def warm_system(self) -> GatheredSystem:
        """The matrix and the free part of the solution as they stand, whole on every rank."""
        state = self.state
        matrix = gather_matrix(state.system.mat, self.context.comm)
        known = energy(state.problem, state.x) if self.solver.traits.minimises else None
        return GatheredSystem(matrix, state.system.full.copy(), known)

    def cold_system(self) -> GatheredSystem:
        """Matrix and solution of this frame with new pattern, values and factor, and no guess."""
        from scipy.sparse.linalg import spsolve

        comm, space = self.context.comm, self.problem.space
        problem = self.make(self.state.scene, self.state.plan, made(self.state.bound).mesh)
        shape = problem.boundary.mask.shape
        operator = Operator(comm, shape[1], space.node_offsets)
        operator.set_topology(problem.blocks(), problem.boundary.mask)
        right = np.zeros(shape)
        dead_loads(problem, right)
        mat = Assembled(problem.integrals(INTERNAL), operator).system(problem.boundary.values, right)
        matrix = gather_matrix(mat, comm)
        return GatheredSystem(matrix, spsolve(matrix.tocsc(), gather_vector(right.ravel(), operator.rows, comm)))

    def cold_unknowns(self) -> np.ndarray:
        """The unknowns (n, f) of such a solve on the space as it lies, whether the state is a solution or predicted."""
        values = self.problem.boundary.values
        return self.cold_system().solution.reshape(values.shape) + values
