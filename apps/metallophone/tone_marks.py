"""What a plate shows at the hand: where each mode is still, where it is hung, and the tone that it has when struck."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np
from restshape_apps.metallophone.hung import hung
from restshape_apps.metallophone.struck_tone import struck_tone

from restshape.analysis.modal.hanging import OUT_OF_PLANE
from restshape.analysis.modal.hanging_columns import NOTE, PLACES
from restshape.analysis.modal.nodal_lines import linear_triangles, nodal_lines
from restshape.analysis.modal.pitch import tone_words
from restshape.live.kept_marks import kept, of_answers
from restshape.live.shape_marks import shape_marks
from restshape.live.shown_marks import Lines, Mark, Words

if TYPE_CHECKING:
    from restshape.analysis.modal.modal import ModalAnalysis
    from restshape.analysis.modal.modal_state import ModalState
    from restshape.analysis.row_values import RowValues
    from restshape.arrays import Reals
    from restshape.interface.simulation import Simulation

MOVING = ("drag", "pull", "set")
"""Events during which hanging points are not looked for, where no scene asks for them: that takes longer than a frame.
"""


@of_answers
def tone_marks(simulation: Simulation) -> list[Mark]:
    """The marks of the last frame of a plate that sounds."""
    return [*shape_marks(simulation), *kept(simulation, ToneMarks)(simulation)]


class ToneMarks:
    """Makes the marks of each frame; those of one whose modes are the last ones are not made again."""

    def __init__(self) -> None:
        self._state: ModalState | None = None
        self._marks: list[Mark] = []
        self._hung: tuple[ModalState | None, list[Mark]] = (None, [])

    def __call__(self, simulation: Simulation) -> list[Mark]:
        """The marks of the last frame; none where it has no modes."""
        analysis, row = cast("ModalAnalysis", simulation.replay.analysis), simulation.frame.row
        if not simulation.replay.solver.known:
            return []
        state = analysis.state
        if state is not self._state:
            words = Words(f"{tone_words(str(row['tone']), float(row['cents']))}, {float(row['f_1']):.1f} Hz")
            lines = _still_lines(analysis, row, simulation.frame.fields)
            self._state, self._marks = state, [*lines, words, struck_tone(simulation)]
        return [*self._marks, *self._hanging(analysis, row)]

    def _hanging(self, analysis: ModalAnalysis, row: RowValues) -> list[Mark]:
        """Where the plate is hung: as its scene asks for it, else once the hand rests."""
        if PLACES[0] in row:
            places = np.array([float(row[name]) for name in PLACES]).reshape(-1, 2)
            return _hung_at(places, str(row[NOTE]))
        state = analysis.state
        if state.predicted or row["event"] in MOVING:
            return []
        if state is not self._hung[0]:
            found = hung(analysis)
            self._hung = state, [] if found is None else _hung_at(found.places, found.why)
        return self._hung[1]


def _still_lines(analysis: ModalAnalysis, row: RowValues, fields: dict[str, Reals]) -> list[Mark]:
    """Where each mode out of the plane is still, a mark each."""
    state, marks = analysis.state, list[Mark]()
    X, triangles = analysis.space.X, linear_triangles(analysis.space.cells)
    shares = state.modes.participation[state.modes.chosen]
    for k, share in enumerate(shares.tolist(), 1):
        if share < OUT_OF_PLANE:
            continue
        shape = fields[f"mode_{k}"]
        found = nodal_lines(triangles, shape[:, 2])
        count = len(found.sides)
        if count:
            tone = f"mode {k}: {tone_words(str(row[f'tone_{k}']), float(row[f'cents_{k}']))}"
            words = [tone, *[""] * (count - 1)]
            at, moved = found.ends(X).reshape(-1, 2), found.ends(shape).reshape(-1, 3)
            marks.append(Lines(f"mode {k} is still", at, range(0, 2 * count, 2), "node", moved, words, k))
    return marks


def _hung_at(places: Reals, why: str) -> list[Mark]:
    """The two places; why there are none."""
    if why or not np.isfinite(places).all():
        return [Words(f"no hanging points: {why}", None, "uncertain")] if why else []
    return [Lines("hang it here", places, (0, 1), "support", None, ("hang it here", "and here"))]
