"""The frame loop: edit, shape, mesh, operators, solve, observe, record."""

# More than 15 modules: session, mesh, analysis, prediction and recorder, which know nothing of each other, meet here.
import logging
from collections.abc import Iterator
from time import perf_counter
from typing import Self, cast

import numpy as np
from petsc4py import PETSc

from restshape.algebra.gathering import clean_up
from restshape.algebra.linear_report import LinearReport
from restshape.algebra.stages import NAMES, Stages
from restshape.analysis.analysis import Analysis, Context, RowValues
from restshape.analysis.frame import Frame
from restshape.analysis.row_values import findings_in, text, whole
from restshape.application import Application
from restshape.calibration import Calibration
from restshape.errors import ReplayProblem, UserError
from restshape.fem.observer import areas
from restshape.fem.problem import Problem
from restshape.fem.space import Space
from restshape.findings import encode_findings
from restshape.mesh.advance import MeshUpdate
from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.mesh.mesh import Mesh
from restshape.mesh.moving import MovingMesh
from restshape.outputs.si_numbers import counted
from restshape.policy import Policy
from restshape.replay.columns import ESTIMATES
from restshape.replay.constraints import (
    constraint_status,
    formatted_constraint,
    joined,
    limits_of,
    violated_constraints,
)
from restshape.replay.error_columns import QuantityErrorColumns, singular_quantities
from restshape.replay.mesh_jumps import MeshJumps
from restshape.replay.predicted_frames import PredictedFrames
from restshape.replay.recorder import Recorder
from restshape.replay.request import Request
from restshape.replay.rows import without_values
from restshape.replay.sessions import Follower
from restshape.replay.uncertain_limits import UncertainLimits
from restshape.scene.edit_script import Script
from restshape.scene.model import Scene
from restshape.scene.plan import plan
from restshape.shape.protocol import Session
from restshape.shape.session import EditFrame

log = logging.getLogger("restshape.replay")

STAGE_COLUMNS = tuple((name, f"ms_{name}") for name in NAMES)
NATIVE = ("relocate", "map", "flip", "mesh", "pattern", "values", "factor", "krylov", "observe")


