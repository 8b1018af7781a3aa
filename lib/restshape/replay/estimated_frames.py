"""Which frames of a replay have their errors estimated: by what they are and have computed, never by a clock."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from restshape.analysis.row_values import RowValues
    from restshape.shape.script_frame import ScriptFrame


class WantedErrors(NamedTuple):
    """What is estimated of a frame.

    Args:
        answer: the errors of the mesh and of the time step, and of quantities with `error = true`.
        solves: also what solves for something of its own: errors of all other quantities, jumps of the mesh.
    """

    answer: bool
    solves: bool


NOTHING, EVERYTHING, ANSWER = WantedErrors(False, False), WantedErrors(True, True), WantedErrors(True, False)


def needs_everything(when: str | int, edit: ScriptFrame) -> bool:
    """Whether a predicted frame is estimated of itself, whatever it computes; arguments as of `estimated`."""
    return when not in ("auto", "none", "idle") and estimated(when, edit, {}).answer


def estimated(when: str | int, edit: ScriptFrame, row: RowValues) -> WantedErrors:
    """What is estimated of a frame that was solved.

    With "auto" the errors of the answer, which cost a pass over the cells and a solve with the kept factor, in every
    frame. What takes as long as a short frame, or longer, where it does not hold up a hand (the first frame, one in
    which nothing moves or an edit ends), and where the frame itself has made a mesh or a preconditioner.

    Args:
        when: `solve.estimate` of the scene.
        edit: the frame; row: its row, with what its solve did.
    """
    rests = edit.edit_ended or not edit.index
    if when == "auto":
        return EVERYTHING if rests or row["level"] == 3 or row["pc_rebuilt"] or row["newton"] else ANSWER
    if when in ("none", "idle"):
        return EVERYTHING if rests and when == "idle" else NOTHING
    return NOTHING if isinstance(when, int) and edit.index % when else EVERYTHING
