"""Whether the shape of a body in motion goes far in one frame, as by an undo: that puts energy into the motion."""

from __future__ import annotations

from typing import TYPE_CHECKING

from restshape import _kernels
from restshape.analysis.row_values import RowValues, text

if TYPE_CHECKING:
    from restshape.analysis.analysis import Analysis
    from restshape.fem.problem import Problem
    from restshape.shape.outline import Outline
    from restshape.shape.script_frame import ScriptFrame

FAR = 0.05
"""Share of the size of the shape, by which one of its control points goes in a frame."""
BACK = "drag it back over frames in place of"
MORE = "take more frames for"


class SuddenEdits:
    """Looks at each frame's shape beside that of the frame before.

    Args:
        analysis: of the frames.
    """

    def __init__(self, analysis: Analysis[Problem]) -> None:
        self.analysis = analysis
        self._outline: Outline | None = None

    def note(self, edit: ScriptFrame, row: RowValues) -> None:
        """Says so in the note of a frame's row."""
        before, now = self._outline, edit.outline
        self._outline = now
        if before is now or before is None or now is None or before.points.shape != now.points.shape:
            return
        # Unknowns of first order in time, and steady ones, have no energy of motion.
        if not getattr(self.analysis, "inertia", False):
            return
        size = max(before.points.ptp(axis=0).tolist())
        share = _kernels.largest_norm(now.points - before.points) / size
        if share > FAR:
            what = f"the shape goes {100 * share:.0f} % of its size in a frame, which puts energy into the motion"
            do = f'{BACK if edit.do in ("undo", "redo") else MORE} the {edit.do}; energy = "edit" says how much'
            row["note"] = "; ".join(filter(None, (text(row, "note"), f"{what}: {do}")))
