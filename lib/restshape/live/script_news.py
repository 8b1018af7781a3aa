"""What a script has gained, as pages hear it: they show its lines, which nobody reads as fast as a hand makes them."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from typing import Any

PACE = 0.1
"""Seconds between two words of it at least."""


class ScriptNews:
    """Gathers lines of the script.

    Args:
        report: says something to all pages.
    """

    def __init__(self, report: Callable[[Mapping[str, object]], None]) -> None:
        self._report = report
        self._said: dict[str, Any] = {}
        self._timer: asyncio.TimerHandle | None = None
        self._when = 0.0

    def add(self, written: Mapping[str, Any]) -> None:
        """Takes what the simulating process says; pages hear it at once, or with what follows soon."""
        self._said = {**written, "lines": self._said.get("lines", "") + written["lines"]}
        if self._timer is None:
            loop = asyncio.get_running_loop()
            self._timer = loop.call_at(max(self._when + PACE, loop.time()), self.say)

    def say(self) -> None:
        """Says what was not said yet."""
        said = self._said
        self.forget()
        if said:
            self._report(said)
            self._when = asyncio.get_running_loop().time()

    def forget(self) -> None:
        """What was not said is not said any more."""
        self._said = {}
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
