"""What an application says of the frames of a recording: its scene is simulated beside it, as far as it is played."""

from __future__ import annotations

import traceback
from math import isclose, isnan
from statistics import median
from time import monotonic
from typing import TYPE_CHECKING

import numpy as np

from restshape.analysis.row_values import number as number_in
from restshape.application import application_of
from restshape.errors import UserError
from restshape.live.live_simulation import LiveSimulation, SolvedBy, quiet
from restshape.live.moment import Moment
from restshape.live.played_events import played_events
from restshape.live.script_player import ScriptPlayer
from restshape.replay.columns import quantity_column
from restshape.report.tables import quantity_scales

if TYPE_CHECKING:
    from collections.abc import Sequence

    from restshape.live.recording_player import RecordingPlayer
    from restshape.live.shown_marks import Mark

LONG = 0.5
"""Seconds of a frame, in the mean, from which on the page would wait for too long."""
BEGINNING = 5.0
"""Seconds of the first frame from which on messages of the page would wait for too long: nothing interrupts it."""
FEW = 5
"""Frames after which their mean is known."""
ALIKE = 1e-6
"""Part of a quantity, or of the size that it has in the recording, by which a frame that is computed again may differ:
solvers stop at a tolerance, and what symmetry cancels is rounding."""
HAND = "take the recording over: then its scene is simulated"


class MarksBeside:
    """Computes the marks of a recording's frames one after the other.

    Args:
        recorded: what is played.

    Attributes:
        why_not: why no more of them can be had; empty: they can.
        took: seconds of the last frame; before the first one more than there is between two that are played.
    """

    def __init__(self, recorded: RecordingPlayer) -> None:
        self._recorded = recorded
        self._live: LiveSimulation | None = None
        self._player: ScriptPlayer | None = None
        self.why_not, self.took = "", LONG
        self._reported = False
        self._spent, self._count = 0.0, 0
        self._sizes: dict[str, float] = {}

    def of(self, number: int) -> Sequence[Mark] | None:
        """The marks of a frame; None where they are not known."""
        if self._player is not None and (found := self._player.kept(number)) is not None:
            return found.marks
        return None

    def news(self) -> str:
        """Why no more of them can be had, once; else empty."""
        if not self.why_not or self._reported:
            return ""
        self._reported = True
        return self.why_not

    def wants(self, number: int) -> bool:
        """Whether there is something to compute on the way to a frame."""
        return not self.why_not and self.of(number) is None

    def step(self, number: int) -> None:
        """Computes one frame on the way to another one; what goes wrong is said by `why_not`."""
        begun, opens = monotonic(), self._player is None
        try:
            if self._player is None:
                self._player = self._opened()
            else:
                before = self._player.computed
                self._player.show(number, quiet, lambda: True)
                if before == self._player.computed < number:
                    raise UserError("the recorded script ends before this frame", do=HAND)
            self._compare()
        except UserError as error:
            self._give_up(f"{error.what}; {error.do}" if error.do else error.what)
        # Whatever fails beside the recording, the recording can be looked at.
        except Exception as error:
            traceback.print_exc()
            self._give_up(f"{type(error).__name__}: {error}")
        self.took = 0.0 if opens else monotonic() - begun
        self._spent, self._count = self._spent + self.took, self._count + 1
        if self._player is not None and self._count > FEW and self._spent > LONG * self._count:
            self._give_up(f"a frame takes {self._spent / self._count:.1f} s; {HAND}")

    def _opened(self) -> ScriptPlayer:
        recorded = self._recorded
        if not application_of(recorded.scene).marks.shown:
            self._reported = True
            raise UserError("this application has no marks")
        times = recorded.recording.table.get("ms", np.zeros(0))
        if len(times) and (usual := 1e-3 * median(times.tolist())) > LONG:
            raise UserError(f"a frame took {usual:.1f} s", do=HAND)
        if len(times) and (first := 1e-3 * float(times[0])) > BEGINNING:
            raise UserError(f"its first frame took {first:.1f} s", do=HAND)
        self._sizes = quantity_scales(recorded.recording)
        events = played_events(recorded.script)
        live = self._live = LiveSimulation(recorded.scene, SolvedBy(recorded.policy), recorded.predict)

        def moment() -> Moment:
            frame = live.sim.frame
            marks = live.application.marked(live.sim)
            return Moment({"number": frame.index}, (), marks, float(str(frame.row["t"])))  # type: ignore[arg-type]

        return ScriptPlayer(live, events, moment)

    def _compare(self) -> None:
        """Makes sure that the frame that was computed last is the recorded one.

        Raises:
            UserError: it is another one, as of another version.
        """
        assert self._live is not None
        frame, recording = self._live.sim.frame, self._recorded.recording
        X = self._live.sim.replay.solver.space.X
        recorded = recording.points(frame.index)
        same = len(X) == len(recorded) and str(frame.row["refused"]) == str(recording.table["refused"][frame.index])
        same = same and np.allclose(X, recorded[:, : X.shape[1]], rtol=0.0, atol=ALIKE * (np.ptp(X) or 1.0))
        for name, size in self._sizes.items() if same else ():
            column = quantity_column(name)
            one, other = number_in(frame.row, column), float(recording.table[column][frame.index])
            alike = isclose(one, other, rel_tol=ALIKE, abs_tol=ALIKE * size)
            same = same and (alike or (isnan(one) and isnan(other)))
        if not same:
            raise UserError(f"frame {frame.index} of this scene is another one now than when it was recorded", do=HAND)

    def _give_up(self, why: str) -> None:
        self.close()
        self.why_not = why

    def close(self) -> None:
        """Ends the simulation."""
        if self._live is not None:
            self._live.close()
        self._live = self._player = None
