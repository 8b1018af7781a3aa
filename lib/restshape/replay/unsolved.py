"""Whether rounding has left an answer far from its tolerance, as where materials differ by a factor of 1e12."""

from __future__ import annotations

from restshape.analysis.row_values import RowValues, number, text

FAR = 1e3
"""Times the tolerance beyond which a residual is said: solvers end by their own, which is near the true one."""
SMALL = 1e-6
"""A residual below which nothing is said, however small the tolerance is."""


def note_unsolved(row: RowValues, tolerance: float) -> None:
    """Says so in the note of a frame's row.

    Args:
        row: of a frame with its residual; not a number where it has none. One of a prediction is none of a solve, and
            where rows say whether they have converged they say it themselves.
        tolerance: relative, of a solve.
    """
    residual = number(row, "residual")
    if row["predicted"] or "converged" in row or not residual > max(FAR * tolerance, SMALL):
        return
    what = (
        f"not to be trusted: the residual is {residual:.1e}, its tolerance {tolerance:g}; materials or sizes are too "
        "unlike for more digits"
    )
    row["note"] = "; ".join(filter(None, (text(row, "note"), what)))
