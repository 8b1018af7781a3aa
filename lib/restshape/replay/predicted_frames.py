"""Which frames of a replay are predicted, and from where."""

import logging
from collections.abc import Callable
from math import nan
from typing import Protocol

import numpy as np

from restshape.analysis.analysis import Analysis, Predictor, RowValues
from restshape.arrays import Reals
from restshape.errors import ReplayProblem, UserError
from restshape.fem.problem import Problem
from restshape.first_use import made as known
from restshape.mesh.advance import MeshUpdate
from restshape.mesh.follower import Follower
from restshape.policy import Policy
from restshape.replay.estimated_frames import needs_everything
from restshape.sensitivity.linear_prediction import Prediction
from restshape.shape.hand.gesture import Gesture
from restshape.shape.protocol import Session
from restshape.shape.script_frame import ScriptFrame

log = logging.getLogger("restshape.replay")

SPRINGS = "not predicted: nodes that springs relax do not follow the hand linearly"
ARC = "not predicted: bending an arc is not linear"
BESIDE = "not predicted: the hand moves {}, which is no part of the shape"
TRUSTED = 0.2
"""Estimated relative distance from the solution beyond which a frame is solved instead."""
MANY = 30_000
"""Unknowns from which on a frame takes less than an estimate of it, so that not every frame has one of its own."""
FARTHER = 4.0
"""Ways of the hand in which its last estimate serves a frame with so many unknowns."""


class Predicted(Protocol):
    """What predicts the frames of a drag."""

    @property
    def gesture(self) -> Gesture:
        """What the hand holds."""

    @property
    def c(self) -> tuple[float, float]:
        """Coefficients of the hand where the newest of what it knows is from."""

    def __call__(self, c: tuple[float, float]) -> Reals:
        """The values with the hand at c."""


