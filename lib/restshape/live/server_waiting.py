"""Messages of the hand that wait for the simulating process: of those that the next one replaces, the last alone."""

from __future__ import annotations

import asyncio
from collections import deque
from typing import Any

Table = dict[str, Any]

MOST = 1_000
"""Messages that wait at most; what comes beyond is refused."""


class Waiting:
    """Messages in order; a later event of the same kind takes the place of one that may be left out."""

    def __init__(self) -> None:
        self._messages: deque[tuple[Table, str]] = deque()
        self._some = asyncio.Event()

    def __len__(self) -> int:
        """How many wait."""
        return len(self._messages)

    def add(self, message: Table, text: str) -> bool:
        """Takes a message, and its text; whether there was room."""
        if message.get("latest"):
            for k in reversed(range(len(self._messages))):
                before = self._messages[k][0]
                if not before.get("latest"):
                    break
                if kind_of(before) == kind_of(message):
                    del self._messages[k]
                    break
        if len(self._messages) >= MOST:
            return False
        self._messages.append((message, text))
        self._some.set()
        return True

    async def take(self) -> tuple[Table, str]:
        """The next one."""
        while not self._messages:
            self._some.clear()
            await self._some.wait()
        return self._messages.popleft()

    def clear(self) -> list[Table]:
        """Takes all that wait, which nobody will answer."""
        found = [message for message, _ in self._messages]
        self._messages.clear()
        return found


def kind_of(message: Table) -> tuple[object, ...]:
    """What two events have in common of which the later replaces the earlier."""
    event = message.get("event")
    return tuple(str(event.get(key)) for key in ("do", "on", "key")) if isinstance(event, dict) else (message["type"],)
