"""Takes the messages of a page one after the other, merges those that wait, and lets each be answered."""

from __future__ import annotations

import traceback
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from time import monotonic
from typing import TYPE_CHECKING

from restshape.errors import UserError
from restshape.live import messages as page
from restshape.live.frame_message import FrameEncoder
from restshape.live.json_text import json_bytes
from restshape.live.link import Link, LinkClosed

if TYPE_CHECKING:
    from restshape.live.live_simulation import Progress
    from restshape.live.moment import Moment

OFTEN = 0.2
"""Seconds between two words of progress."""


class SessionEnd(Exception):
    """Who answers the messages has ended."""


class MessageLoop(ABC):
    """Answers the messages of a page.

    Args:
        link: to the server.

    Attributes:
        handlers: what answers each type of message; those of other types are done at once.
    """

    def __init__(self, link: Link) -> None:
        self.link = link
        self.handlers: dict[type[page.Message], Callable[..., None]] = {page.EndMessage: self._finish}
        self._waiting: list[page.Message] = []
        self._encoder = FrameEncoder()
        self._answered = 0

    def follow(self, other: MessageLoop) -> None:
        """Answers what another loop has not."""
        self._waiting, self._answered = other._waiting, other._answered

    @property
    def has_more(self) -> bool:
        """Whether messages were taken that nobody has answered."""
        return bool(self._waiting)

    def run(self) -> None:
        """Answers until the server ends the session, or this part of it is over."""
        try:
            while True:
                self.next()
        except (LinkClosed, SessionEnd):
            return

    def next(self) -> None:
        """Answers a message; without any, goes on with what goes on by itself."""
        if self.waits():
            self._answer(self._waiting.pop(0))
        else:
            self.idle()

    @abstractmethod
    def idle(self) -> None:
        """What is done while no message waits: something, or waiting for one."""

    @abstractmethod
    def before(self, message: page.Message) -> None:
        """What is done before a message is answered."""

    @property
    def interrupted(self) -> bool:
        """Whether the last fault was in the middle of a frame, after which nothing can be computed."""
        return False

    @abstractmethod
    def recover(self, number: int, error: Exception) -> None:
        """Goes on after a fault in the answer to a message of a number."""

    def wait(self, seconds: float | None) -> None:
        """Waits for a message, so many seconds at most; None: as long as it takes."""
        content = self.link.receive(seconds)
        if content is not None:
            self._take(content)

    def waits(self) -> bool:
        """Whether there is a message to answer."""
        for content in self.link.waiting():
            self._take(content)
        return bool(self._waiting)

    def _take(self, content: str | bytes) -> None:
        """Lets a message wait; one that is none is answered at once."""
        try:
            page.merged(self._waiting, page.read(content))
        except page.MalformedMessage as error:
            self.refuse(error.id, UserError(str(error), "a message of the page", "load the page again"))

    def _answer(self, message: page.Message) -> None:
        """Does what a message asks for."""
        self._answered = max(self._answered, message.id)
        handler = self.handlers.get(type(message), self.done)
        try:
            self.before(message)
            handler(message)
        except UserError as error:
            if self.interrupted:
                self.recover(message.id, error)
            else:
                self.refuse(message.id, error)
        except (LinkClosed, SessionEnd):
            raise
        # A fault in one frame must not end the session.
        except Exception as error:
            traceback.print_exc()
            self.recover(message.id, error)

    def refuse(self, number: int, error: UserError) -> None:
        """Says why a message was not carried out."""
        said = {"message": error.what, "place": error.where, "todo": error.do}
        self.say({"type": "refused", "id": number, **said})

    def done(self, message: page.Message) -> None:
        """Says that a message was carried out, for what has no other answer."""
        self.say({"type": "done", "id": message.id})

    def _finish(self, message: page.Message) -> None:
        raise SessionEnd

    def say(self, message: Mapping[str, object]) -> None:
        """Sends a message of text."""
        self.link.send(json_bytes(message))

    def send(self, moment: Moment) -> None:
        """Shows a frame."""
        self.link.send_binary(self._encoder(moment.header, moment.parts, moment.marks, self._answered))

    def send_all_again(self) -> None:
        """The next frame has all parts."""
        self._encoder.forget()

    def progress(self, what: str) -> Progress:
        """What says from time to time how far a long piece of work is."""
        start = said = monotonic()

        def progress(done: int, of: int) -> None:
            nonlocal said
            if monotonic() - said > OFTEN:
                said = monotonic()
                self.say({"type": "busy", "seconds": said - start, "what": f"{what}: {done} of {of}"})

        return progress
