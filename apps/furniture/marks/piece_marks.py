"""What a piece shows at the hand: its range, suggestions, forces, joints that break, and what is wrong in words."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from restshape_apps.furniture.marks.joint_marks import ForceMarks
from restshape_apps.furniture.marks.offer_marks import OfferMarks
from restshape_apps.furniture.marks.range_marks import RangeMarks
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.physics.plank_phrases import phrases
from restshape_apps.furniture.report.guided import CAUSES

from restshape.live.kept_marks import kept, of_answers
from restshape.live.shown_marks import Mark, Words
from restshape.replay.constraints import UNCERTAINTY

if TYPE_CHECKING:
    from collections.abc import Sequence

    from restshape_apps.furniture.analysis.furnishing import FurnitureAnalysis
    from restshape_apps.furniture.guidance.design import Design
    from restshape_apps.furniture.physics.furniture import TestResult
    from restshape_apps.furniture.session.plank_session import PlankSession

    from restshape.findings import Finding
    from restshape.interface.shown_frame import ShownFrame
    from restshape.interface.simulation import Simulation


@of_answers
def piece_marks(simulation: Simulation) -> list[Mark]:
    """The marks of the last frame of a piece of furniture."""
    return kept(simulation, PieceMarks)(simulation)


class PieceMarks:
    """Makes the marks of each frame of a piece; what has not changed since the last one is not made again.

    Geometry is asked of a model of its own: that of the analysis is not touched.
    """

    def __init__(self) -> None:
        self._model: Furniture | None = None
        self._design: Design | None = None
        self._ranges, self._offers = RangeMarks(), OfferMarks()
        self._forces: ForceMarks
        self._borne: tuple[TestResult | None, list[Mark]] = (None, [])
        self._known, self._said = ("", ""), list[Mark]()

    def __call__(self, simulation: Simulation) -> list[Mark]:
        """The marks of the last frame."""
        analysis = cast("FurnitureAnalysis", simulation.replay.analysis)
        session = cast("PlankSession", simulation.replay.session)
        row = simulation.frame.row
        if analysis.design is None:
            return []
        model = self._model_of(analysis.design)
        if analysis.result is not self._borne[0]:
            self._borne = analysis.result, self._forces(model.geometry(analysis.gamma), analysis.forces)
        # What is under a hand is no suggestion.
        chosen = session.chosen if analysis.design_direction is None or row["event"] == "slide" else None
        return [
            *self._borne[1],
            *self._ranges(analysis.design_direction, analysis.at, session.grabbed_at, model),
            *self._offers(analysis.design, analysis.suggestion_list, chosen, model),
            *self._sentences(simulation.frame),
        ]

    def _sentences(self, frame: ShownFrame) -> list[Mark]:
        """The sentences of a frame; those of the last one where it has found the same."""
        known = str(frame.row["findings"]), str(frame.row["no_suggestions"])
        if known != self._known:
            self._known, self._said = known, _sentences(frame.findings, known[1])
        return self._said

    def _model_of(self, design: Design) -> Furniture:
        """A model of a design that may be changed."""
        if self._model is None or design is not self._design:
            self._design, self._model = design, Furniture(design.piece, design.furniture.compliance)
            self._forces = ForceMarks(self._model)
        return self._model


def _sentences(findings: Sequence[Finding], why: str) -> list[Mark]:
    """What is wrong with the piece, or makes it doubtful, a line for each kind; why there are no suggestions, too."""
    doubts = phrases([one for one in findings if one.kind in CAUSES or one.kind == UNCERTAINTY])
    wrong = phrases([one for one in findings if not (one.kind in CAUSES or one.kind == UNCERTAINTY)])
    marks: list[Mark] = [Words(phrase, None, "limit") for phrase in wrong]
    marks += [Words(phrase, None, "uncertain") for phrase in doubts]
    return [*marks, Words(f"no suggestions: {why}", None, "uncertain")] if why else marks
