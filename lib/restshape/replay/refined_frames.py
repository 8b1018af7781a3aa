"""Frames of a drag from a coarse mesh, shown on the fine one, which is solved where the script leaves time for it."""

from __future__ import annotations

import logging
from math import log as ln
from math import nan
from typing import TYPE_CHECKING, NamedTuple

from restshape.errors import ReplayProblem
from restshape.replay.estimated_frames import needs_everything
from restshape.replay.predicted_frames import TRUSTED
from restshape.replay.sampled_frames import SampledFrames
from restshape.sensitivity.samples import DragSamples, SamplePlace

if TYPE_CHECKING:
    from collections.abc import Callable

    from restshape.analysis.analysis import Analysis, RowValues
    from restshape.analysis.refining_predictor import RefiningPredictor
    from restshape.fem.problem import Problem
    from restshape.mesh.advance import MeshUpdate
    from restshape.mesh.follower import Follower
    from restshape.policy import Policy
    from restshape.replay.predicted_frames import Predicted
    from restshape.scene.model import PredictSpec
    from restshape.shape.hand.gesture import Gesture
    from restshape.shape.protocol import Session
    from restshape.shape.script_frame import ScriptFrame

log = logging.getLogger("restshape.replay")

AGAIN = 4.0
"""Times that the way of the hand from the nearest sample grows or shrinks before a frame is estimated again."""
SQUARE = 2.0
"""What the estimate grows with at most: the square of that way."""
COARSE, SLOPES, STEP, FINE, CORRECTION = "coarse solve", "coarse derivative", "fine step", "fine solve", "derivative"
"""What idle time is spent on, in this order."""


class NestedLevels(NamedTuple):
    """Numbers of nested meshes, of which the coarsest of all is 1: of the one that is predicted, and of the finest."""

    coarse: int
    finest: int


