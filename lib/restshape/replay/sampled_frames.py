"""Frames of a drag that are predicted from several samples, which are taken where the script leaves time for it."""

from __future__ import annotations

import logging
from math import isnan, nan
from typing import TYPE_CHECKING

from restshape.errors import ReplayProblem
from restshape.replay.idle_time import IdleTime
from restshape.replay.predicted_frames import PredictedFrames
from restshape.sensitivity.projected_samples import LeftSamples, can_be_projected
from restshape.sensitivity.samples import DragSamples, SamplePlace

if TYPE_CHECKING:
    from collections.abc import Callable

    from restshape.analysis.analysis import Analysis, RowValues
    from restshape.arrays import Reals
    from restshape.fem.problem import Problem
    from restshape.mesh.advance import MeshUpdate
    from restshape.mesh.follower import Follower
    from restshape.policy import Policy
    from restshape.replay.predicted_frames import Predicted
    from restshape.scene.model import PredictSpec, Scene
    from restshape.shape.hand.gesture import Gesture
    from restshape.shape.protocol import Session
    from restshape.shape.script_frame import ScriptFrame

log = logging.getLogger("restshape.replay")

MOST_STEPS = 20
"""Solver steps in a frame of a drag."""
SOLVE, DERIVATIVE = "solve", "derivative"
"""What idle time is spent on."""
LEFT = "predicted from here alone: a mode of the samples is not among those of this frame; more modes would keep them"
"""Note of a frame from which prediction begins again."""


