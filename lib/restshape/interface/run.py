"""A replay that runs: its frames, and what is written, compared and summed up on the way."""

# More than 15 modules: frames, and all that may be written and said of them, meet here.

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from contextlib import nullcontext
from pathlib import Path

from petsc4py import PETSc

from restshape.analysis.row_values import RowValues
from restshape.errors import UserError
from restshape.interface.frame_loop import frame_loop
from restshape.interface.shown_frame import LastAnswer, ShownFrame
from restshape.replay.chosen_frames import ChosenFrames
from restshape.replay.columns import columns_of
from restshape.replay.event_counts import begin_log
from restshape.replay.field_names import check_field_names
from restshape.replay.first_steps import FirstSteps
from restshape.replay.frame_counts import FrameCounts
from restshape.replay.parity import Parity
from restshape.replay.petsc_options import refusal
from restshape.replay.recording.recorder import Recorder
from restshape.replay.recording.row_table import table_of_rows
from restshape.replay.request import Request
from restshape.replay.rounding import load_scales
from restshape.replay.tally import Summary, Tally
from restshape.scene.plan import solved_physics
from restshape.shape.protocol import Session
from restshape.surroundings import petsc_options


class AgreedInterrupt(KeyboardInterrupt):
    """All ranks have agreed to end after this frame: none of them waits for another."""


