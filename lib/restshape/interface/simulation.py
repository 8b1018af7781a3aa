"""A simulation that a program holds: it does what edit scripts do, and writes down what it has done."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from math import inf
from types import TracebackType
from typing import TYPE_CHECKING, Literal, Self

from restshape.errors import Refusal, UserError
from restshape.interface.edits import Edits
from restshape.interface.frame_loop import frame_loop
from restshape.interface.hand import Hand
from restshape.interface.scripts import When, WrittenScript, refuse_names
from restshape.interface.shown_frame import LastAnswer, ShownFrame
from restshape.replay.request import Measured, Request
from restshape.scene.edit_script import Script
from restshape.scene.model import Scene

if TYPE_CHECKING:
    from restshape.analysis.row_values import RowValues
    from restshape.calibration import Calibration
    from restshape.replay.loop import Replay
    from restshape.replay.recording.recorder import Recorder

Predict = Literal["none", "linear", "gmls"]


class RefusedFrame(UserError):
    """An event was refused: its frame shows the shape, or the answer, of before, and the edit can go on from there.

    Args:
        frame: the refused one.
    """

    def __init__(self, frame: ShownFrame) -> None:
        self.frame = frame
        place = f"frame {frame.index}, {frame.row['event']!r} in line {frame.row['line']} of the script"
        why = frame.row["refused"]
        what, do = (why.what, why.do) if isinstance(why, Refusal) else (frame.refused, "")
        super().__init__(what, place, do)


class Simulation(Edits):
    """A scene under the hand of a program, made by `restshape.open`; close it, or use it in a ``with`` statement.

    It goes through the same frame loop as `restshape replay`: `script` holds what was done, and its replay gives the
    same rows, bit for bit but for times. Several simulations may be open at a time, in one thread.

    Args:
        scene: where it starts.
        analysis: "on demand" leaves frames unsolved until `analyse`.
        policy: what is reused from frame to frame; None: as the scene says.
        guess: initial guess of iterative solves; None: the policy's best.
        predict: how frames of a drag are predicted.
        strict: a refused event raises; else its frame says so in `ShownFrame.refused`, and the program goes on.
        recorder: takes each frame, on the first rank; None records nothing.
        calibration: seconds a unit of counted work; None: the nominal ones.
        petsc: words for PETSc's options database, which it has taken already.
        measured: "all", "residual" or "nothing": what is known of each answer besides, off the frame's time.

    Attributes:
        frame: the last one; closed: no event can come any more.
        shown: what those who show its frames keep from one to the next.

    Raises:
        UserError: the scene cannot be simulated, or not be predicted.
    """

    def __init__(
        self,
        scene: Scene,
        analysis: When = "every frame",
        policy: str | None = None,
        guess: str | None = None,
        predict: Predict = "none",
        strict: bool = True,
        recorder: Recorder | None = None,
        calibration: Calibration | None = None,
        petsc: Sequence[str] = (),
        measured: Measured = "all",
    ) -> None:
        refuse_names(scene, "load")
        self._written = WrittenScript(scene, analysis)
        script = self._written.script()
        request = Request.of(scene, script, policy, guess, calibration, petsc, predict, measured=measured)
        self._replay = frame_loop(request, recorder)
        self._answer = LastAnswer(self._replay, request)
        self._strict, self.closed = strict, False
        self.shown: dict[object, object] = {}
        self._rows: Iterator[RowValues] = self._replay.answers(iter([self._replay.session.first()]))
        self.frame = next(self._frames())

    @property
    def scene(self) -> Scene:
        """The scene with the values that hold now; the shape as it was edited is in `ShownFrame.mesh`, not here."""
        return self._replay.session.scene

    @property
    def replay(self) -> Replay:
        """What computes the frames, for what shows more of them: it may be read, and never changed."""
        return self._replay

    @property
    def script(self) -> Script:
        """What was done, as a script that `save_script` writes; that of a closed simulation stays."""
        return self._written.script()

    @property
    def written(self) -> WrittenScript:
        """The script of what was done, which grows."""
        return self._written

    @property
    def request(self) -> Request:
        """What is computed, and how."""
        return self._answer.request

    @property
    def t(self) -> float:
        """Edit time [s] at which the next event begins, unless it has a `t` of its own: 60 frames are a second."""
        return self._written.t

    def do(self, do: str, /, **keys: object) -> ShownFrame:
        """Carries out an event of edit scripts, also one that an application has of its own; its last frame.

        Args:
            do: what happens, as in a script.
            keys: of the event, None for those that are left out; one that is a word of Python, such as "from" or "as",
                has the name of its field in the event's model (`start`, `counted`).

        Raises:
            UserError: the event is not valid, or cannot come now: nothing has happened.
            RefusedFrame: it was refused, and the simulation is strict.
        """
        for _ in self.each(do, **keys):
            pass
        return self.frame

    def move(self, to: list[object]) -> ShownFrame:
        """Moves what the hand holds to a place, as `do` of a drag to it would, but with less to look at on the way.

        Args:
            to: its two or three coordinates [m]; errors as of `do`.
        """
        if not self._moves(to):
            return self.do("drag", to=to)
        self._finish()
        if self._strict and self.frame.row["refused"]:
            raise RefusedFrame(self.frame)
        return self.frame

    def moving(self, to: list[object]) -> Iterator[ShownFrame]:
        """Moves what the hand holds, as `move` does; its one frame as soon as it is computed, as of `each`."""
        return self._frames() if self._moves(to) else self.each("drag", to=to)

    def _moves(self, to: list[object]) -> bool:
        """Begins the motion of a hand to another place, where it is one that goes on."""
        self._finish()
        event = self._written.moved_on(to)
        if event is None:
            return False
        self._rows = self._replay.answers(self._replay.session.frames_of(event))
        return True

    def each(self, do: str, /, **keys: object) -> Iterator[ShownFrame]:
        """Carries out an event; each of its frames as soon as it is computed.

        Those that nobody has asked for are computed before the next event, or when the simulation is closed.

        Args:
            do, keys: as of `do`, with the same errors.
        """
        self._finish()
        event = self._written.add(do, keys)
        self._rows = self._replay.answers(self._replay.session.frames_of(event))
        return self._frames()

    def follow(self, table: Mapping[str, object], room: float = inf) -> Iterator[ShownFrame]:
        """Carries out an event of another script, at its own time; frames and errors as of `each`.

        Args:
            table: its keys, as `WrittenScript.follow` takes them; room: edit time [s] that it has to the next one.
        """
        self._finish()
        event = self._written.follow(table)
        self._rows = self._replay.answers(self._replay.session.frames_of(event, room))
        return self._frames()

    def stop(self, frames: int, path: Sequence[Sequence[float]] = ()) -> bool:
        """Ends the last event after those of its frames that were asked for, where it can end there.

        Args:
            frames, path: as of `WrittenScript.cut_last`.

        Returns:
            Whether it has ended; else its frames go on.
        """
        if self._written.last_frames == frames:
            # What the session does after the last frame of an event belongs to it.
            self._finish()
            return True
        if not self._written.cut_last(frames, path):
            return False
        self._rows = iter(())
        return True

    def _frames(self) -> Iterator[ShownFrame]:
        """The frames that are left of the event."""
        try:
            for row in self._rows:
                self.frame = frame = self._answer.frame(row)
                if frame.row["refused"] and self._strict:
                    raise RefusedFrame(frame)
                yield frame
        except (RefusedFrame, GeneratorExit):
            raise
        except BaseException:
            self._break_off()
            raise

    def _finish(self) -> None:
        """Computes what is left of the last event."""
        if self.closed:
            raise UserError("the simulation is closed", do="open it again: restshape.open(scene)")
        try:
            for row in self._rows:
                self.frame = self._answer.frame(row)
        except BaseException:
            self._break_off()
            raise

    def _break_off(self) -> None:
        """Closes the simulation in the middle of a frame, whose event the script does not have."""
        self._answer.closed = self.closed = True
        if self._answer.count:
            self._written.drop_last()

    def _grab(self, do: str, **keys: object) -> Hand:
        try:
            return Hand(self, self.do(do, **keys))
        except RefusedFrame:
            # The hand holds nothing, and scripts let go of that, too: which is refused as well.
            with suppress(RefusedFrame):
                self.do("release")
            raise

    def _repr_png_(self) -> bytes | None:
        """The last frame as `restshape report` draws it, for notebooks; None where it draws none."""
        return self.frame._repr_png_()

    def abandon(self) -> None:
        """Ends the simulation without the frames that are left of its last event."""
        self._rows = iter(())
        self._answer.closed = self.closed = True

    def close(self) -> None:
        """Ends the simulation; its last frame can still be read."""
        if not self.closed:
            self._finish()
            self.frame.keep()
            self._answer.closed = self.closed = True

    def __enter__(self) -> Self:
        """The simulation."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Closes it."""
        self.close()


def open(
    scene: Scene,
    analysis: When = "every frame",
    policy: str | None = None,
    guess: str | None = None,
    predict: Predict = "none",
    strict: bool = True,
    measured: Measured = "all",
) -> Simulation:
    """A simulation of a scene, after its first frame; arguments and errors as of `Simulation`."""
    return Simulation(scene, analysis, policy, guess, predict, strict, measured=measured)
