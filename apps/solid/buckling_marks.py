"""What solids show at the hand: at which part of its load one buckles, and where, besides what all shapes show."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from restshape.live.kept_marks import of_answers
from restshape.live.shape_marks import marks_of_answer
from restshape.live.shown_marks import Mark, Meaning, Words

if TYPE_CHECKING:
    from restshape.interface.simulation import Simulation


@of_answers
def buckling_marks(simulation: Simulation) -> list[Mark]:
    """The marks of the last frame of a solid."""
    marks, frame = marks_of_answer(simulation), simulation.frame
    if "mu_1" not in frame.row or not simulation.replay.solver.known:
        return marks
    factor = float(frame.row["mu_1"])
    if not np.isfinite(factor):
        return [*marks, Words("nothing buckles")]
    meaning: Meaning = "limit" if factor < 1.0 else "guide"
    text = f"buckles at {factor:.3g} times its load"
    mode = frame.fields["buckling_mode_1"]
    if not np.isfinite(mode).all():
        return [*marks, Words(text, None, meaning)]
    node = int(np.linalg.norm(mode, axis=1).argmax())
    at, moved = simulation.replay.solver.space.X[node], frame.fields["displacement"][node]
    return [*marks, Words(text, at.tolist(), meaning, moved.tolist())]
