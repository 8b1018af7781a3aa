"""Whether displacements are so large that linear theory, which neglects turns and stretches, gives wrong answers."""

from __future__ import annotations

from math import hypot, sqrt
from typing import TYPE_CHECKING

import numpy as np

from restshape import _kernels
from restshape.analysis.row_values import RowValues, text, whole
from restshape.arrays import Reals

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
        largest: difference of displacements over the size of the body, the largest so far of those that were not
            small without computing it.
        frame: the one that has it.
    """

    def __init__(self, analysis: Analysis[Problem]) -> None:
        self.analysis = analysis
        self.largest, self.frame = 0.0, -1
        self._ends = (0, 0)

    def note(self, row: RowValues) -> None:
        """Says so in the note of a frame's row, where its answer is a displacement of linear theory, and too large."""
        u, space = self.analysis.linear_displacement(), self.analysis.space
        if u is None or space is None or self._small(u, space.X):
            return
        share = hypot(*np.ptp(u, axis=0)) / float(np.ptp(space.X, axis=0).max())
        if share > self.largest:
            self.largest, self.frame = share, whole(row, "index")
        if share > LARGEST:
            row["note"] = "; ".join(filter(None, (text(row, "note"), NOTE)))

    def _small(self, u: Reals, X: Reals) -> bool:
        """Whether bounds tell that displacements differ by at most `LARGEST` of the size, without extents of all nodes.

        They differ by no more than twice the largest component in each direction. The body is no smaller than two of
        its nodes are apart, for which those that were farthest from each other are taken.
        """
        most = 2.0 * sqrt(u.shape[1]) * _kernels.largest_size(u)
        if len(X) > max(self._ends) and most <= LARGEST * _apart(X, *self._ends):
            return True
        axis = int(np.ptp(X, axis=0).argmax())
        self._ends = int(X[:, axis].argmin()), int(X[:, axis].argmax())
        return most <= LARGEST * _apart(X, *self._ends)

    def summary(self) -> dict[str, object]:
        """For programs, where it was too large: the largest share, and its frame."""
        beyond = {"displacement_over_size": self.largest, "frame": self.frame}
        return {"beyond_linear_theory": beyond} if self.largest > LARGEST else {}


def _apart(X: Reals, first: int, last: int) -> float:
    """The largest difference of two nodes' coordinates."""
    return max(map(abs, (X[first] - X[last]).tolist()))
