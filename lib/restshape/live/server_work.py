"""What the simulating process is at, and for how long: so that pages can say so, and offer to end it."""

from __future__ import annotations

import time
from typing import Any

Table = dict[str, Any]

STARTING = "the simulation starts"


class WorkInProgress:
    """The messages that were sent, and those that were answered.

    Attributes:
        what: is done: it starts, or what the last event does.
    """

    def __init__(self) -> None:
        self.what = STARTING
        self._since = self._begun = time.monotonic()
        self._sent: dict[int, bool] = {}
        self._starting = True

    def start(self) -> list[int]:
        """The process is another one; the numbers of messages that the one before has not answered."""
        left, self._sent, self._starting, self.what = list(self._sent), {}, True, STARTING
        self._since = self._begun = time.monotonic()
        return left

    def begin(self, message: Table) -> None:
        """A message goes to the process."""
        if not self._sent:
            self._since = self._begun = time.monotonic()
        event = message.get("event")
        if isinstance(event, dict):
            self.what = str(event.get("do"))
        elif not self._sent:
            # What is asked by the way is not what takes long.
            self.what = message["type"]
        self._sent[message["id"]] = isinstance(event, dict)

    def answer(self, number: int) -> None:
        """A message was answered, and with it all before it."""
        left = {one: event for one, event in self._sent.items() if one > number}
        self._since = time.monotonic()
        if len(left) < len(self._sent):
            self._begun = self._since
        self._sent = left

    def frame(self, number: int) -> None:
        """A frame has come, which answers a message; of the same event others may follow."""
        self._starting = False
        self.answer(number - 1 if self._sent.get(number) else number)

    def written(self, number: int) -> None:
        """The event of a message is over, and with it those before, which it has replaced; 0: of no message."""
        if number:
            self.answer(number)

    @property
    def busy(self) -> bool:
        """Whether something is not answered yet."""
        return self._starting or bool(self._sent)

    @property
    def has_shown(self) -> bool:
        """Whether frames of what it does have come already."""
        return self.busy and self._since > self._begun

    def seconds(self) -> float:
        """How long the process has been at what it does, with all frames of it."""
        return time.monotonic() - self._begun if self.busy else 0.0