class Run(Iterator[ShownFrame]):
    """The frames of a script on all ranks of PETSc's world, each as soon as it is computed.

    `restshape.replay` gives it to programs, and `restshape replay` goes through it. A refused frame says so in
    `ShownFrame.refused`; what is written is whole when the last frame has been taken, or the run is closed.

    Args:
        request: what is replayed.
        recorder: takes each frame; on rank 0 only.
        closes: the run closes the recorder at its end; else who made it does.
        parity: compare each frame with a cold solve on the same mesh.
        csv: file for a row of numbers a frame.
        summed: there will be a `summary`, which takes its time of each frame.
        keep_rows: `summary` gives all `rows`; else those alone that the report of the application needs.
        say: takes a line of what the first frame is at, where that takes long.
        answer: what frames are read from, of a replay that has run before; None: a new one.
        chosen: the frames that are solved for; None: all.
        counted: frames have `counts` of what they have done.
        comm: whose ranks share the work; None: PETSc's world.

    Attributes:
        replay: the frame loop that computes it, for who looks at the analysis behind the frames.

    Raises:
        UserError: the scene cannot be simulated, not be predicted, or a file cannot be written.
    """

    def __init__(
        self,
        request: Request,
        recorder: Recorder | None = None,
        closes: bool = False,
        parity: bool = False,
        csv: Path | None = None,
        summed: bool = True,
        keep_rows: bool = False,
        say: Callable[[str], None] | None = None,
        answer: LastAnswer | None = None,
        chosen: ChosenFrames | None = None,
        counted: bool = False,
        comm: PETSc.Comm | None = None,
    ) -> None:
        self._request, self._comm = request, comm or PETSc.COMM_WORLD
        self._to_close = recorder if closes else None
        if counted:
            begin_log()
        self._answer = answer or LastAnswer(frame_loop(request, recorder, self._comm), request)
        self.replay = replay = self._answer.replay
        if recorder:
            recorder.add_header(_surroundings(self._comm) | {"singular": dict(replay.errors.singular.ever)})
        self._check = Parity(replay) if parity else None
        units = {name: quantity.unit for name, quantity in request.scene.quantities.items()}
        self._tally = Tally(units, load_scales(request.scene)) if summed else None
        self._rows = list[RowValues]()
        self._ends, self._interrupted = list[RowValues](), False
        self._keep = summed and (keep_rows or request.application.report is not None)
        edits = replay.session.frames()
        answers = replay.answers(chosen.among(edits) if chosen else edits)
        self._counts = FrameCounts(replay) if counted else None
        answers = self._counts.over(answers) if self._counts else answers
        rows = answers if answer else self._answers(answers, say)
        self._frames = self._computed(rows, csv if self._comm.rank == 0 else None)

    def __next__(self) -> ShownFrame:
        """The next frame.

        Raises:
            UserError: the scene cannot be simulated, or a file cannot be written.
        """
        return next(self._frames)

    def rows(self) -> Iterator[RowValues]:
        """The row of each frame that is left, as soon as it is computed; errors as of the frames."""
        return (frame.row for frame in self)

    def close(self) -> None:
        """Ends the run where it is: what was written so far is whole."""
        self._frames.close()
        if self._to_close:
            # Where no frame was asked for, nothing has begun that would end.
            self._to_close.close("interrupted")

    def to_end(self, on_frame: Callable[[], None] | None = None) -> Summary:
        """Computes all frames that are left; the summary.

        Args:
            on_frame: called after each frame; an interrupt, on several ranks an `AgreedInterrupt`, ends the run, of
                which the summary says so.

        Raises:
            UserError: the scene cannot be simulated, or a file cannot be written.
        """
        try:
            for _ in self:
                if on_frame:
                    on_frame()
        except KeyboardInterrupt as interrupt:
            # Else the other ranks know nothing of it, and one that waits for this one cannot be determined.
            if (self._comm.size > 1 and not isinstance(interrupt, AgreedInterrupt)) or not self._answer.count:
                raise
            self._interrupted = True
        finally:
            self.close()
        return self.summary()

    def summary(self) -> Summary:
        """What there is to say of the frames so far, by key, as `restshape replay --json` writes it.

        Raises:
            UserError: the run is not summed up.
        """
        tally, request, replay = self._tally, self._request, self.replay
        if tally is None:
            raise UserError("this run is not summed up", do="restshape.replay(scene, script, summed=True)")
        found = tally.summary(request.policy.name, replay.comm.size, replay.analysis.estimated_quantity)
        found |= {"reasons": tally.reasons, "largest_residual": tally.largest_residual, "guess": request.policy.guess}
        found |= {"singular": replay.errors.singular.ever} | replay.errors.linear_theory.summary()
        if request.application.report:
            found |= request.application.report.summarised(self._rows)
        found |= {"ends": self._ends, "interrupted": self._interrupted, "rows": self._rows}
        return found | {"parity": self._check.summary()} if self._check else found

    def follow(self, session: Session, request: Request) -> Run:
        """The run of another session, which goes on with the solvers of this one; neither is summed up or written.

        Of frames of this run nothing can be read any more but what was read before.

        Args:
            session: its first frame says what changes from the last one of this run.
            request: what is replayed in it.

        Raises:
            UserError: errors of quantities cannot be estimated.
        """
        self._answer.closed = True
        self.replay.follow(session, request)
        return Run(request, summed=False, answer=LastAnswer(self.replay, request))

    def _computed(self, rows: Iterator[RowValues], csv: Path | None) -> Generator[ShownFrame, None, None]:
        """Each frame, when it is written and summed up."""
        asked = self._request
        names = list(columns_of(asked.scene, asked.application, asked.predict)) if csv else []
        with self._to_close or nullcontext(), table_of_rows(csv, names) as table:
            for row in rows:
                if self._check:
                    row |= self._check()
                if self._tally:
                    self._tally.add(row)
                self._ends = [*self._ends[:1], row]
                if self._keep:
                    self._rows.append(row)
                if table:
                    table(row)
                yield self._answer.frame(row, self._counts.last if self._counts else None)

    def _answers(self, rows: Iterator[RowValues], say: Callable[[str], None] | None) -> Iterator[RowValues]:
        """The rows of all frames; where PETSc fails in the first one, what it says against the user's words."""
        replay, request = self.replay, self._request
        steps = FirstSteps(replay, say) if say else None
        try:
            first = next(rows)
            if steps:
                steps.end()
            if request.measured == "all":
                physics = solved_physics(request.scene, request.application)
                check_field_names(replay.analysis, replay.solver.space, physics)
            yield first
        except PETSc.Error as error:
            # On several ranks the others may not have failed.
            if not request.petsc or self._comm.size > 1:
                raise
            raise refusal(error, request.petsc) from error
        yield from rows


def _surroundings(comm: PETSc.Comm) -> dict[str, object]:
    """What a header says of ranks and PETSc."""
    version = list(PETSc.Sys.getVersion())
    return {"ranks": comm.size, "petsc": version, "petsc_in_effect": petsc_options()}
