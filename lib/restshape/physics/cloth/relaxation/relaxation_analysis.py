"""Cloth that is relaxed, frame after frame, on pattern, factors and positions that are kept."""

# More than 15 modules: the strategies of relaxation, each in a module of its own, meet here.

# More modules than most have: here all parts of a relaxation meet.

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any
from weakref import ref

import numpy as np

from restshape.algebra.linear_report import LinearReport
from restshape.algebra.solve_counts import SolveCounts
from restshape.algebra.weak_calls import weak_call
from restshape.analysis.analysis import Comparison, Context, Timeless
from restshape.analysis.frame import Frame
from restshape.analysis.solution import Solution
from restshape.errors import ReplayProblem, UserError
from restshape.fem.problem import Fields
from restshape.fem.space import Space
from restshape.first_use import made
from restshape.mesh.mesh import Mesh
from restshape.physics.cloth.cloth_fields import requested_fields
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.cloth_quantities import of_places
from restshape.physics.cloth.relaxation.binding import bind, moved_material, restored
from restshape.physics.cloth.relaxation.equilibrium import EquilibriumSolver
from restshape.physics.cloth.relaxation.relaxation_comparison import compare_cold
from restshape.physics.cloth.relaxation.relaxation_options import RelaxationOptions, Watch
from restshape.physics.cloth.relaxation.relaxation_run import relax
from restshape.physics.cloth.relaxation.row import Row
from restshape.physics.cloth.relaxation.state import RelaxationState
from restshape.physics.cloth.sensitivity.drape_derivative import DrapeDerivative, hand_derivative, number_derivatives
from restshape.physics.cloth.sensitivity.drape_prediction import DrapePrediction
from restshape.physics.cloth.sensitivity.postponed import Postponed
from restshape.physics.cloth.sensitivity.refined_prediction import RefinedPrediction
from restshape.physics.cloth.sheet.cloth_error_estimate import ClothEstimate
from restshape.scene.model import Scene
from restshape.scene.plan import Plan