# More than 15 attributes: what is known of the last frame stands beside the parts of the loop.
class Replay:
    """Replays an edit script against a scene.

    Args:
        scene: what the user wrote.
        script: its edits.
        application: of the scene.
        policy: what is reused from frame to frame.
        comm: PETSc communicator; all ranks run the same edits on the same mesh and share the algebra.
        calibration: seconds a unit of counted work; no clock decides anything.
        recorder: takes each frame, on rank 0; None records nothing.
        predict: "none" solves each frame, "linear" predicts those of a drag by the design derivative.

    Attributes:
        estimating: errors are estimated beside each frame.
        singular: quantities without a limit under refinement on the first shape, with the exponent of displacements.

    Raises:
        UserError: no valid first shape, or what is to be predicted cannot be.
    """

    def __init__(
        self,
        scene: Scene,
        script: Script,
        application: Application,
        policy: Policy,
        comm: PETSc.Comm,
        calibration: Calibration,
        recorder: Recorder | None = None,
        predict: str = "none",
    ) -> None:
        self.policy, self.comm, self.recorder = policy, comm, recorder
        self.stages = Stages()
        self.session, self.moving = cast(
            tuple[Session, Follower], application.editing.start(scene, script, application, policy, comm)
        )
        context = Context(comm, policy, calibration, self.stages)
        found = application.make_analysis()(scene, plan(scene, application), context)
        self.analysis = cast(Analysis[Problem], found)
        ahead = predict == "linear"
        if ahead and script.header.analysis != "every frame":
            raise UserError("frames that are not analysed cannot be predicted", "--predict", "--predict none")
        self.prediction = (
            PredictedFrames(self.analysis, cast(MovingMesh, self.moving), self.session, policy) if ahead else None
        )
        self.recorded_topology: tuple[int, int] | None = None
        self.solved = False
        self.known = False
        self.expected: np.ndarray | None = None
        self.estimating = True
        self.limits = limits_of(scene.quantities)
        self.singular = singular_quantities(scene, application, self.session)
        self.quantity_errors = QuantityErrorColumns(scene, application, self.analysis, self.singular)
        self.jumps = MeshJumps(scene, application, self.analysis, context)
        self.uncertain_limits = UncertainLimits(self.limits, self.singular)
        self.row: RowValues = {}

    @classmethod
    def of(cls, request: Request, comm: PETSc.Comm, recorder: Recorder | None = None) -> Self:
        """The replay that is asked for; PETSc's options are the caller's to set."""
        scene, script, application = request.scene, request.script, request.application
        return cls(scene, script, application, request.policy, comm, request.calibration, recorder, request.predict)

    def follow(self, session: Session, scene: Scene, application: Application) -> None:
        """Goes on with another session, whose first frame says what changes from the last one of this session.

        Raises:
            UserError: errors of quantities cannot be estimated.
        """
        self.session = session
        self.limits = limits_of(scene.quantities)
        self.singular = singular_quantities(scene, application, session)
        self.quantity_errors = QuantityErrorColumns(scene, application, self.analysis, self.singular)
        self.uncertain_limits = UncertainLimits(self.limits, self.singular)

    def frames(self) -> Iterator[RowValues]:
        """The row of each frame, as soon as it is computed and handed to the recorder.

        Raises:
            UserError: the scene cannot be simulated, or the recording cannot be written.
        """
        edits = cast(Iterator[EditFrame], self.session.frames())
        while True:
            self.stages.reset()
            start = perf_counter()
            edit = next(edits, None)
            if edit is None:
                return
            edited = perf_counter()
            row = self._frame(edit)
            end = perf_counter()
            self._times(row, start, edited, end)
            self._record(edit, row, end)
            yield row

    def _frame(self, edit: EditFrame) -> RowValues:
        """Compute one frame; one with a problem is recorded as refused, and all goes on from the last solution."""
        refused, predicted = edit.refused or "", False
        solved, self.solved = self.solved, False
        self.expected = None
        try:
            mesh_update = self.moving.update(edit)
            self.jumps.note(cast(MovingMesh, self.moving), mesh_update)
            predicted = self.prediction is not None and self.prediction.show(edit, mesh_update)
            if not edit.analysed:
                report, self.known = self._no_report(), self.known and edit.change == "none"
            elif predicted or edit.refused:
                report = self._no_report()
                # The system of the last solve is as it was.
                self.solved = solved
                predicted = predicted or bool(self.prediction and self.prediction.active)
            else:
                report = self._solve(edit, mesh_update, solved)
        except (ReplayProblem, UserError) as problem:
            if edit.index == 0 and isinstance(problem, UserError):
                raise edit.scene.located(problem) from None
            if edit.index == 0:
                raise UserError(
                    str(problem), str(edit.scene.path), "mend the scene: its first shape has no solution"
                ) from problem
            refused = problem.one_line if isinstance(problem, UserError) else str(problem)
            log.info("%4d Frame refused: %s", edit.index, refused)
            self.moving.rollback()
            if self.prediction:
                self.prediction.rollback()
                predicted = self.prediction.active
            if edit.change != "none":
                self.session.rollback()
            mesh_update, report = MeshUpdate.nothing(), self._no_report()
        with self.stages("observe"):
            quantities = self._observed(edit.scene, bool(refused))
        for stage, seconds in mesh_update.stages.items():
            self.stages.seconds[stage] += seconds
        self.row = self._row(edit, mesh_update, report, quantities) | {
            "predicted": int(predicted),
            "refused": refused,
            "stale": int(bool(refused)),
        }
        if self.known:
            own = self.analysis.row()
            self.row.update(joined(self.row, without_values(own) if refused else own))
        self.row["findings"] = encode_findings(findings_in(self.row))
        level = logging.INFO if report.refreshed or mesh_update.level > 1 else logging.DEBUG
        if log.isEnabledFor(level):
            steps = (counted(report.newton, "Newton step"), counted(report.iterations, "Krylov iteration"))
            done = "predicted" if predicted else ", ".join(steps)
            rebuilt = f"; PC {report.preconditioner} rebuilt" if report.refreshed else ""
            log.log(level, "%4d Frame %s: mesh level %d; %s%s", edit.index, edit.do, mesh_update.level, done, rebuilt)
        return self.row

    def _observed(self, scene: Scene, refused: bool) -> dict[str, float]:
        """The quantities of a frame; no numbers in a refused one, whose last solution is of another shape."""
        if refused:
            return dict.fromkeys(scene.quantities, np.nan)
        return self.analysis.observe() if self.known else areas(self.moving.field_mesh, scene.quantities)

    def _row(
        self, edit: EditFrame, mesh_update: MeshUpdate, report: LinearReport, quantities: dict[str, float]
    ) -> RowValues:
        """What all applications report of a frame, but for times and whether it was predicted or refused."""
        violated = violated_constraints(self.limits, quantities) if quantities else ()
        return {
            "index": edit.index,
            "t": edit.t,
            "line": edit.line,
            "event": edit.do,
            "level": mesh_update.level,
            "flips": mesh_update.flips,
            "min_quality": mesh_update.min_quality,
            "pc_age": report.age,
            "pc_rebuilt": int(report.refreshed),
            "iterations": report.iterations,
            "newton": report.newton,
            "preconditioner": report.preconditioner,
            "unknowns": self.analysis.unknowns,
            "elements": len(self._space.cells if self.known else self.moving.mesh.cells),
            "note": self.prediction.note if self.prediction else "",
            "constraint_status": constraint_status(self.limits, quantities),
            "violated_constraints": "; ".join(map(formatted_constraint, violated)),
            "findings": violated,
            **{f"q_{name}": value for name, value in quantities.items()},
        }

    def _solve(self, edit: EditFrame, mesh_update: MeshUpdate, solved: bool) -> LinearReport:
        """Solve a frame; `solved` shows whether the one before was."""
        mesh: Mesh | LagrangeSpace = self.moving.field_mesh
        hand = edit.gesture, (edit.c[0], edit.c[1])
        space = self.analysis.space
        interpolations = space.interpolations if space else ()
        # Flips of a frame that failed are not known any more.
        changed = mesh_update.changed_cells if solved else np.arange(len(mesh.cells), dtype=np.int32)
        if self.prediction:
            self.prediction.start(edit)
        # On a new mesh, or one whose middle nodes have gone elsewhere, nothing is left to compare with.
        stays = mesh_update.level < 3 and mesh_update.old_mesh is None and not interpolations
        self.expected = self.prediction.predicted if self.prediction and stays else None
        report = self.analysis.solve(
            Frame(mesh, changed, mesh_update.old_mesh, edit.scene, hand, interpolations, edit.edit_ended)
        )
        self.solved = self.known = True
        self.moving.solved()
        if self.prediction:
            found = report.iterations or report.refreshed
            idle = edit.change == "none" and not (self.prediction.active or found)
            self.prediction.set_expansion_point(edit, idle)
        return report

    @property
    def _space(self) -> Space:
        """Where the answer lives; that of the frame's mesh where there is none."""
        return cast(Space, self.analysis.space if self.known else self.moving.field_mesh)

    def _no_report(self) -> LinearReport:
        """The report of a frame that is not solved."""
        return LinearReport(0, False, whole(self.row, "pc_age"), text(self.row, "preconditioner"))

    def _times(self, row: RowValues, start: float, edited: float, end: float) -> None:
        """Add the milliseconds of the frame; `ms_python` is what no compiled stage took."""
        seconds = self.stages.seconds
        row["ms"] = whole_ms = (end - start) * 1e3
        row["ms_edit"] = (edited - start) * 1e3
        for name, column in STAGE_COLUMNS:
            row[column] = seconds[name] * 1e3
        row["ms_python"] = whole_ms - sum(map(seconds.__getitem__, NATIVE)) * 1e3

    def _record(self, edit: EditFrame, row: RowValues, end: float) -> None:
        """Hand the frame to the recorder; residual and error are measured here, off the frame's time."""
        row["residual"] = self.analysis.residual_norm() if self.known and not row["refused"] else np.nan
        row["mesh_area"] = self.moving.area()
        row.update(self._estimates(row))
        if self.estimating and self.known and not row["refused"]:
            row.update(self.quantity_errors(row))
            row.update(self.jumps(edit, row))
            row.update(self.uncertain_limits(row))
        mesh = self._space
        if self.recorder:
            version = (id(mesh), mesh.topology)
            if version != self.recorded_topology:
                self.recorder.topology(mesh.cells)
                self.recorded_topology = version
            row["ms_record"] = (perf_counter() - end) * 1e3
            fields = self.analysis.fields() if self.known else self.analysis.blank_fields(mesh)
            self.recorder.frame(edit.t, mesh.X, *fields, row)
        row["ms_record"] = (perf_counter() - end) * 1e3
        if whole(row, "level") > 1 or edit.change not in ("none", "move"):
            clean_up(self.comm)

    def _estimates(self, row: RowValues) -> dict[str, float]:
        """What is known of the error of the frame's answer; not numbers where it has none of its own."""
        found = dict.fromkeys(ESTIMATES, np.nan)
        if not self.known or row["refused"] or not (self.estimating or row["predicted"]):
            return found
        errors = self.analysis.errors()
        if self.prediction and row["predicted"]:
            self.prediction.estimated(errors.get("estimate", np.nan))
        if not self.estimating:
            return found
        found.update(errors)
        if self.expected is not None and self.prediction:
            found["prediction_error"] = self.prediction.predictor.error(self.expected)
        return found