# More than 15 attributes: those of predicted frames, the samples, the last frame, and what a row says of them.
class SampledFrames(PredictedFrames):
    """Predicts the frames of a drag by moving least squares from samples; arguments as `PredictedFrames`.

    The first sample is that of the press. Frames that are solved within the drag are others; and where the edit time
    until the next frame pays for it by the calibration, the frame is solved and differentiated then. A frame of the
    drag shows the prediction after as many solver steps as its own time pays for.

    Args:
        spec: of the scene.
        size: diagonal of the shape [m].

    Source: docs/theory/design-derivative.md; 5.1.5 of the thesis.
    """

    kind = "gmls"
    rebases = True
    """Samples of another mesh are made to agree with the answer on this one."""
    extrapolates = False

    def __init__(
        self,
        analysis: Analysis[Problem],
        moving: Follower,
        session: Session,
        policy: Policy,
        *,
        spec: PredictSpec,
        size: float,
    ) -> None:
        super().__init__(analysis, moving, session, policy)
        self.predictor = self.predictor.mixable()
        self.spec, self.size = spec, size
        self._samples: DragSamples | None = None
        self._scene: Scene | None = None
        self._aligned: Reals | None = None
        self._last: ScriptFrame | None = None
        self._time = IdleTime()
        self._steps, self._frame, self._found = 0, 0, nan
        self._stuck = False
        self._began: tuple[int, ...] = ()
        self._former: ScriptFrame | None = None
        self._left: LeftSamples | None = None

    @property
    def distance(self) -> float:
        """How far the hand is from the nearest sample, in its coefficients."""
        made = self._samples
        return super().distance if made is None or not len(made) else made.distance(self._c)

    def error(self) -> float:
        """As of `PredictedFrames`; after idle time in which the frame was solved, of what it had shown."""
        return super().error() if isnan(self._found) else self._found

    def row(self) -> RowValues:
        """Samples that the frame was predicted from, its solver steps, and what the time before it was spent on."""
        made = self._samples if self.made is not None else None
        places = made.places if made else []
        return {
            "samples": len(places),
            "samples_projected": sum(at.projected for at in places),
            "sample_ages": " ".join(str(self._frame - at.frame) for at in places),
            "sample_epsilon": made.smoothing if made else nan,
            "solver_steps": self._steps,
            "idle_time": self._time.given,
            "idle_spent": self._time.paid,
            "idle_work": ", ".join(self._time.done),
        }

    def show(self, edit: ScriptFrame, mesh_update: MeshUpdate) -> bool:
        """Whether a frame is shown without a solve; see `PredictedFrames.show`."""
        self._steps = 0
        shown = super().show(edit, mesh_update)
        if shown and edit.change == "move":
            self._take_steps(edit)
        if edit.refused is None:
            self._last, self._former = edit, self._last
        return shown

    def start(self, edit: ScriptFrame, stays: bool) -> None:
        """Let the solve of a frame start at its prediction, where there is one; arguments as in `PredictedFrames`."""
        super().start(edit, stays)
        self._left = None
        if not stays:
            self._samples, self._left = None, self._leave(edit)
        self._began = self.predictor.counted()

    def forget(self) -> None:
        """As of `PredictedFrames`."""
        super().forget()
        self._samples, self._found, self._steps = None, nan, 0
        self._time.close()

    def set_expansion_point(self, edit: ScriptFrame, idle: bool) -> None:
        """Take a frame that has been solved for a sample; arguments as in `PredictedFrames`."""
        if not idle:
            self._time.note(SOLVE, self.predictor.seconds_since(self._began))
            self._stuck = False
        super().set_expansion_point(edit, idle)
        if self.made is None:
            self._samples = None

    def idle(self, edit: ScriptFrame, solve: Callable[[ScriptFrame], None]) -> None:
        """Before a frame, spend the edit time since the last one on a sample where the hand is.

        A frame of a drag that takes solver steps keeps `frame_time` of it.

        Args:
            edit: the frame.
            solve: solves the last frame where it shows a prediction.
        """
        last, made, self._frame, self._found = self._last, self._samples, edit.index, nan
        if last is None or made is None or self.made is not made or self.session.grabbed is not made.gesture:
            self._time.close()
            return
        moved = last.change == "move"
        self._time.begin(edit.t - last.t - (self.spec.frame_time if moved and self._steps else 0.0), moved)
        self._stuck = self._stuck and not moved
        while (work := self._next_work(last, made)) and self._time.pays(work):
            self._do(work, last, made, solve)
        if not len(made):
            self.made = None

    def _next_work(self, last: ScriptFrame, made: DragSamples) -> str | None:
        """What is to be done where the hand is; None: nothing."""
        if self._stuck:
            return None
        if self.predictor.prediction is not None:
            return SOLVE
        return None if made.knows(last.c, self._mesh, rests=last.change == "none") else DERIVATIVE

    def _do(self, work: str, last: ScriptFrame, made: DragSamples, solve: Callable[[ScriptFrame], None]) -> None:
        """Do a piece of work, and pay for it."""
        before = self.predictor.counted()
        try:
            self._work(work, last, made, solve)
        except ReplayProblem as problem:
            self._stuck = True
            log.info("%4d Idle: no %s: %s", last.index, work, problem)
        spent = self.predictor.seconds_since(before)
        self._time.pay(work, spent)
        log.info("%4d Idle: %s, %.3g s of counted work", last.index, work, spent)

    def _work(self, work: str, last: ScriptFrame, made: DragSamples, solve: Callable[[ScriptFrame], None]) -> None:
        """Do a piece of work.

        Raises:
            ReplayProblem: it leads to nothing.
        """
        if work != SOLVE:
            self._sample(last, made)
            return
        predicted = self.predictor.prediction
        solve(last)
        self.active, self._estimate = False, None
        self._found = nan if predicted is None else self.predictor.error(predicted)
        if not self._align(made):
            # What they were is hardly among the modes of now.
            made.clear()
        made.set_last(last.c, self.predictor.values())

    def _take_steps(self, edit: ScriptFrame) -> None:
        """Take as many solver steps from the prediction as the frame's time pays for."""
        left, predictor = self.spec.frame_time, self.predictor
        while self._steps < MOST_STEPS and (cost := predictor.step_seconds()) <= left:
            left -= cost
            again = predictor.step()
            self._steps += 1
            if not again:
                break
        if self._steps and self._samples is not None:
            self._samples.set_last(edit.c, predictor.in_basis())

    def rollback(self) -> None:
        """Show again what was shown before the last frame, whose solve has failed."""
        super().rollback()
        self._last = None
        if self._left is not None:
            self._samples, self._left = self._left.samples, None

    def _set(self, values: Reals) -> None:
        self.predictor.set_mixed(values)

    def _expected_error(self, error: float, way: float) -> float:
        # Nearer than epsilon samples are not told apart.
        least = (self._samples.smoothing if self._samples is not None else self.spec.epsilon) * self.size
        return error * max(1.0, max(self.distance, least) / max(way, least)) ** 2

    @property
    def _mesh(self) -> tuple[int, int]:
        """Version of the mesh that fields live on."""
        mesh = self.moving.field_mesh
        return id(mesh), mesh.topology

    def _taken(self, edit: ScriptFrame, gesture: Gesture) -> Predicted | None:
        made, scene = self._samples or self._projected(edit), edit.scene
        again = made is None or made.gesture is not gesture or scene is not self._scene
        if made is None or again or not self._align(made):
            if not again:
                self.note = self.note or LEFT
            made = DragSamples(gesture, self.size, self.spec.epsilon, self.spec.samples)
            self._align(made)
        self._scene = scene
        if not made.knows(edit.c, self._mesh, rests=True):
            self._sample(edit, made)
        made.set_last(edit.c, self.predictor.values())
        self._samples, self._c = made, edit.c
        return made if len(made) else None

    def _leave(self, edit: ScriptFrame) -> LeftSamples | None:
        """The samples, whose nodes a frame takes elsewhere; None where there are none to go on with."""
        made, former, space, aligned = self._samples, self._former, self.analysis.space, self._aligned
        if made is None or not len(made) or former is None or space is None or aligned is None:
            return None
        return LeftSamples(made, self.predictor, aligned, space, edit, former) if can_be_projected(space) else None

    def _projected(self, edit: ScriptFrame) -> DragSamples | None:
        """The samples that were left in this frame, on the nodes of now; None where there are none."""
        left, self._left = self._left, None
        motion, space = self.moving.linear_motion, self.analysis.space
        if left is None or motion is None or space is None or motion.shape[1] != len(space.X):
            return None
        if left.samples.gesture is not edit.gesture or edit.scene is not self._scene:
            return None
        found = left.projected(space, motion)
        if found is None:
            return None
        self._aligned = found[1]
        return found[0]

    def _sample(self, edit: ScriptFrame, made: DragSamples) -> None:
        """Differentiate a frame that has been solved, and take it for a sample."""
        before = self.predictor.counted()
        s = self._derivatives(edit)
        self._time.note(DERIVATIVE, self.predictor.seconds_since(before))
        if s is None:
            self._stuck = True
            return
        values = self.predictor.values()
        if made.mesh not in (None, self._mesh) and self.rebases:
            made.rebase(edit.c, values, s)
        made.mesh = self._mesh
        made.add(SamplePlace(edit.c, edit.index, self._mesh), values, s)

    def _align(self, made: DragSamples) -> bool:
        """Bring samples to the basis of the last solution; returns whether they can be mixed with it."""
        before, self._aligned = self._aligned, self.predictor.values()
        if not len(made) or before is None:
            return not len(made)
        turned = self.predictor.alignment(before)
        if turned is not None:
            made.change(turned)
        return turned is not None