# More than 15 attributes: those of sampled frames, and what is known of the fine mesh.
class RefinedFrames(SampledFrames):
    """Predicts the frames of a drag on a coarse mesh, and shows them on the fine one with a correction.

    Frames of a drag are those of the coarse mesh, with as many solver steps of it as there is time for; one whose
    prediction would be too far off is solved on it. The correction, what the fine mesh had besides at its last
    solutions, is mixed from samples of its own. In idle time the coarse mesh is solved and differentiated, and then
    the fine one is, step by step: where the hand moves on before it is at its solution, where they have led to is the
    last state that the correction is mixed from.

    Args:
        analysis: of the finest mesh; others as of `SampledFrames`.
        pair: predicts on the coarse mesh, and shows the finest one.
        levels: numbers of both.

    Source: docs/theory/design-derivative.md; 5.3.5 of the thesis.
    """

    def __init__(
        self,
        analysis: Analysis[Problem],
        moving: Follower,
        session: Session,
        policy: Policy,
        *,
        spec: PredictSpec,
        size: float,
        pair: RefiningPredictor,
        levels: NestedLevels,
    ) -> None:
        super().__init__(analysis, moving, session, policy, spec=spec, size=size)
        self.predictor = self.pair = pair
        self.levels = levels
        self._corrections: DragSamples | None = None
        self._fine_frame, self._refined = 0, False
        self._stale = False
        self._power, self._asked = SQUARE, False
        self._shown: float | None = None

    measured = False
    rebases = False

    def row(self) -> RowValues:
        """As of `SampledFrames`, and which mesh is shown, and for how many frames the finest has had no solution."""
        level = self.levels.coarse if self.active else self.levels.finest
        age = self._frame - self._fine_frame if self.active else 0
        return super().row() | {"idle_work": self._counted_work(), "level_shown": level, "fine_age": age}

    def _counted_work(self) -> str:
        """What idle time was spent on, each with how often."""
        done = self._time.done
        times = {work: done.count(work) for work in dict.fromkeys(done)}
        return ", ".join(f"{count} x {work}" if count > 1 else work for work, count in times.items())

    def show(self, edit: ScriptFrame, mesh_update: MeshUpdate) -> bool:
        """Whether a frame is shown without a solve of the fine mesh; see `PredictedFrames.show`."""
        made, known = self.made, self._corrections
        if made is not None and known is not None and edit.gesture is made.gesture and edit.change == "move":
            self.pair.correction = known(edit.c)
        pair, before = self.pair, self.predictor.values() if made is not None else None
        when = edit.scene.solve.estimate
        pair.waits, pair.lean = True, not needs_everything(when, edit)
        self._asked = when == "auto"
        try:
            shown = super().show(edit, mesh_update)
            pair.waits, self._stale = False, True
            if before is not None and self.predictor.values() is not before:
                pair.show()
            if shown and pair.lean and pair.distance_known:
                self.estimated(nan)
        finally:
            pair.waits = pair.lean = False
        self._shown = self._grown() if shown and self._asked and pair.sparse else None
        return shown

    def known_estimate(self) -> float | None:
        """Of a frame of which positions alone are made: by the last estimate of the coarse mesh."""
        return self._shown

    def _grown(self) -> float:
        """The estimate here, by the last one and the way of the hand since."""
        if self._estimate is None:
            self.estimated(nan)
        error, way = self._estimate or (nan, 0.0)
        return self._expected_error(error, way) + self.pair.way(self.pair.correction)

    def estimated(self, estimate: float) -> None:
        """Take note of how far the coarse mesh is from its solution: the fine one decides on no frame.

        Two in a row, at unlike ways of the hand, say with which power of the way the distance grows.
        """
        self._stale, before = False, self._estimate
        super().estimated(self.pair.coarse_distance())
        error, way = self._estimate or (nan, 0.0)
        ratio = self._ways(way, before[1]) if before else 1.0
        if before and ratio == 1.0:
            return
        self._power = SQUARE
        if before and error > 0.0 and before[0] > 0.0:
            self._power = min(max(ln(error / before[0]) / ln(ratio), 0.0), SQUARE)

    def _expected_error(self, error: float, way: float) -> float:
        return error * self._ways(self.distance, way) ** self._power

    def _ways(self, way: float, before: float) -> float:
        """One way of the hand over another one, neither shorter than what samples are told apart by."""
        least = (self._samples.smoothing if self._samples is not None else self.spec.epsilon) * self.size
        return max(way, least) / max(before, least)

    def _is_due(self) -> bool:
        """Whether the last estimate is from too far away to go by, where estimates are asked for."""
        if self._estimate is None:
            return True
        ways = self._ways(self.distance, self._estimate[1])
        return self._asked and not 1.0 / AGAIN < ways < AGAIN

    def _is_trusted(self) -> bool:
        """Whether what the coarse mesh shows may be; where it is not trusted, the coarse mesh is solved."""
        if self._is_due():
            self.estimated(nan)
        if super()._is_trusted():
            return True
        if self._stale:
            # Frames since have not been estimated.
            self.estimated(nan)
            if super()._is_trusted():
                self._doubt = ""
                return True
        scene = self._scene
        if scene is None:
            return False
        try:
            self.pair.settle(scene)
        except ReplayProblem as problem:
            log.info("Coarse mesh: %s", problem)
            return False
        self._doubt = ""
        return True

    def set_expansion_point(self, edit: ScriptFrame, idle: bool) -> None:
        """Take a frame that the fine mesh has been solved in for a sample; arguments as in `PredictedFrames`."""
        self._fine_frame = edit.index
        super().set_expansion_point(edit, idle)
        if self.made is None:
            self._corrections = None

    def forget(self) -> None:
        """As of `PredictedFrames`."""
        super().forget()
        self._corrections = None

    def idle(self, edit: ScriptFrame, solve: Callable[[ScriptFrame], None]) -> None:
        """Before a frame, spend the edit time since the last one: on the coarse mesh first, then on the fine one."""
        if not self.active:
            self._fine_frame = edit.index - 1
        super().idle(edit, solve)

    def _take_steps(self, edit: ScriptFrame) -> None:
        """Take as many solver steps of the coarse mesh as the frame's time pays for."""
        if not self.pair.settled:
            super()._take_steps(edit)

    def _next_work(self, last: ScriptFrame, made: DragSamples) -> str | None:
        """What is to be done where the hand is; None: nothing."""
        rests = last.change == "none"
        if self._stuck:
            return None
        if not self.pair.settled:
            return COARSE
        if not made.knows(last.c, self._mesh, rests=rests):
            return SLOPES
        if self.predictor.prediction is not None:
            return FINE if self._refined else STEP
        known = self._corrections
        return None if known is None or known.knows(last.c, self._mesh, rests=rests) else CORRECTION

    def _work(self, work: str, last: ScriptFrame, made: DragSamples, solve: Callable[[ScriptFrame], None]) -> None:
        """Do a piece of work.

        Raises:
            ReplayProblem: it leads to nothing.
        """
        self._refined = self._refined and work == FINE
        if work in (COARSE, SLOPES):
            self._estimate = None
        if work == COARSE:
            self.pair.settle(last.scene)
            made.set_last(last.c, self.predictor.values())
        elif work == SLOPES:
            super()._sample(last, made)
        elif work == STEP:
            self._refined = not self.pair.refine()
            reached = self.pair.reached()
            # Cloth that falls goes too far to be a correction.
            near = reached is not None and self.pair.way(reached) <= TRUSTED
            if self._corrections is not None and reached is not None and near:
                self._corrections.set_last(last.c, reached)
        elif work == FINE:
            predicted = self.predictor.prediction
            self.pair.take()
            solve(last)
            self.active, self._estimate, self._refined = False, None, False
            self._found = self.predictor.error(predicted) if predicted is not None else self._found
            self._fine_frame = last.index
        else:
            self._correct(last, made)

    def _taken(self, edit: ScriptFrame, gesture: Gesture) -> Predicted | None:
        try:
            self.pair.begin()
        except ReplayProblem as problem:
            self.note = f"not predicted: {problem}"
            self._samples = None
            return None
        known = self._corrections
        if known is not None and known.mesh != self._mesh:
            # Fine nodes of other triangles are others.
            self._corrections = None
        return super()._taken(edit, gesture)

    def _leave(self, edit: ScriptFrame) -> None:
        """None: samples of a coarse mesh do not go on to another one."""
        return None

    def _sample(self, edit: ScriptFrame, made: DragSamples) -> None:
        """Differentiate a frame that both meshes have been solved in."""
        super()._sample(edit, made)
        if len(made):
            self._correct(edit, made)

    def _correct(self, edit: ScriptFrame, made: DragSamples) -> None:
        """Take a sample of the correction where both meshes have solutions."""
        motion = self.moving.linear_motion
        if motion is None:
            return
        values, slopes = self.pair.fine_correction(motion, edit.scene.solve.tolerance)
        if self._corrections is None or self._corrections.gesture is not made.gesture:
            self._corrections = DragSamples(made.gesture, self.size, self.spec.epsilon, self.spec.samples)
        self._corrections.mesh = self._mesh
        self._corrections.add(SamplePlace(edit.c, edit.index, self._mesh), values, slopes)
        self._corrections.set_last(edit.c, values)
        self.pair.correction = values
