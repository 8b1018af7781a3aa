"""Solves the frames of a replay, or shows their predictions."""

from __future__ import annotations

from time import process_time
from typing import TYPE_CHECKING

import numpy as np

from restshape.algebra.linear_report import LinearReport
from restshape.analysis.frame import Frame
from restshape.mesh.advance import NO_CELLS
from restshape.replay.returns import Returns

if TYPE_CHECKING:
    from restshape.fem.space import Space
    from restshape.mesh.advance import MeshUpdate
    from restshape.policy import Policy
    from restshape.replay.replay_parts import ReplayParts
    from restshape.shape.script_frame import ScriptFrame


class FrameSolver:
    """Brings the analysis of a replay to each frame whose mesh has been updated.

    Args:
        parts: of the replay; policy: what is reused in it.

    Attributes:
        returns: the answers that undo and redo bring back.
        solved: the last frame was solved, or needed no solve since the last one that was.
        known: the analysis has an answer of the shape as it is.
        predicted: the last frame shows a prediction.
        idle_seconds: of the processor, that predictions have taken of the edit time before the frame.
    """

    def __init__(self, parts: ReplayParts, policy: Policy) -> None:
        _, self.moving, self.analysis, self.prediction = parts
        self.solved = self.known = self.predicted = False
        self.returns = Returns(parts, policy)
        self._last = LinearReport(0, False, 0)
        self.idle_seconds = 0.0

    @property
    def space(self) -> Space:
        """Where the answer lives; that of the frame's mesh where there is none."""
        found: Space = self.analysis.space if self.known else self.moving.field_mesh  # type: ignore[assignment]
        return found

    def __call__(self, edit: ScriptFrame, mesh_update: MeshUpdate) -> LinearReport:
        """What the solve of a frame did.

        Raises:
            ReplayProblem: it has no solution.
            UserError: the scene's new values make no sense.
        """
        solved, self.solved = self.solved, False
        prediction = self.prediction
        self.predicted = shown = prediction is not None and prediction.show(edit, mesh_update)
        if not edit.analysed:
            self.known = self.known and edit.change == "none"
            return self.no_report()
        if shown or edit.refused:
            # The system of the last solve is as it was.
            self.solved = solved
            self.predicted = shown or (prediction is not None and prediction.active)
            return self.no_report()
        self._last = report = self._solve(edit, mesh_update, solved)
        return report

    def idle(self, edit: ScriptFrame) -> None:
        """Spend the edit time before a frame on what predictions are made from."""
        if self.prediction is not None:
            begun = process_time()
            self.prediction.idle(edit, self._solve_shown)
            self.idle_seconds = process_time() - begun

    def _solve_shown(self, last: ScriptFrame) -> None:
        """Solve the last frame, which shows a prediction, on the mesh as it lies.

        Raises:
            ReplayProblem: it has no solution; its prediction is shown as before.
        """
        mesh = self.moving.field_mesh
        changed = NO_CELLS if self.solved else np.arange(len(mesh.cells), dtype=np.int32)
        self.solved = False
        hand = last.gesture, (last.c[0], last.c[1])
        self._last = self.analysis.solve(Frame(mesh, changed, None, last.scene, hand))
        self.solved = self.known = True
        self.predicted = False
        self.moving.solved()

    def returned(self, report: LinearReport) -> LinearReport:
        """The report of a frame whose answer is one that there was."""
        self.solved = self.known = True
        self.predicted, self._last = False, report
        self.moving.solved()
        if self.prediction:
            self.prediction.forget()
        return report

    def rollback(self) -> None:
        """The last frame has no solution: its mesh, and what was shown, are those before it."""
        self.solved = False
        self.moving.rollback()
        self.predicted = False
        if self.prediction:
            self.prediction.rollback()
            self.predicted = self.prediction.active

    def no_report(self) -> LinearReport:
        """The report of a frame that is not solved."""
        return LinearReport(0, False, self._last.age, self._last.preconditioner)

    def _solve(self, edit: ScriptFrame, mesh_update: MeshUpdate, solved: bool) -> LinearReport:
        """Solve a frame; `solved` shows whether the one before was."""
        mesh, prediction, analysis = self.moving.field_mesh, self.prediction, self.analysis
        hand = edit.gesture, (edit.c[0], edit.c[1])
        space = analysis.space
        interpolations = space.interpolations if space else ()
        # Flips of a frame that failed are not known any more.
        changed = mesh_update.changed_cells if solved else np.arange(len(mesh.cells), dtype=np.int32)
        if prediction:
            # On a new mesh, or one whose middle nodes have gone elsewhere, nothing is left to compare with.
            stays = mesh_update.level < 3 and mesh_update.old_mesh is None and not interpolations
            prediction.start(edit, stays)
        report = analysis.solve(
            Frame(
                mesh,
                changed,
                mesh_update.old_mesh,
                edit.scene,
                hand,
                interpolations,
                edit.edit_ended,
                mesh_update.part,
            )
        )
        self.solved = self.known = True
        self.moving.solved()
        if prediction:
            found = report.iterations or report.refreshed
            idle = edit.change == "none" and not (prediction.active or found)
            prediction.set_expansion_point(edit, idle)
        return report
