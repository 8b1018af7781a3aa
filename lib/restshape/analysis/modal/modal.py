"""Free vibrations of a body whose shape is edited: its lowest modes, frame after frame."""

from __future__ import annotations

# More than 15 modules: here matrices, solver, mode ids, prediction and estimates of a frame meet, a module each.
from dataclasses import replace
from typing import TYPE_CHECKING, cast

import numpy as np

from restshape.algebra.eigenproblems.eigen import EigenSolver
from restshape.algebra.eigenproblems.pencil import multiplied, sample
from restshape.algebra.linear_report import LinearReport
from restshape.analysis.analysis import Comparison, Context, QuantityErrors, RowValues, State, Timeless
from restshape.analysis.frame import Frame
from restshape.analysis.modal import modal_output
from restshape.analysis.modal.hanging import HangingColumns
from restshape.analysis.modal.modal_binding import bound, followed
from restshape.analysis.modal.modal_comparison import allowed, compare_cold
from restshape.analysis.modal.modal_errors import FrequencyEstimate, residual_norm
from restshape.analysis.modal.modal_prediction import ModalPrediction
from restshape.analysis.modal.modal_state import ModalState
from restshape.analysis.modal.mode_search import ModeSearch
from restshape.analysis.modal.verified_shape import VerifiedShape
from restshape.analysis.settings import modal_settings
from restshape.analysis.solution import Solution, stacked_modes
from restshape.errors import ReplayProblem, UserError
from restshape.first_use import made

if TYPE_CHECKING:
    from restshape.fem.eigenproblem import Maker
    from restshape.fem.problem import Fields, Problem
    from restshape.fem.space import Space
    from restshape.scene.model import Scene
    from restshape.scene.plan import Plan


