"""A live session that plays a recording, until the hand takes over: then its scene is simulated."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from restshape.errors import UserError
from restshape.live import messages as page
from restshape.live.marks_beside import MarksBeside
from restshape.live.message_loop import MessageLoop, SessionEnd
from restshape.live.player_controls import PlayerControls
from restshape.report.field import true_scale
from restshape.report.goal_curves import goals_of

if TYPE_CHECKING:
    from restshape.interface.simulation import Predict
    from restshape.live.link import Link
    from restshape.live.live_simulation import Progress
    from restshape.live.moment import Moment
    from restshape.live.recording_player import RecordingPlayer
    from restshape.live.script_player import Watch

SIMULATE = "take the recording over first: then its scene is simulated"


class RecordingSession(MessageLoop):
    """Answers a page that looks at a recording.

    Args:
        link: to the server; recorded: what is played; out: name of the script's file, for people.

    Attributes:
        taken: number of the frame from which the hand goes on; None: it does not.
        at: number of the frame that is shown; frames: how many there are.
    """

    def __init__(self, link: Link, recorded: RecordingPlayer, out: str) -> None:
        super().__init__(link)
        self.taken: int | None = None
        self._recorded, self._out = recorded, out
        self.at, self.frames = recorded.at, recorded.frames
        self._controls = PlayerControls(self, self, recorded.text)
        self._beside = MarksBeside(recorded)
        self._sent: Moment | None = None
        controls: tuple[type[page.Message], ...] = (page.PlayMessage, page.PauseMessage, page.SeekMessage)
        answer: Callable[..., None] = self._controls.answer
        self.handlers |= {one: answer for one in (*controls, page.TakeMessage)}
        self.handlers[page.ShowMessage] = self._show
        refused = (page.EventMessage, page.RatesMessage, page.RecordMessage, page.StrikeMessage, page.SaveMessage)
        self.handlers |= {one: self._not_yet for one in refused}
        self.handlers[page.ResumeMessage] = self._resume

    def show(self, number: int, progress: Progress, interrupted: Watch) -> Moment:
        """What a page sees of a frame."""
        return self._recorded.show(number)

    def take(self, progress: Progress) -> None:
        """Makes sure that the recorded scene can be simulated.

        Raises:
            UserError: it cannot.
        """
        _ = self._recorded.script

    def predict(self, how: Predict) -> None:
        """Refuses it: frames are those that were recorded."""
        raise UserError("the frames are those that were recorded", do=SIMULATE)

    def forget(self) -> None:
        """Nothing: frames are read again each time."""

    def run(self) -> None:
        """Answers until the server ends the session, or the hand takes over."""
        try:
            super().run()
        finally:
            self._beside.close()

    def send(self, moment: Moment) -> None:
        """Shows a frame: with what the application says of it, where that is known."""
        self._sent, marks = moment, self._beside.of(moment.number)
        super().send(moment if marks is None else self._recorded.marked(moment, marks))

    def take_over(self) -> None:
        """Ends this part of the session."""
        self.taken = self.at
        raise SessionEnd

    def start(self) -> None:
        """Says what there is, and shows the first frame."""
        recorded, header = self._recorded, self._recorded.recording.header
        looks = recorded.looks.items()
        fields = [
            {"name": name, "label": one.label, "unit": one.unit, "signed": one.signed, "fromZero": one.from_zero}
            for name, one in looks
        ]
        said = {"type": "welcome", "scene": header.get("scene", ""), "app": header.get("app", ""), "role": "hand"}
        said |= {"dim": 3 if recorded.in_space else 2, "trueScale": true_scale(recorded.recording)}
        said |= {"goals": bool(goals_of(recorded.recording))}
        said |= {"fields": fields, "field": recorded.field, "numbers": [], "quantities": recorded.quantities()}
        said |= {"things": [], "events": {}, "script": self._controls.text, "player": True, "frames": recorded.frames}
        said |= {"predicts": ["none"], "predict": "none", "out": self._out, "recordable": False}
        self.say(said)
        self.send(recorded.show(0))

    def _resume(self, message: page.ResumeMessage) -> None:
        """Plays; where the hand has taken over before, that goes on."""
        if message.lines.strip():
            self._waiting.insert(0, message)
            raise SessionEnd
        if message.field in self._recorded.looks:
            self._recorded.field = message.field
        self.start()

    def idle(self) -> None:
        """Plays on, finds out what the application says of what is shown, or waits for a message."""
        if self._controls.playing:
            left = self._controls.go_on()
            if self._beside.took < left and self._beside.wants(self.at + 1):
                self._beside.step(self.at + 1)
            else:
                self.wait(left)
        elif self._beside.wants(self.at):
            self._beside.step(self.at)
            if self._sent is not None and self._beside.of(self.at) is not None:
                self.send(self._sent)
        else:
            self.wait(None)
        if why := self._beside.news():
            self.say({"type": "note", "message": f"of the recording, only what is in its file is shown: {why}"})

    def before(self, message: page.Message) -> None:
        """Nothing."""

    def recover(self, number: int, error: Exception) -> None:
        """Says that a frame cannot be read."""
        self.refuse(number, UserError(f"this frame cannot be shown: {error}", do="look at another one"))

    def _show(self, message: page.ShowMessage) -> None:
        if message.predict not in (None, "none"):
            self.predict("linear")
        if message.marks is not None:
            self._recorded.marks = message.marks
        if message.field is not None:
            if message.field not in self._recorded.looks:
                raise UserError(f"there is no field {message.field!r}", do=f"one of: {', '.join(self._recorded.looks)}")
            self._recorded.field = message.field
        self.send(self._recorded.show(self.at))

    def _not_yet(self, message: page.Message) -> None:
        raise UserError(f"a recording is played, and there is nothing to {message.type}", do=SIMULATE)
