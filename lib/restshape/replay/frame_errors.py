"""What is known of the errors of frames, measured off their time."""

# More than 15 modules: it joins all that is known of errors, each of a module of its own.

from __future__ import annotations

from math import nan
from typing import TYPE_CHECKING

from restshape.analysis.analysis import Context
from restshape.replay.columns import ESTIMATES, distance_column
from restshape.replay.constraints import MovingLimits
from restshape.replay.error_columns import QuantityErrorColumns
from restshape.replay.estimated_frames import NOTHING, WantedErrors, estimated
from restshape.replay.linear_theory import LinearTheory
from restshape.replay.mesh_jumps import MeshJumps
from restshape.replay.singular_quantities import SingularQuantities
from restshape.replay.sudden_edits import SuddenEdits
from restshape.replay.uncertain_limits import UncertainLimits
from restshape.replay.unsolved import note_unsolved
from restshape.scene.quantity import CORE

if TYPE_CHECKING:
    from petsc4py import PETSc

    from restshape.algebra.stages import Stages
    from restshape.analysis.row_values import RowValues
    from restshape.mesh.advance import MeshUpdate
    from restshape.mesh.follower import Follower
    from restshape.replay.replay_parts import ReplayParts
    from restshape.replay.request import Request
    from restshape.shape.protocol import Session
    from restshape.shape.script_frame import ScriptFrame


class FrameErrors:
    """Estimates the errors of each frame of a replay, and of its quantities.

    Args:
        request: of the replay.
        comm: of the replay; stages: likewise.
        parts: of the replay.

    Raises:
        UserError: errors, or jumps, of quantities cannot be estimated.

    Attributes:
        measuring: residual and errors are measured beside each frame; they are not numbers where they are not.
        estimating: errors are estimated beside each frame.
        singular: quantities without a limit under refinement.
        jumps: of quantities where the mesh changes.
        limits: of quantities, of each frame.
        linear_theory: whether answers are within it.
    """

    def __init__(self, request: Request, comm: PETSc.Comm, stages: Stages, parts: ReplayParts) -> None:
        self.analysis, self.prediction = parts.analysis, parts.prediction
        self._measures_predicted = parts.prediction is None or parts.prediction.measured
        self._known: tuple[object, dict[str, float]] = (None, {})
        self._measured: tuple[object, float] = (None, nan)
        self.linear_theory, self._sudden_edits = LinearTheory(parts.analysis), SuddenEdits(parts.analysis)
        # Kept from session to session, with all that it has found of the mesh.
        self._estimator = parts.analysis.quantity_errors
        self.follow(parts.session, request)
        context = Context(comm, request.policy, request.calibration, stages)
        self.jumps = MeshJumps(request.scene, request.application, parts.analysis, context)

    def follow(self, session: Session, request: Request) -> None:
        """Goes on with another session.

        Raises:
            UserError: errors of quantities cannot be estimated.
        """
        scene, application = request.scene, request.application
        self.measuring, self.estimating = request.measured != "nothing", request.measured == "all"
        self.singular = SingularQuantities(scene, application, session)
        self.quantity_errors = QuantityErrorColumns(scene, application, self._estimator, self.singular.now)
        steady = {kind for effect in application.effects.values() if not effect.transient for kind in effect.quantities}
        timeless = steady if application.transient(scene) else set()
        exact = [name for name, one in scene.quantities.items() if one.kind in {*CORE, *timeless}]
        self.limits = MovingLimits()
        self.uncertain_limits = UncertainLimits(self.singular.now, self.analysis.row, exact)

    def note(self, moving: Follower, mesh_update: MeshUpdate) -> None:
        """Keep what a frame's mesh is to be compared with, before the frame is solved."""
        if self.estimating:
            self.jumps.note(moving, mesh_update)

    def add_to(self, row: RowValues, edit: ScriptFrame, answered: bool) -> None:
        """Put a frame's residual and errors into its row.

        Args:
            row: of the frame; edit: the frame.
            answered: it shows an answer of its own.
        """
        wanted = estimated(edit.scene.solve.estimate, edit, row) if self.estimating and answered else NOTHING
        known = self.prediction.known_estimate() if self.prediction and row["predicted"] else None
        looked_at = answered and known is None and (wanted.answer or not row["predicted"] or self._measures_predicted)
        row["residual"] = self._residual() if looked_at else nan
        note_unsolved(row, edit.scene.solve.tolerance)
        row.update(self._estimates(row, looked_at, wanted))
        if known is not None and wanted.answer:
            row["estimate"] = known
        if not (self.estimating and answered):
            return
        row.update(self._distances(edit, row, wanted))
        row.update(self.singular(edit, row))
        self.linear_theory.note(row)
        self._sudden_edits.note(edit, row)
        row.update(self.quantity_errors(row, wanted, self.analysis.state if self._estimator else None))
        # Jumps that a scene asks for are part of the answer.
        row.update(self.jumps(edit, row, wanted.solves or bool(wanted.answer and edit.scene.solve.jumps)))
        if limits := self.limits(edit.scene.quantities):
            row.update(self.uncertain_limits(row, limits, wanted))

    def _distances(self, edit: ScriptFrame, row: RowValues, wanted: WantedErrors) -> RowValues:
        """How far quantities of a predicted frame are from those of the solution; not numbers of others."""
        if self.prediction is None:
            return {}
        known = self.prediction.quantity_distances() if row["predicted"] and wanted.answer else {}
        return {distance_column(name): known.get(name, nan) for name in edit.scene.quantities}

    def _residual(self) -> float:
        """The residual of the answer, computed once a state."""
        if self._measured[0] is not self.analysis.state:
            self._measured = (self.analysis.state, self.analysis.residual_norm())
        return self._measured[1]

    def _estimates(self, row: RowValues, answered: bool, wanted: WantedErrors) -> dict[str, float]:
        """What is known of the error of the frame's answer; not numbers where nothing is estimated of it."""
        found = dict.fromkeys(ESTIMATES, nan)
        if not answered or not (wanted.answer or row["predicted"]):
            return found
        state, known = self._known
        # A frame in which nothing changes has the state, and so the errors, of the one before.
        errors = known if state is self.analysis.state else self.analysis.errors()
        self._known = (self.analysis.state, errors)
        if self.prediction and row["predicted"]:
            # It decides on the next frames, whether or not it is asked for.
            self.prediction.estimated(errors.get("estimate", nan))
        if not wanted.answer:
            return found
        found.update(errors)
        if self.prediction:
            found["prediction_error"] = self.prediction.error()
        return found
