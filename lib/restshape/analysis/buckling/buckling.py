"""Static solids under a load, and the multiples of it at which they buckle, frame after frame."""

from __future__ import annotations

# More than 15 modules: here equilibrium, eigenproblem, prediction and estimates of a frame meet, a module each.
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from restshape.algebra.eigenproblems.buckling_solver import BucklingSolver
from restshape.algebra.linear_report import LinearReport
from restshape.analysis.analysis import Comparison, Context, QuantityErrors, RowValues, Timeless
from restshape.analysis.buckling.buckling_binding import bound, flipped
from restshape.analysis.buckling.buckling_comparison import compare_cold
from restshape.analysis.buckling.buckling_output import fields, observer, residual_norm, row
from restshape.analysis.buckling.buckling_prediction import BucklingPrediction
from restshape.analysis.buckling.buckling_state import BucklingModes, BucklingState, most_load_factor
from restshape.analysis.frame import Frame
from restshape.analysis.modal.mode_tracking import ModeIds, normalise_signs
from restshape.analysis.modal.verified_shape import VerifiedShape
from restshape.analysis.settings import buckling_settings
from restshape.analysis.solution import Solution, stacked_modes
from restshape.analysis.static.steady import SteadyAnalysis
from restshape.errors import ReplayProblem, UserError
from restshape.first_use import made

if TYPE_CHECKING:
    from petsc4py import PETSc

    from restshape.algebra.eigenproblems.davidson import Found
    from restshape.fem.problem import Fields, PrestressedProblem
    from restshape.fem.space import Space
    from restshape.scene.model import Scene
    from restshape.scene.plan import Plan

TIGHTER = 0.1
"""The prebuckling displacement is solved for with this share of the tolerance: bending of slender bodies, on which load
factors depend, hardly shows in a residual."""