class RelaxationAnalysis(Timeless):
    """The equilibrium of cloth on bodies and supports while they, or its pattern, are edited; an `analysis.Analysis`.

    The first frame, and every one that starts cold, lets the cloth fall from where the scene places it, from a soft
    membrane to a stiff one and from coarse meshes to fine ones; others go on from the last positions.

    Args:
        scene: what the user wrote.
        plan: which effects are on.
        context: what all parts of the replay share.

    Attributes:
        bound: the state that the last relaxation has started from.
        age: frames in which nothing was solved since the solver was made.
        watch: called with the solver, positions (n, 3) and residual over load at each iterate.

    Source: docs/theory/cloth.md.
    """

    estimated_quantity = "strain of the cloth in the energy norm"
    quantity_errors = None
    why_not = ""

    def __init__(self, scene: Scene, plan: Plan, context: Context) -> None:
        self.context = context
        self._state = RelaxationState(plan)
        self._postponed: Postponed | None = None
        self.bound: RelaxationState | None = None
        self.age = 0
        self.watch: Watch = lambda *_: None
        self.counts = SolveCounts()
        # Not held: it holds this analysis, and both would be left to the garbage collector.
        self._prediction: ref[DrapePrediction] | None = None
        self._row = Row(scene.bodies)
        self._origin: RelaxationState | None = None
        self._observed: tuple[RelaxationState | None, dict[str, float]] = (None, {})
        self._rows: tuple[RelaxationState | None, dict[str, Any]] = (None, {})
        self._estimate: ClothEstimate | None = None

    def solve(self, frame: Frame) -> LinearReport:
        """Bring the positions `x` (n, 3) [m] up to date with a frame.

        Raises:
            ReplayProblem: a step has no solution, or a value no number.
            UserError: the scene's cloth cannot be had. In both cases the state is that of before.
        """
        mesh, before = frame.mesh, self.entered()
        new_mesh = mesh is not before.mesh or mesh.topology != before.topology
        new_values = before.interrupted or frame.scene is not before.scene
        if not (new_mesh or new_values or mesh.geometry != before.geometry):
            self.age += 1
            return LinearReport(0, False, self.age, self._preconditioner)
        try:
            with self.context.stages("pattern"):
                options = self._options(frame.scene, new_values)
                bound, cold = bind(before, frame, new_mesh, options, self._origin)
            self.bound = bound
            found = relax(bound, cold, options)
        except (ReplayProblem, UserError):
            self.state = replace(before, interrupted=True)
            if before.problem:
                self._restore(before)
            raise
        self._origin = None
        self.age = self.age if found.problem is before.problem else 0
        found = replace(found, scene=frame.scene, interrupted=False, guessed=False)
        self.state = replace(found, topology=mesh.topology, geometry=mesh.geometry)
        report = found.report
        self.counts.matrices += report.steps + report.newton
        self.counts.iterations += report.iterations
        self.counts.factors += report.factors
        return LinearReport(report.iterations, report.factors > 0, self.age, self._preconditioner, report.newton)

    @property
    def predictor(self) -> DrapePrediction:
        """Predicts frames from the state: the same one as long as anyone holds it."""
        found = self._prediction() if self._prediction else None
        if found is None:
            found = DrapePrediction(self)
            self._prediction = ref(found)
        return found

    @property
    def refinable(self) -> RelaxationAnalysis:
        """Itself: it predicts from a coarse mesh; see `analysis.refining_predictor`."""
        return self

    def refined(self, levels: int) -> RefinedPrediction:
        """Predicts frames from a coarse mesh, of so many nested ones the first."""
        return RefinedPrediction(self, self.predictor, levels)

    @property
    def state(self) -> RelaxationState:
        """All that is known of the last equilibrium or prediction."""
        if self._postponed is not None:
            postponed, self._postponed = self._postponed, None
            self._state = postponed.state()
        return self._state

    @state.setter
    def state(self, state: RelaxationState) -> None:
        self._state, self._postponed = state, None

    @property
    def postponed(self) -> bool:
        """Whether the state of the prediction that is shown is not made yet."""
        return self._postponed is not None

    def postpone(self, shown: Postponed) -> None:
        """Show a prediction whose state is made where it is asked for."""
        self._postponed = shown

    @property
    def rest(self) -> RelaxationState:
        """The equilibrium that is shown, or that the prediction is from."""
        state = self._state if self._postponed is None else self._postponed.rest
        return state.rest or state

    @property
    def predicted(self) -> bool:
        """Whether a prediction is shown."""
        return self._postponed is not None or self._state.predicted

    def entered(self) -> RelaxationState:
        """The state that a solve begins with: of a prediction as much as lets the cloth pass nothing on its way."""
        state = self.state
        if state.rest is None:
            return state
        # Places of nodes, whatever material has come there: there the cloth passed through nothing.
        x, way = state.rest.x, state.x - state.rest.x
        return replace(state, x=x + state.problem.step_share(x, way) * way, rest=None, distance=None, guessed=True)

    def moved(self, state: RelaxationState) -> RelaxationState:
        """An equilibrium whose problem has taken in where the nodes of its mesh are now in the material.

        A hand keeps the node that it holds, also where another one has come nearer to its point.
        """
        options = self._options(made(state.scene), False)
        return moved_material(state, options.arguments(made(state.mesh), state.problem.supports.hand))

    def beside(self) -> RelaxationAnalysis:
        """Another analysis of the same scene, which starts from this state."""
        other = RelaxationAnalysis(made(self.state.scene), self.state.plan, self.context)
        other.start_from(self)
        return other

    def on(self) -> RelaxationAnalysis:
        """Another analysis of the same cloth that goes on from this state, on whatever mesh its frames have."""
        other = RelaxationAnalysis(made(self.state.scene), self.state.plan, self.context)
        other.state = self.state
        return other

    @property
    def restorable(self) -> RelaxationAnalysis:
        """Itself: its equilibria can be brought back; see `analysis.restorable`."""
        return self

    def kept_answer(self) -> RelaxationState:
        """The equilibrium, without what was set up to find it."""
        return replace(self.state, problem=None, solver=None, observer=None)

    def restore(self, kept: RelaxationState, frame: Frame) -> LinearReport:
        """Have an equilibrium again, friction included, in a frame with its mesh and scene; nothing is solved.

        Raises:
            UserError: the scene's values make no sense.
        """
        with self.context.stages("pattern"):
            self.state = restored(kept, self.state, frame, self._options(frame.scene, True))
        self.bound, self.age = self.state, 0
        return LinearReport(0, False, self.age, self._preconditioner)

    def start_from(self, other: RelaxationAnalysis) -> None:
        """Let the first frame start at the equilibrium of another analysis of the same mesh, its friction included."""
        self._origin = other.state

    @staticmethod
    def _restore(state: RelaxationState) -> None:
        """Let the problem of a state have its friction and all of its stiffness again."""
        if state.friction is not None:
            state.problem.contact.history = state.friction
        if state.layers is not None:
            state.problem.self_contact.history = state.layers
        state.problem.soften(1.0)
        if state.problem.seams:
            state.problem.pull_seams(1.0)

    def _options(self, scene: Scene, new_values: bool) -> RelaxationOptions:
        """How the cloth of a scene is relaxed."""
        known = None if new_values else self.state.plan
        return RelaxationOptions.of(self.context, scene, known, weak_call(self._note))

    def _note(self, solver: EquilibriumSolver, x: np.ndarray, residual: float) -> None:
        """Hand on an iterate to who watches now."""
        self.watch(solver, x, residual)

    @property
    def _preconditioner(self) -> str:
        return "cholesky" if self.context.policy.name != "thesis" else "ilu"

    def derivative(self, motion: np.ndarray, tolerance: float) -> DrapeDerivative:
        """Derivatives of the last equilibrium along the hand's directions; arguments as of `hand_derivative`."""
        with self.context.stages("krylov"):
            found = hand_derivative(self.state, motion, tolerance)
        self.counts.matrices += len(motion)
        self.counts.iterations += found.iterations
        return found

    def number_derivatives(self, keys: Sequence[str], tolerance: float) -> DrapeDerivative:
        """Derivatives of the last equilibrium by numbers of its scene; see the function of this name."""
        with self.context.stages("krylov"):
            return number_derivatives(self.state, keys, tolerance)

    # --- what is asked of a state -------------------------------------------------------------------------------------

    @property
    def x(self) -> np.ndarray:
        """Positions (n, 3) [m] at the last solution, and with Morley's triangles slopes of edges."""
        return self._state.x if self._postponed is None else self._postponed.x

    @property
    def problem(self) -> ClothProblem | None:
        """What was solved last."""
        return self.state.problem

    @property
    def space(self) -> Mesh | None:
        """The mesh whose nodes are shown; None before the first solution."""
        return self.rest.mesh

    @property
    def unknowns(self) -> int:
        """Unknowns of the equations, prescribed ones included."""
        return self.x.size

    @property
    def tolerance(self) -> float:
        """Residual over load at an equilibrium."""
        return self.state.plan.settings("drape").tolerance

    def observe(self) -> dict[str, float]:
        """The scene's quantities of interest, evaluated once a solution."""
        if self._postponed is not None and of_places(made(self.rest.scene).quantities):
            return self.rest.observer(self.x)
        if self._observed[0] is not self.state:
            self._observed = (self.state, self.state.observer(self.state.x))
        return self._observed[1]

    def row(self) -> dict[str, Any]:
        """Columns of the frame's row that only this analysis has, made once a solution.

        Of a prediction that nothing has asked more of, `max_strain` is not a number.
        """
        if self._postponed is not None:
            return self._row.postponed(self.rest)
        if self._rows[0] is not self.state:
            self._rows = (self.state, self._row(self.state))
        return dict(self._rows[1])

    def residual_norm(self) -> float:
        """The residual over the weight; norms at free unknowns."""
        return self.state.solver.residual_norm(self.state.x)

    def errors(self) -> dict[str, float]:
        """The estimated relative error of tensions and moments in the energy norm.

        Of a prediction the distance of its nodes from the drape, over their distance from their middle.
        """
        if self.state.predicted:
            return {"estimate": (self.state.distance or self.predictor.distance)()}
        state = self.state
        return {"estimate": state.lasting(state.x, "estimate", lambda: self.error_estimate.relative(state.x))}

    @property
    def error_estimate(self) -> ClothEstimate:
        """The estimate of the present problem, kept until there is another one."""
        if self._estimate is None or self._estimate.problem is not self.state.problem:
            self._estimate = self.state.problem.error_estimate()
        self._estimate.update()
        return self._estimate

    def linear_displacement(self) -> None:
        """None: strains are Green's."""

    def solution(self) -> Solution:
        """Displacements from the flat pattern, and strains and curvatures with their stiffness."""
        cells, fabric = len(self.state.problem.mesh.cells), self.problem.fabric
        parts = (fabric.membrane, fabric.bending)
        return Solution(
            name="displacement",
            field=self.fields()[0]["displacement"].copy(),
            large=True,
            curvature=self.error_estimate.curvatures(self.x),
            sheet=np.stack([np.broadcast_to(part, (cells, 3, 3)) for part in parts], axis=1),
        )

    def fields(self) -> Fields:
        """Displacement [m] of the nodes from the flat pattern, larger principal tension [N/m] of the cells."""
        state = self.state
        points, cells = state.problem.fields(state.x)
        return points, cells | requested_fields(state.problem, state.x, made(state.scene).recording.fields)

    def blank_fields(self, space: Space) -> Fields:
        """The same fields, all NaN, on a mesh that has not been solved on."""
        return ClothProblem.blank_fields(space)

    def compare_cold(self) -> Comparison:
        """The state beside a solve with a new problem, pattern, values and factor, and no guess."""
        options = self._options(self.state.scene, False)
        return compare_cold(self.state, options.make_solver)
