"""Answers the messages of a page with frames, one after the other.

Source: docs/live-protocol.md.
"""

# More than 15 modules: what a session may ask for is answered here.

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from time import monotonic
from typing import TYPE_CHECKING, cast

from restshape.analysis.row_values import number as number_in
from restshape.errors import UserError
from restshape.live import messages as page
from restshape.live.frame_arrays import MessageBody
from restshape.live.gesture_numbers import Gestures
from restshape.live.json_text import json_bytes, json_text
from restshape.live.link import ENDED_BY_HAND, Link, LinkClosed
from restshape.live.mark_messages import placed
from restshape.live.message_loop import MessageLoop
from restshape.live.moment import Moment
from restshape.live.moved_marks import MovedMarks
from restshape.live.player_controls import PlayerControls
from restshape.live.shown_marks import Mark, Tone, shown_with
from restshape.live.welcome import SessionWords

if TYPE_CHECKING:
    from restshape.live.growing_script import GrowingScript
    from restshape.live.live_recording import LiveRecording
    from restshape.live.live_simulation import Event, LiveSimulation

ASIDE = (page.SaveMessage, page.RatesMessage)
"""Messages beside which what comes to rest goes on."""
MOST_REST = 5_000
"""Frames in which cloth goes on by itself, at most, after something was done."""
MOST_RUN = 100_000
"""Frames in which time goes on by itself, at most, after something was done."""
PACE = 1 / 60
"""Seconds between two frames in which time goes on, at least: those of edit time."""


