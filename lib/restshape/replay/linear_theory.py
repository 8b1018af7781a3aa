"""Whether displacements are so large that linear theory, which neglects turns and stretches, gives wrong answers."""

from __future__ import annotations

from math import hypot
from typing import TYPE_CHECKING

import numpy as np

from restshape.analysis.row_values import RowValues, text, whole

if TYPE_CHECKING:
    from restshape.analysis.analysis import Analysis
    from restshape.fem.problem import Problem

LARGEST = 0.1
"""Share of a body's size that displacements of its points may differ by; a tip that goes by it turns by as many rad."""
NOTE = (
    f"beyond linear theory: displacements differ by over {100.0 * LARGEST:g} % of the body's size: are units right? "
    "Else [effects.large_deformation]"
)


class LinearTheory:
    """Looks at each answer, off the frame's time.

    Args:
        analysis: of the frames.

    Attributes:
        largest: difference of displacements over the size of the body, the largest so far.
        frame: the one that has it.
    """

    def __init__(self, analysis: Analysis[Problem]) -> None:
        self.analysis = analysis
        self.largest, self.frame = 0.0, -1

    def note(self, row: RowValues) -> None:
        """Says so in the note of a frame's row, where its answer is a displacement of linear theory, and too large."""
        found, space = self.analysis.solution(), self.analysis.space
        if found.name != "displacement" or found.large or found.field is None or space is None:
            return
        share = hypot(*np.ptp(found.field, axis=0)) / float(np.ptp(space.X, axis=0).max())
        if share > self.largest:
            self.largest, self.frame = share, whole(row, "index")
        if share > LARGEST:
            row["note"] = "; ".join(filter(None, (text(row, "note"), NOTE)))

    def summary(self) -> dict[str, object]:
        """For programs, where it was too large: the largest share, and its frame."""
        beyond = {"displacement_over_size": self.largest, "frame": self.frame}
        return {"beyond_linear_theory": beyond} if self.largest > LARGEST else {}
