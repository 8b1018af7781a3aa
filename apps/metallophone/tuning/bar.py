"""A bar whose freedoms change: solved for one set of values after the other, on one mesh as long as that serves."""

# More than 15 modules: the parts of a replay meet here, as in `restshape.replay.loop`.

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import log
from typing import TYPE_CHECKING, cast

import numpy as np
from petsc4py import PETSc
from restshape_apps.metallophone.tuning.bar_frame import bar_frame
from restshape_apps.metallophone.tuning.freedoms import Freedom, with_values

from restshape.algebra.stages import Stages
from restshape.analysis.modal.modal_errors import FrequencyEstimate
from restshape.errors import ReplayProblem, UserError
from restshape.replay.frame_solver import FrameSolver
from restshape.replay.replay_parts import replay_parts
from restshape.replay.request import Request
from restshape.shape.build import unchecked_outline
from restshape.shape.validity import problem

if TYPE_CHECKING:
    from restshape.analysis.modal.modal import ModalAnalysis
    from restshape.mesh.moving import MovingMesh
    from restshape.scene.model import Scene
    from restshape.shape.outline import Outline
    from restshape.shape.session import EditFrame


class Bar:
    """Solves one bar for values of its freedoms, one after the other.

    Args:
        scene: whose curves are fixed; freedoms: of it.

    Attributes:
        solves: of eigenproblems so far; level: of reuse of the mesh in the last one.
        analysis: of the last one; outline: its shape; now: its scene.
        why: the last values that were asked for have no solution; empty where they have.

    Raises:
        UserError: the scene cannot be solved.
    """

    def __init__(self, scene: Scene, freedoms: Sequence[Freedom]) -> None:
        self.scene, self.freedoms = scene, tuple(freedoms)
        request = Request.of(scene)
        parts = replay_parts(request, PETSc.COMM_WORLD, Stages())
        self._solver = FrameSolver(parts, request.policy)
        self.analysis, self.moving = cast("ModalAnalysis", parts.analysis), cast("MovingMesh", parts.moving)
        self.outline = cast("Outline", parts.session.outline)
        self.solves, self.level, self._frames, self.now = 0, 3, 0, scene
        self._kept, self.why = self.analysis.state, ""
        try:
            self._solve(self._frame("start", scene, self.outline))
        except ReplayProblem as failed:
            raise UserError(str(failed), str(scene.path), "mend the scene: its shape has no solution") from failed

    def at(self, values: np.ndarray, new_mesh: bool = False) -> bool:
        """Solve with values (k,) of the freedoms; whether there is a solution. Without one the bar is as it was."""
        try:
            scene = with_values(self.scene, self.freedoms, values)
            frame = self._frame("shape" if new_mesh else "move", scene)
            self._solve(frame)
        except (UserError, ReplayProblem) as failed:
            self.why = failed.what if isinstance(failed, UserError) else str(failed)
            return False
        self.outline, self.why = frame.outline, ""
        return True

    def has_outline(self, values: np.ndarray) -> bool:
        """Whether the outline at values (k,) of the freedoms can be drawn and does not meet itself; without a solve."""
        try:
            shape = with_values(self.scene, self.freedoms, values)
            return problem(unchecked_outline(shape.shape, shape.folder)) is None
        except UserError:
            return False

    def errors(self, ranks: Sequence[int]) -> tuple[float, ...]:
        """The estimated errors (m,) [cents] that the mesh makes of frequencies, by rank from 1, in the last solve."""
        relative = FrequencyEstimate()(self.analysis.state)
        return tuple(1200.0 / log(2.0) * float(relative[rank - 1]) for rank in ranks)

    def keep(self) -> None:
        """Modes of later solves are followed from those of the last one."""
        self._kept = self.analysis.state

    def forget(self) -> None:
        """Follow modes from those that were kept: the last solve may have mixed them up, so far it went."""
        state, kept = self.analysis.state, self._kept
        # On a mesh that has been made since, those that were kept are interpolated from theirs.
        same = state.space is kept.space
        self.analysis.state = replace(state, modes=kept.modes, solved=kept.modes) if same else kept

    def _frame(self, change: str, scene: Scene, outline: Outline | None = None) -> EditFrame:
        self._frames += 1
        return bar_frame(self._frames - 1, change, scene, self.outline, outline)

    def _solve(self, frame: EditFrame) -> None:
        try:
            update = self.moving.update(frame)
            self.solves += 1
            self._solver(frame, update)
        except (UserError, ReplayProblem):
            self._solver.rollback()
            raise
        self.level, self.now = update.level, frame.scene
