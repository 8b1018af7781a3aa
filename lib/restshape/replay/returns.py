"""What undo and redo bring back besides shape and scene: the mesh and the answer that there were, without a solve."""

from __future__ import annotations

import logging
from collections import OrderedDict
from typing import TYPE_CHECKING, NamedTuple, cast

from restshape.analysis.frame import Frame
from restshape.first_use import made
from restshape.mesh.advance import NO_CELLS, MeshUpdate

if TYPE_CHECKING:
    from restshape.algebra.linear_report import LinearReport
    from restshape.analysis.restorable import KeptAnswer, RecallingAnalysis, RestorableAnalysis
    from restshape.mesh.moving import MovingMesh
    from restshape.mesh.moving_state import KeptMesh
    from restshape.policy import Policy
    from restshape.replay.replay_parts import ReplayParts
    from restshape.shape.script_frame import ScriptFrame

log = logging.getLogger("restshape.replay")

MOST_BYTES = 2**28
"""Of arrays that are kept at most, 256 MiB; beyond it the oldest answers are forgotten, and their undo is solved."""
RETURNS = ("undo", "redo")
"""Events that go back to a shape and a scene that there were."""


class KeptFrame(NamedTuple):
    """A frame to which undo or redo may return.

    Args:
        edit: the last one with its shape and scene; both are kept, so that no others take their identity.
        answer: of it; mesh: as it lay, None where it follows the shape again.
    """

    edit: ScriptFrame
    answer: KeptAnswer
    mesh: KeptMesh | None = None

    @property
    def nbytes(self) -> int:
        """Of its arrays."""
        return self.answer.nbytes + (self.mesh.nbytes if self.mesh else 0)


class Returns:
    """Keeps the answers that undo and redo may return to.

    An answer that hangs on the way to it, such as that of cloth with friction, would not be found again by a solve; one
    of several, such as that of a solid that has snapped through, only where the solve starts near it. Modes have the
    ids that they had.

    Args:
        parts: of the replay.
        policy: one that rebuilds all in each frame returns to nothing.
        most: bytes of arrays that are kept.
    """

    def __init__(self, parts: ReplayParts, policy: Policy, most: int = MOST_BYTES) -> None:
        able = not policy.regenerate and policy.warm
        self._restorable: RestorableAnalysis | None = getattr(parts.analysis, "restorable", None) if able else None
        self._recalling: RecallingAnalysis | None = getattr(parts.analysis, "recalling", None) if able else None
        # What can be restored is of shapes, which such a mesh follows.
        self._moving = cast("MovingMesh", parts.moving)
        self.most = most
        self._kept: OrderedDict[tuple[int, int], KeptFrame] = OrderedDict()
        self._last: ScriptFrame | None = None
        self._ended = False

    @property
    def nbytes(self) -> int:
        """Of all arrays that are kept."""
        return sum(kept.nbytes for kept in self._kept.values())

    def leave(self, edit: ScriptFrame) -> None:
        """Keep the answer of the last frame, if an edit has ended with it and this frame changes anything."""
        last, ended = self._last, self._ended
        self._ended = edit.edit_ended
        if last is None or edit.change == "none" or edit.refused:
            return
        # An edit whose last frames are refused has ended with the one before them.
        if not (last.edit_ended or ended or last.change == "start" or edit.do in RETURNS):
            return
        if self._restorable is not None and (mesh := self._moving.kept_mesh()) is not None:
            self._keep(KeptFrame(last, self._restorable.kept_answer(), mesh))
        elif self._recalling is not None:
            self._keep(KeptFrame(last, self._recalling.kept_answer()))

    def _keep(self, found: KeptFrame) -> None:
        """Keep a frame, and forget the oldest ones that there is no room for."""
        key = _identity(found.edit)
        self._kept.pop(key, None)
        self._kept[key] = found
        while self.nbytes > self.most and self._kept:
            self._kept.popitem(last=False)

    def restored(self, edit: ScriptFrame) -> tuple[MeshUpdate, LinearReport] | None:
        """Bring back the mesh and the answer that an undo or redo returns to; None where the frame is to be solved.

        Where the answer is one of several, the solve is made to start from it.

        Raises:
            UserError: the scene's values make no sense; ReplayProblem: likewise.
        """
        if edit.do not in RETURNS or edit.refused or edit.change == "none" or not edit.analysed:
            return None
        kept = self._kept.get(_identity(edit))
        if kept is not None and self._recalling is not None:
            self._recalling.recall(kept.answer)
        if kept is None or kept.mesh is None or self._restorable is None:
            return None
        moving = self._moving
        mesh_update = moving.return_to(kept.mesh, made(edit.outline))
        hand = edit.gesture, (edit.c[0], edit.c[1])
        frame = Frame(moving.field_mesh, NO_CELLS, None, edit.scene, hand, (), edit.edit_ended)
        report = self._restorable.restore(kept.answer, frame)
        log.info("%4d Answer of frame %d brought back by %s", edit.index, kept.edit.index, edit.do)
        return mesh_update, report

    def take(self, edit: ScriptFrame, answered: bool) -> None:
        """Take note of a frame that was not refused, and whether the analysis has a solution of it."""
        self._last = edit if answered else None


def _identity(edit: ScriptFrame) -> tuple[int, int]:
    """Of shape and scene: sessions return to the same objects."""
    return id(edit.outline), id(edit.scene)