class BucklingAnalysis(Timeless):
    """The equilibrium of a linear solid, and its lowest critical load factors: K phi = -mu G phi, mu > 0.

    G is the geometric stiffness of the prebuckling stress, which grows in proportion to the load. Factors at which the
    mean strain would reach 1 are none. Ranks share matrices, factors and search vectors; each has the modes whole.

    Args:
        scene: what the user wrote.
        plan: which effects are on.
        context: what all parts of the replay share.
        make: the class of the problem: linear, with a geometric stiffness.

    Attributes:
        prebuckling: finds the equilibrium.
        state: the load factors of its state.
        solver: of the eigenproblem; verified: the shape whose load factors an inertia count has checked last.
        modes_shown: load factors in the recording, which has the columns that it began with.

    Source: docs/theory/buckling.md.
    """

    estimated_quantity = "load factors"
    why_not = ""

    def __init__(self, scene: Scene, plan: Plan, context: Context, make: type[PrestressedProblem]) -> None:
        self.context = context
        self.prebuckling = SteadyAnalysis(_more_exact(scene), plan, context, make)
        policy, tolerance = context.policy, scene.solve.tolerance
        kept = policy.solver in ("auto", "stale")
        self.solver = BucklingSolver(policy.warm, kept, tolerance, context.calibration, context.stages)
        self.verified = VerifiedShape()
        self.state = BucklingState(self.prebuckling.state)
        self.modes_shown = buckling_settings(plan).modes

    @property
    def predictor(self) -> BucklingPrediction:
        """Predicts frames from the state."""
        return BucklingPrediction(self)

    @property
    def quantity_errors(self) -> QuantityErrors:
        """Estimates errors of load factors, and of quantities of the equilibrium."""
        return self._quantity_errors

    @property
    def space(self) -> Space | None:
        """The mesh of the last solution; None before the first."""
        return self.prebuckling.space

    @property
    def unknowns(self) -> int:
        """Unknowns of the displacement, prescribed ones included."""
        return self.prebuckling.unknowns

    @property
    def tolerance(self) -> float:
        """That displacements and load factors meet beside those of a cold solve."""
        return self.prebuckling.tolerance

    @property
    def load_factors(self) -> np.ndarray:
        """Load factors (k,), ascending, as many as there are up to those that the scene asks for."""
        return self.state.modes.load_factors

    def solve(self, frame: Frame) -> LinearReport:
        """Bring displacement and load factors up to date with a frame.

        Raises:
            ReplayProblem: there is no equilibrium, or the eigenproblem has no solution that can be found.
            UserError: the scene makes no sense for buckling. In both cases the state is that of before.
        """
        before = self.state
        try:
            report = self.prebuckling.solve(frame)
            if self.prebuckling.state is not before.prebuckling:
                report = self._solve(frame, report)
            if not report.iterations and self.state.report.missed_modes:
                self.state = replace(self.state, report=replace(self.state.report, missed_modes=0))
            if frame.edit_ended and self.solver.unchecked:
                report = self._verify(report)
        except (ReplayProblem, UserError):
            self.prebuckling.rollback(before.prebuckling)
            self.state = replace(before, interrupted=True)
            raise
        return report

    def observe(self) -> dict[str, float]:
        """The scene's quantities of interest at the state; a load factor that there is not is infinite."""
        return self.prebuckling.observe() | observer(self.state.prebuckling.scene.quantities)(self.state)

    def row(self) -> RowValues:
        """Columns of a frame's row that only buckling has."""
        return row(self.state, self.modes_shown, self.solver)

    def linear_displacement(self) -> np.ndarray | None:
        """The prebuckling displacement (n, 2) [m], where that is of linear theory."""
        return self.prebuckling.linear_displacement()

    def solution(self) -> Solution:
        """The prebuckling displacement, the load factors and their modes."""
        values = np.array(self.load_factors, dtype=float)
        shapes = stacked_modes(self.fields()[0], "buckling_mode_", len(values))
        return replace(self.prebuckling.solution(), spectrum="load_factors", values=values, shapes=shapes)

    def fields(self) -> Fields:
        """Displacement and equivalent stress, and the modes, the largest displacement of each 1."""
        points, cells = self.prebuckling.fields()
        return points | fields(self.state, self.modes_shown), cells

    def blank_fields(self, space: Space) -> Fields:
        """The same fields, all NaN, on a mesh that has not been solved on."""
        points, cells = self.prebuckling.blank_fields(space)
        blank = {f"buckling_mode_{k}": np.full((len(space.X), 2), np.nan) for k in range(1, self.modes_shown + 1)}
        return points | blank, cells

    def residual_norm(self) -> float:
        """The true residual at equilibrium or, where larger, |K phi + mu G phi| / |K phi| of a mode, element by
        element."""
        worst = self.prebuckling.residual_norm()
        return worst if self.state.predicted else max(worst, residual_norm(self.state))

    def errors(self) -> dict[str, float]:
        """The largest estimated relative error of the load factors: that of the mesh in their modes, recovery-based.

        What the mesh does to the prebuckling stress is not in it. Of a prediction its distance from the solution on the
        same mesh.
        """
        state = self.state
        if not len(state.modes.load_factors):
            return {"estimate": float("nan")}
        if state.predicted:
            return {"estimate": self.predictor.distance()}
        return {"estimate": max(map(self._mode_error, state.modes.vectors))}

    def _mode_error(self, mode: np.ndarray) -> float:
        """The estimated relative error of the load factor of a mode (2 n,)."""
        return made(self.prebuckling.error_estimate).relative(mode.reshape(self.state.prebuckling.x.shape)) ** 2

    def _quantity_errors(self, names: Sequence[str]) -> dict[str, float]:
        """The estimated error of each quantity; not a number where there is no such load factor, and of predictions."""
        state, quantities = self.state, self.state.prebuckling.scene.quantities
        asked = {name: quantities[name].number("load_factor") for name in names}
        ranks = {name: rank for name, rank in asked.items() if rank is not None}
        found = made(self.prebuckling.quantity_errors)([name for name in names if name not in ranks])
        for name, rank in ranks.items():
            known = not state.predicted and rank <= len(state.modes.vectors)
            error = self._mode_error(state.modes.vectors[rank - 1]) if known else np.nan
            found[name] = error * state.load_factor(rank)
        return found

    def compare_cold(self) -> Comparison:
        """Matrices, displacement and load factors beside those of a solve with nothing kept."""
        known = self.prebuckling
        return compare_cold(self.state, known.warm_system(), known.cold_system(), known.least_norm)

    # --- a frame ------------------------------------------------------------------------------------------------------

    def _solve(self, frame: Frame, report: LinearReport) -> LinearReport:
        """Solve for the load factors of the new equilibrium, whose solve is reported."""
        before, prebuckling, stages = self.state, self.prebuckling.state, self.context.stages
        new_mesh = prebuckling.space is not before.prebuckling.space
        new_system = new_mesh or before.interrupted or prebuckling.scene is not before.prebuckling.scene
        state = bound(before, prebuckling, self.solver, frame, self.context) if new_system else before
        if not new_mesh and prebuckling.topology != before.prebuckling.topology:
            state = flipped(state, self.solver, frame, self.context)
        state = replace(state, prebuckling=prebuckling)
        with stages("values"):
            stiffness, geometric = made(state.matrices).assemble(prebuckling, state.sign)
        state = replace(state, most=most_load_factor(prebuckling))
        verify = frame.edit_ended or self.verified.due(frame.mesh)
        self.state = self._find(state, stiffness, geometric, new_system, verify)
        return self._report(report)

    def _verify(self, report: LinearReport) -> LinearReport:
        """Count the load factors of the last solution, now that the hand rests, and find those that are missing."""
        pencil = self.solver.pencil
        self.state = self._find(self.state, pencil.mass, pencil.stiffness, False, True)
        # The same modes twice say nothing of where the next ones lie.
        self.solver.history = self.solver.history[:1]
        self.verified.update(self.state.prebuckling.problem.space)
        return self._report(report)

    def _find(
        self, state: BucklingState, stiffness: PETSc.Mat, geometric: PETSc.Mat, new_system: bool, verify: bool
    ) -> BucklingState:
        """The state with load factors that have been solved for; modes get the ids of those before."""
        constrained, count = (
            state.prebuckling.problem.boundary.constrained,
            buckling_settings(state.prebuckling.plan).modes,
        )
        found, report = self.solver.solve(stiffness, geometric, constrained, count, state.most, new_system, verify)
        with self.context.stages("observe"):
            modes = self._with_ids(state, found)
        if report.inertia_checked:
            self.verified.update(state.prebuckling.problem.space)
        return replace(state, modes=modes, predicted=False, report=report, interrupted=False)

    def _with_ids(self, state: BucklingState, found: Found) -> BucklingModes:
        """The modes with ids as those before that they look like; those of the first frame in their order."""
        own, pencil, before, ids = found.modes, self.solver.pencil, state.modes.vectors, state.modes.ids
        mass_products = np.empty_like(own)
        pencil.apply(pencil.mass, own, mass_products)
        vectors, mass_products = pencil.share.whole(own.copy()), pencil.share.whole(mass_products)
        if len(before) and len(vectors):
            ids = ids.track(before, vectors, mass_products, pencil.norms(before))
        elif len(vectors):
            normalise_signs(vectors, mass_products)
            ids = ModeIds.first(len(vectors), np.arange(len(vectors)))
        return BucklingModes(-1.0 / found.values, vectors, mass_products, ids)

    def _report(self, prebuckling: LinearReport) -> LinearReport:
        """The report of a prebuckling solve and of what was found for it."""
        report = self.state.report
        iterations, refreshed = prebuckling.iterations + report.iterations, prebuckling.refreshed or report.refreshed
        return LinearReport(iterations, refreshed, prebuckling.age, prebuckling.preconditioner)


def _more_exact(scene: Scene) -> Scene:
    """The scene with the tolerance that the equilibrium is solved with."""
    solve = scene.solve.model_copy(update={"tolerance": TIGHTER * scene.solve.tolerance})
    return scene.model_copy(update={"solve": solve})