class ModalAnalysis(Timeless):
    """The lowest eigenfrequencies and modes of a body, frame after frame.

    Ranks share matrices, factors and search vectors; each has the modes that are found whole.

    Args:
        scene: what the user wrote.
        plan: which effects are on.
        context: what all parts of the replay share.
        make: makes the body that vibrates, of scene, plan and plane mesh.

    Attributes:
        state: the modes, and what they are of.
        solver: of the eigenproblem; verified: the shape whose eigenvalues an inertia count has checked last.

    Source: docs/theory/free-vibrations.md.
    """

    estimated_quantity = "frequencies"
    why_not = ""

    def __init__(self, scene: Scene, plan: Plan, context: Context, make: Maker) -> None:
        self.context, self.make = context, make
        policy, tolerance = context.policy, scene.solve.tolerance
        self.solver = EigenSolver(policy.solver, tolerance, context.calibration, context.stages, policy.warm)
        self.verified = VerifiedShape()
        self.state = ModalState(plan, scene)
        self._estimate, self._hanging = FrequencyEstimate(), HangingColumns()
        self._unchanged_frames = 0
        self._recalled: np.ndarray | None = None

    @property
    def predictor(self) -> ModalPrediction:
        """Predicts frames from the state."""
        return ModalPrediction(self)

    @property
    def quantity_errors(self) -> QuantityErrors:
        """Estimates errors of quantities that are frequencies."""
        return lambda names: self._estimate.of_quantities(self.state, names)

    @property
    def space(self) -> Space | None:
        """The plane mesh of the last solution; None before the first."""
        return self.state.space

    @property
    def unknowns(self) -> int:
        """Unknowns of the eigenproblem, prescribed ones included."""
        return self.state.body.boundary.mask.size

    @property
    def tolerance(self) -> float:
        """That modes meet beside those of a cold solve."""
        return allowed(self.solver.method, self.solver.tolerance)

    @property
    def frequencies(self) -> np.ndarray:
        """Frequencies (modes,) [Hz] of the modes that the scene asks for, ascending."""
        return self.state.frequencies

    def solve(self, frame: Frame) -> LinearReport:
        """Bring frequencies and modes up to date with a frame.

        Raises:
            ReplayProblem: the eigenproblem has no solution that can be found.
            UserError: the scene makes no sense for a vibrating body. In both cases the state is that of before.
        """
        before, mesh = self.state, frame.mesh
        rebind = before.interrupted or mesh is not before.space or frame.scene is not before.scene
        versions = (mesh.topology, mesh.geometry)
        if not (rebind or before.predicted or versions != (before.topology, before.geometry)):
            self._recalled = None
            return self._unchanged(frame)
        try:
            self.state = self._solve(frame, rebind)
        except (ReplayProblem, UserError):
            self.state, self._recalled = replace(before, interrupted=True), None
            # The next frame binds a body, and begins with modes on its nodes.
            self.solver.restart(None)
            raise
        if self.state.report.inertia_checked:
            self.verified.update(mesh)
        return self._report()

    @property
    def recalling(self) -> ModalAnalysis:
        """Itself, for modes that large edits have thrown off their places have lost their ids."""
        return self

    def kept_answer(self) -> np.ndarray:
        """The ids (modes,) of the modes that the scene asks for, by rank."""
        return self.state.ids.copy()

    def recall(self, kept: np.ndarray) -> None:
        """Give modes of the next frame the ids (modes,) that they had by rank."""
        self._recalled = kept

    def observe(self) -> dict[str, float]:
        """The scene's quantities of interest at the state."""
        return self.state.observer(self.state.frequencies, self.state.ids)

    def observed_on(
        self, frame: Frame, before: State[Problem] | None, solved: State[Problem], earlier: bool
    ) -> dict[str, float]:
        """The quantities of a frame on another mesh of its shape; see `Analysis.observed_on`.

        Modes have the ids of the replay's own, so that quantities which follow a mode are of the same one.
        """
        self.solve(frame)
        # Both states are those of an analysis of this kind; this mesh has the nodes of the chosen one.
        known = cast("ModalState | None", solved if earlier else before)
        modes = self.state.modes
        if known is not None and known.modes.vectors.shape[1] == modes.vectors.shape[1]:
            last = known.modes.vectors
            ids = known.modes.ids.track(last, modes.vectors, modes.mass_products, self.solver.pencil.norms(last))
            here = cast("ModalState | None", before if earlier else solved)
            if here is not None and cast("ModalState", solved).recalled:
                # Between the shapes of an undo modes lose their likeness; these have their ranks on this shape.
                ids = ids.recalled(here.ids, modes.chosen)
            self.state = replace(self.state, modes=replace(modes, ids=ids))
        return self.observe()

    def row(self) -> RowValues:
        """Columns of a frame's row that only modes have."""
        return modal_output.row(self.state, self._hanging)

    def linear_displacement(self) -> None:
        """None: the size of a mode is free."""

    def solution(self) -> Solution:
        """The frequencies [Hz], and the modes."""
        values = np.array(self.frequencies, dtype=float)
        shapes = stacked_modes(self.fields()[0], "mode_", len(values))
        return Solution(spectrum="frequencies", values=values, ids=self.state.ids, shapes=shapes)

    def fields(self) -> Fields:
        """Displacements of the middle surface in each mode, the largest 1; of the cells the size of the first one."""
        state = self.state
        return state.body.fields(state.modes.vectors[state.modes.chosen])

    def blank_fields(self, space: Space) -> Fields:
        """The same fields, all NaN, on a mesh that has not been solved on."""
        return modal_output.blank_fields(space, modal_settings(self.state.plan).modes)

    def residual_norm(self) -> float:
        """The largest |K phi - lambda M phi| / |lambda M phi| of the modes that the scene asks for, element by element.

        Not a number after a frame without a solution: the body has moved with it, its modes have not.
        """
        if self.state.interrupted:
            return float("nan")
        if self.state.predicted:
            self.state.body.follow(np.empty(0, dtype=np.int32))
        return residual_norm(self.state)

    def errors(self) -> dict[str, float]:
        """The largest estimated relative error of the frequencies that the scene asks for: that of the mesh.

        Of a prediction its distance from the solution on the same mesh.
        """
        state = self.state
        return {"estimate": self.predictor.distance() if state.predicted else float(self._estimate(state).max())}

    def compare_cold(self) -> Comparison:
        """Matrices and modes beside those of a solve with nothing kept; relative."""
        return compare_cold(self.state, self.context, self.make)

    # --- a frame ------------------------------------------------------------------------------------------------------

    def _unchanged(self, frame: Frame) -> LinearReport:
        """A frame that is the last one again: solved only where the hand rests, and nothing has been verified yet."""
        if frame.edit_ended and self.solver.unchecked:
            self.state = self._verify()
            self.verified.update(made(self.state.space))
            return self._report()
        report = self.state.report
        if report.missed_modes:
            self.state = replace(self.state, report=replace(report, missed_modes=0))
        self._unchanged_frames += 1
        return LinearReport(0, False, report.age + self._unchanged_frames, report.method)

    def _report(self) -> LinearReport:
        report, self._unchanged_frames = self.state.report, 0
        return LinearReport(report.iterations, report.refreshed, report.age, report.method)

    def _solve(self, frame: Frame, rebind: bool) -> ModalState:
        before, pencil = self.state, self.solver.pencil
        kept = rebind and frame.mesh is before.space and not before.interrupted and len(before.modes.values) > 0
        # Its matrices may be assembled again in place.
        last = sample(pencil.stiffness, pencil.mass) if kept else None
        if rebind:
            state, previous = bound(before, self.solver, frame, self.context, self.make)
        else:
            state, previous = self.state, followed(self.state, self.solver, frame, self.context.stages)
        with self.context.stages("values"):
            stiffness, mass = state.matrices.assemble()
            rigid = state.body.free_rigid_motions()
        # Other values on the same nodes: modes and factor of before serve. Which modes are lowest is counted again,
        # unless both matrices are multiples of what they were, so that all modes stay.
        revalued = last is not None and len(previous) > 0
        verify = last is not None and revalued and not multiplied(last, sample(stiffness, mass))
        if revalued and not verify:
            # The same modes twice say nothing of where the next ones lie.
            self.solver.history = self.solver.history[:1]
        verify = verify or frame.edit_ended or self.verified.due(frame.mesh)
        search = self._search(state)
        found = search(stiffness, mass, rigid, state.count, rebind and not revalued, verify)
        with self.context.stages("observe"):
            # In a frame of a drag the mass changes little.
            sizes = pencil.norms(previous) if rebind and len(previous) else np.ones(len(previous))
            ids = search.ids(found, state.modes.ids, previous, sizes)
            recalled, self._recalled = self._recalled, None
            if recalled is not None:
                ids = ids.recalled(recalled, found.chosen)
        mesh = frame.mesh
        state = replace(state, scene=frame.scene, space=mesh, topology=mesh.topology, geometry=mesh.geometry)
        state = replace(state, recalled=recalled is not None)
        return replace(state.solved_for(found, ids), interrupted=False)

    def _verify(self) -> ModalState:
        """The state whose modes have been counted, now that the hand rests, with those that were missing."""
        state, pencil, search = self.state, self.solver.pencil, self._search(self.state)
        before, rigid = state.modes.vectors, state.body.free_rigid_motions()
        found = search(pencil.stiffness, pencil.mass, rigid, state.count, False, True)
        # The same modes twice say nothing of where the next ones lie.
        self.solver.history = self.solver.history[:1]
        with self.context.stages("observe"):
            ids = search.ids(found, state.modes.ids, before, np.ones(len(before)))
        return state.solved_for(found, ids)

    def _search(self, state: ModalState) -> ModeSearch:
        settings = modal_settings(state.plan)
        return ModeSearch(self.solver, state.body, settings.modes, settings.in_plane)