class PredictedFrames:
    """Shows the frames of a drag by the design derivative, and says which ones must be solved.

    A frame in which a hand takes hold of the shape is solved, and the derivatives are solved for; so is one that flips
    edges or makes a new mesh, or in which values are set. All others while the hand holds are predicted from the last
    of these. On release the frame is solved, from its prediction.

    A prediction whose own estimate of its distance from the solution would be above `TRUSTED` is not shown: the frame
    is solved, and the next ones are predicted from it. The first one after a solved frame is estimated before it is
    shown, the others by the estimate of the one before, which grows with the square of the way of the hand. With
    `MANY` unknowns a frame is estimated of itself where the hand has gone `FARTHER` since the last estimate, or where
    `solve.estimate` asks for it by a number or "every"; else its estimate is the last one that has grown so.

    Args:
        analysis: with a predictor.
        moving: the mesh.
        session: the edits.
        policy: what is reused.

    Raises:
        UserError: the analysis has no predictor, or the policy makes a new mesh in each frame.

    Attributes:
        kind: as after `--predict`.
        made: predicts the frames that follow; None: they are solved.
        active: the frame shows a prediction.

    Source: docs/theory/design-derivative.md.
    """

    kind = "linear"
    measured = True
    """Frames that are predicted have a residual, and an estimate, whether or not they are asked for."""
    extrapolates = True
    """Estimates of frames with many unknowns may be taken from the last one."""

    def __init__(self, analysis: Analysis[Problem], moving: Follower, session: Session, policy: Policy) -> None:
        if analysis.predictor is None:
            raise UserError(analysis.why_not, f"--predict {self.kind}", "leave it out")
        if policy.regenerate:
            raise UserError(
                f"the policy {policy.name} makes a new mesh in each frame, so that there is nothing to predict on",
                f"--predict {self.kind}",
                "choose another policy, or leave it out",
            )
        self.analysis = analysis
        self.predictor: Predictor = analysis.predictor
        self.moving, self.session = moving, session
        self.made: Predicted | None = None
        self.active = False
        self.note = ""
        self._before: Reals | None = None
        self._expected: Reals | None = None
        self._c = (0.0, 0.0)
        self._estimate: tuple[float, float] | None = None
        self._distances: tuple[dict[str, float], float] = ({}, 0.0)
        self._extrapolated = False
        self._doubt = ""
        self._beside = ""

    @property
    def distance(self) -> float:
        """How far the hand is from where the predictions start, in its coefficients."""
        start = self.made.c if self.made is not None else self._c
        return float(np.hypot(self._c[0] - start[0], self._c[1] - start[1]))

    def error(self) -> float:
        """The relative distance from the solution of the prediction that the frame's solve started from.

        Not a number where it did not, or the nodes of the prediction are no longer those of the solution.
        """
        return nan if self._expected is None else self.predictor.error(self._expected)

    def show(self, edit: ScriptFrame, mesh_update: MeshUpdate) -> bool:
        """Whether a frame is shown without a solve; the analysis then holds its predicted values."""
        made, self._expected = self.made, None
        if made is None or edit.gesture is not made.gesture or mesh_update.level > 1 or edit.do == "analyse":
            return False
        asked = needs_everything(edit.scene.solve.estimate, edit)
        many = self.extrapolates and not asked and self.analysis.unknowns >= MANY
        # A frame that shows what is shown already has the estimate of that.
        self._extrapolated = many and (edit.change == "move" or self._extrapolated)
        if edit.change == "move":
            before = self.predictor.values()
            self._set(made(edit.c))
            self._c = edit.c
            if not self._is_trusted():
                self.predictor.set_values(before)
                return False
            self.active, self.note = True, ""
        return self.active and edit.change in ("move", "none")

    def estimated(self, estimate: float) -> None:
        """Take note of the estimated relative distance of the prediction that the analysis holds from the solution."""
        self._estimate, self._extrapolated = (estimate, self.distance), False

    def known_estimate(self) -> float | None:
        """What is known of the estimate of the frame without the analysis; None: the analysis estimates it."""
        if self._estimate is None or not self._extrapolated:
            return None
        error, way = self._estimate
        return self._expected_error(error, way) if self.distance <= FARTHER * way else None

    def quantity_distances(self) -> dict[str, float]:
        """Estimated distances of the frame's quantities from those of the solution, by name; likewise."""
        if self.known_estimate() is None:
            self._distances = self.predictor.quantity_distances(), self.distance
            return self._distances[0]
        found, way = self._distances
        return {name: self._expected_error(one, way) for name, one in found.items()}

    def _is_trusted(self) -> bool:
        """Whether the prediction that the analysis holds may be shown."""
        if self._estimate is None:
            # Where nothing estimates it, frames are shown as they are predicted.
            self.estimated(self.analysis.errors().get("estimate", np.nan))
        error, way = known(self._estimate)
        expected = self._expected_error(error, way)
        if not expected > TRUSTED:
            return True
        self._doubt = f"solved: its prediction would be off by about {100.0 * expected:.2g} %"
        log.info("Frame %s", self._doubt)
        return False

    def _expected_error(self, error: float, way: float) -> float:
        """The error here of a prediction that was off by an error after a way of the hand."""
        return error * max(1.0, self.distance / way) ** 2 if way > 0.0 else error

    def _set(self, values: Reals) -> None:
        """Let the analysis hold what is predicted."""
        self.predictor.set_values(values)

    def start(self, edit: ScriptFrame, stays: bool) -> None:
        """Let the solve of a frame start at its prediction, where there is one.

        Args:
            edit: the frame.
            stays: its nodes are those of the frame before, so that its solution can be compared with the prediction.
        """
        self._before = None
        starts = self.made is not None and edit.change == "move" and (stays or self.predictor.transferable)
        if starts and self.made is not None and edit.gesture is self.made.gesture:
            self._before = self.predictor.values()
            self._set(self.made(edit.c))
        self._expected = self.predictor.prediction if stays else None

    def rollback(self) -> None:
        """Show again what was shown before the last frame, whose solve has failed."""
        if self._before is not None:
            self.predictor.set_values(self._before)
        self.note, self._doubt, self._before = "", "", None

    def forget(self) -> None:
        """The frame shows an answer of before, from which nothing is predicted."""
        self.made = self._expected = self._estimate = self._before = None
        self._distances = {}, 0.0
        self.active, self.note, self._doubt = False, "", ""

    def set_expansion_point(self, edit: ScriptFrame, idle: bool) -> None:
        """Take a frame that has been solved to predict the next ones from.

        Args:
            edit: the frame.
            idle: nothing was solved in it, for all is as before.
        """
        self.note, self._before = self._doubt, None
        self._doubt = ""
        gesture = self.session.grabbed
        self._note_beside(edit)
        kept = self.made is not None and self.made.gesture is gesture and idle
        self.active = False
        if kept:
            return
        self.made = self._estimate = None
        self._distances = {}, 0.0
        if edit.gesture is None or edit.gesture is not gesture or not gesture.linear:
            if edit.change == "move" and edit.gesture is not None and not edit.gesture.linear:
                self.note = ARC
                log.info("%4d Frames %s", edit.index, self.note)
            return
        self.made = self._taken(edit, edit.gesture)

    def _note_beside(self, edit: ScriptFrame) -> None:
        """Say at its first frame what a hand holds beside the shape: a body, or a support."""
        before, self._beside = self._beside, edit.hand[0] if edit.hand and self.session.grabbed is None else ""
        if self._beside not in ("", before):
            self.note = BESIDE.format(self._beside)
            log.info("%4d Frames %s", edit.index, self.note)

    def idle(self, edit: ScriptFrame, solve: Callable[[ScriptFrame], None]) -> None:
        """Before a frame, spend the edit time since the last one: on nothing.

        Args:
            edit: the frame.
            solve: solves the last frame where it shows a prediction.
        """

    def row(self) -> RowValues:
        """Columns of a frame's row that only this kind of prediction has: none."""
        return {}

    def _taken(self, edit: ScriptFrame, gesture: Gesture) -> Predicted | None:
        """What predicts the next frames, from one that has been solved; None where nothing does."""
        s = self._derivatives(edit)
        return None if s is None else Prediction(gesture, edit.c, self.predictor.values(), s)

    def _derivatives(self, edit: ScriptFrame) -> Reals | None:
        """The derivatives (2, ...) at a frame that has been solved; None with a note of why there are none."""
        try:
            motion = self.moving.linear_motion
            s = None if motion is None else self.predictor.derivative(motion, edit.scene.solve.tolerance)
        except ReplayProblem as problem:
            self.note = f"not predicted: {problem}"
            log.info("%4d Frames %s", edit.index, self.note)
            return None
        if s is None:
            self.note = SPRINGS
            log.info("%4d Frames %s", edit.index, self.note)
            return None
        log.info("%4d Expansion point of the frames that follow", edit.index)
        return s