class Worker(MessageLoop):
    """Answers the messages of a page, one after the other.

    Args:
        link: to the server; live: what is simulated.
        file: of the script; recording: of the frames.
    """

    def __init__(self, link: Link, live: LiveSimulation, file: GrowingScript, recording: LiveRecording) -> None:
        super().__init__(link)
        self.live, self.file, self.recording = live, file, recording
        self.words = SessionWords(live)
        self.player: PlayerControls | None = None
        self._rested = 0
        self._marks, self._moved_marks = True, MovedMarks()
        self._due: float | None = None
        self._gestures = Gestures(live)
        self.handlers |= {
            page.EventMessage: self._event,
            page.ShowMessage: self._show,
            page.RatesMessage: self._rates,
            page.SaveMessage: self._save,
            page.RunMessage: self._run,
            page.RecordMessage: self._record,
            page.RestartMessage: self._restart,
            page.StrikeMessage: self._strike,
            page.ResumeMessage: self._resume,
            page.PlayMessage: self._control,
            page.PauseMessage: self._control,
            page.SeekMessage: self._control,
            page.TakeMessage: self._control,
        }

    def run(self) -> None:
        """Answers until the server ends the session; what was done is written down."""
        super().run()
        self.live.stop()
        self._write()
        self.file.write()

    def start(self) -> None:
        """Says what there is, and shows it."""
        if self.player is None:
            self._begin_file()
        self._greet()

    def _greet(self) -> None:
        self.welcome()
        self.send(self.moment())

    def _begin_file(self) -> None:
        """Has the file hold the session so far."""
        self.file.begin(self.live.sim.written.header_line(), self.live.all_lines())

    def idle(self) -> None:
        """Goes on with what goes on by itself, or waits for a message."""
        later = self._say_changes()
        if self.player is not None and self.player.playing:
            self.wait(self.player.go_on())
        elif self._due is not None:
            self._go_on_in_time(self._due)
        elif self.player is None and not self.live.settled and self._rested < MOST_REST:
            self._rest()
        else:
            self.end_rest()
            self.wait(later)

    def before(self, message: page.Message) -> None:
        """What comes to rest by itself does so no more."""
        if not isinstance(message, ASIDE):
            self.end_rest()
        self._rested = 0

    @property
    def interrupted(self) -> bool:
        """Whether the simulation ended in the middle of a frame."""
        return self.live.sim.closed

    def recover(self, number: int, error: Exception) -> None:
        """Goes on after a fault, from the state before the event in which it was."""
        name = "" if isinstance(error, UserError) else f"{type(error).__name__}: "
        what = f"the frame failed: {name}{error}"
        if self.live.recorder is not None and self.live.recorder.failed:
            self.recording.give_up(self.live)
        if self.interrupted:
            self.say({"type": "lost", "message": what, "restarting": True})
            self._begin_again()
        self.refuse(number, UserError(what, do="it was left out; try something else"))
        self.send(self.moment())

    def _event(self, message: page.EventMessage) -> None:
        if self.player is not None:
            raise UserError("a script is played, and the hand holds nothing", do="take the script over first")
        self._carry_out(self._gestures.numbered(message))
        if self.live.missed:
            self._carry_out({"do": "release"}, str(self.live.sim.frame.row["refused"]))

    def _carry_out(self, event: Event, missed: str = "") -> None:
        """Carries an event out; `missed`: why the press before it was refused, whose frame pages may not have seen."""
        self.live.begin(event)
        live = self.live
        while live.step is not None and live.go_on():
            if live.shared and self._cancelled():
                return
            # What is shown is written down before.
            live.finish()
            self._write(self._answered, with_next=True)
            moment = self.moment()
            if missed:
                moment.header["missed"] = missed
            self.send(moment)
            self._end_early()
        if live.lines:
            self._write(self._answered)

    def _cancelled(self) -> bool:
        """Goes on from before the event where the server, which does not end several ranks, has passed on a cancel."""
        with suppress(LinkClosed):
            self.waits()
        cancels = [number for number, one in enumerate(self._waiting) if isinstance(one, page.CancelMessage)]
        if not cancels:
            return False
        self.say({"type": "lost", "message": ENDED_BY_HAND, "restarting": True})
        left, self._waiting = self._waiting[: cancels[0]], self._waiting[cancels[0] :]
        for number in (self._answered, *(message.id for message in left)):
            self.refuse(number, UserError(ENDED_BY_HAND))
        self._begin_again()
        self.send(self.moment())
        return True

    def _end_early(self) -> None:
        """Ends the event after this frame if the session ends, and the event can end there."""
        if self.live.step is None:
            return
        try:
            self.waits()
        except LinkClosed:
            if self.live.stop():
                raise

    def _write(self, number: int = 0, with_next: bool = False) -> None:
        """Writes down what has been done, and tells the server: at once, or with the next message.

        Args:
            number: of the message whose event it is; 0: of none.
        """
        if not self.live.lines:
            return
        lines = self.live.take_lines()
        if self.player is not None:
            return
        for line in lines:
            self._to_file(partial(self.file.add, line))
        self._say_written(lines, number, with_next)

    def _to_file(self, write: Callable[[], object]) -> None:
        """Has the script's file written; a disk that has no room ends no session: what is missing is written later."""
        known = self.file.lacks_lines
        try:
            write()
        except UserError as error:
            if not known:
                self.say({"type": "note", "message": str(error)})

    def _say_written(self, lines: Sequence[str], number: int = 0, with_next: bool = False) -> None:
        text = json_text("\n".join([*lines, ""]))
        message = f'{{"type":"written","id":{number},"lines":{text},"count":{self.file.count}}}'.encode()
        (self.link.send_with_next if with_next else self.link.send)(message)

    def _rest(self) -> None:
        """One more frame of what comes to rest by itself."""
        live = self.live
        if live.step is None:
            live.rest()
        live.go_on()
        self._rested += 1
        if line := live.rest_so_far():
            self.file.add_for_now(line)
            self.link.send_with_next(json_bytes({"type": "resting", "line": f"{line}\n"}))
        self.send(self.moment())

    def _run(self, message: page.RunMessage) -> None:
        """Lets time go on while nothing else happens, or stand still."""
        if message.on and self.player is not None:
            raise UserError("a script is played, and time goes on with it", do="take the script over first")
        if message.on and not self.live.application.transient(self.live.scene):
            raise UserError("nothing in this scene goes on in time", do="use a scene with dynamics, or steps in time")
        self._due = monotonic() if message.on else None
        self.send(self.moment())
        self.done(message)

    def _go_on_in_time(self, due: float) -> None:
        """One more frame of what goes on in time, once it is due."""
        if (early := due - monotonic()) > 0.0:
            self.wait(early)
            return
        self._due = monotonic() + PACE if self._rested < MOST_RUN else None
        self._rest()

    def end_rest(self) -> None:
        """What came to rest by itself is one event, which is over."""
        if self.player is None and self.live.step is not None:
            self.live.stop()
            self._write()

    def _show(self, message: page.ShowMessage) -> None:
        live, changed = self.live, False
        if message.field is not None and message.field != live.picture.field:
            live.picture.show(message.field)
            changed = True
        if message.marks is not None and message.marks != self._marks:
            self._marks, changed = message.marks, True
        progress = self.progress("frames are computed again")
        if message.predict is not None and message.predict != live.predict:
            if self.player is not None:
                self.player.predict(message.predict)
            else:
                live.reopen(live.all_lines(), message.predict, progress)
                self._to_file(self._begin_file)
        if self.player is not None:
            self.player.show_again(changed)
        else:
            self.send(self.moment())

    def _rates(self, message: page.RatesMessage) -> None:
        units = {name: one.unit for name, one in self.live.scene.quantities.items()}
        rates = self.live.rates(message.of)
        self.say({"type": "rates", "id": message.id, "of": message.of, "rates": rates, "units": units})

    def _save(self, message: page.SaveMessage) -> None:
        if not self.file.name:
            raise UserError("no file was named for the script", do="start restshape live with --out SCRIPT")
        self.file.write()
        said = {"events": self.file.count, "options": self.live.options}
        self.say({"type": "saved", "id": message.id, "path": self.file.name, **said})

    def _record(self, message: page.RecordMessage) -> None:
        if self.player is not None:
            raise UserError("a script is played, which is not recorded", do="take the script over first")
        self.recording.switch(message.on, self.live, self.progress("frames are recorded"))
        self.send(self.moment())
        self.done(message)

    def _strike(self, message: page.StrikeMessage) -> None:
        tone = self.live.application.struck(self.live.sim, message.at)
        if not isinstance(tone, Tone):
            raise UserError("what is simulated has no tone", do="strike a shape whose modes are computed")
        (moved,) = MovedMarks()([tone], self.live.picture.parts())
        self.say({"type": "struck", "id": message.id, "tone": placed(moved, MessageBody())})

    def _restart(self, message: page.Message) -> None:
        self._begin_again()
        self.send(self.moment())
        self.done(message)

    def _begin_again(self) -> None:
        """Computes all events that have ended again; the next frame has all parts."""
        self.live.reopen(self.live.all_lines(), self.live.predict, self.progress("frames are computed again"))
        self.send_all_again()

    def _resume(self, message: page.ResumeMessage) -> None:
        lines = [line for line in message.lines.splitlines() if '"do"' in line]
        if lines:
            self.player = None
            self.live.reopen(lines, message.predict or self.live.predict, self.progress("what was done is done again"))
        if message.field is not None and message.field in self.live.picture.choice.looks:
            self.live.picture.show(message.field)
        if self.player is None:
            self._to_file(self._begin_file)
        self._greet()

    def _control(self, message: page.Message) -> None:
        if self.player is None:
            raise UserError("no script is played", do="start restshape live with --edits SCRIPT")
        self.player.answer(message)

    def take_over(self) -> None:
        """The hand goes on from where the player is: the script so far is written down."""
        self.player = None
        self.live.take_lines()
        self._to_file(self._begin_file)
        self._say_written(self.live.all_lines())
        # With a welcome a page begins with an empty picture.
        self.welcome()
        self.send_all_again()
        self.send(self.moment())

    def welcome(self) -> None:
        """Says what a page must know of the session."""
        player = self.player
        said = {"out": self.file.name, "recordable": self.recording.possible, "player": player is not None}
        script = {"script": player.text if player else "", "frames": player.frames if player else 0}
        self.say(self.words.welcome(said | script))

    def _say_changes(self) -> float | None:
        """Says what has changed, but not too often; in how many seconds it is to be said, None where all was."""
        if forms := self.words.forms():
            self.say(forms)
        if self.player is not None:
            return None
        if (early := self.words.due()) is None and (changed := self.words.changed()):
            self.say(changed)
        return early

    def moment(self) -> Moment:
        """What a page sees of the last frame."""
        live, sim, picture = self.live, self.live.sim, self.live.picture
        row, scene = sim.frame.row, sim.scene
        header = self.words.headers(row, scene, live.hand)
        if self._due is not None:
            header["runs"] = True
        if live.recorder is not None:
            header["records"] = True
        marks: Sequence[Mark] = ()
        if self._marks:
            marks = cast("Sequence[Mark]", live.application.marked(sim))
        parts = picture.parts()
        return Moment(header, parts, self._moved_marks(shown_with(marks, picture.mode), parts), number_in(row, "t"))
