"""How far a command is: a bar on a terminal; elsewhere a line every ten seconds, with the total and the time left."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from time import monotonic
from typing import TYPE_CHECKING, Protocol

from restshape.errors import UserError

if TYPE_CHECKING:
    from rich.progress import Progress as RichProgress

EVERY = 10.0
"""Seconds between lines where there is no terminal."""
OTHERWISE = "RESTSHAPE_PROGRESS"
"""Variable of the environment that holds another number of seconds."""


class Advance(Protocol):
    """Counts steps."""

    def __call__(self, steps: int) -> None:
        """Counts so many steps; 0 shows that there is life."""

    def say(self, text: str) -> None:
        """Shows a line at once."""


class ProgressLines:
    """Writes a line to stderr now and then.

    Args:
        what: steps are, in the plural.
        total: steps in all; 0: nobody knows.
        clock: seconds, for the time between lines and the time left.

    Raises:
        UserError: the environment asks for no number of seconds.
    """

    def __init__(self, what: str, total: int, clock: Callable[[], float] = monotonic) -> None:
        self.what, self.total, self.clock = what, total, clock
        self.every = _seconds_between()
        self.done, self._first = 0, 0
        self._start = self._last = clock()

    def __call__(self, steps: int) -> None:
        """Counts steps, and writes a line where the last one is old enough."""
        self.done += steps
        now = self.clock()
        if not self._first and self.done:
            # The first step makes what the others go on with: it says nothing of their time.
            self._first, self._start = self.done, now
        if now - self._last < self.every:
            return
        self.say(self.line(now))

    def say(self, text: str) -> None:
        """Writes a line now."""
        self._last = self.clock()
        # A replay goes on although nobody reads how far it is.
        with suppress(BrokenPipeError):
            print(text, file=sys.stderr, flush=True)

    def line(self, now: float) -> str:
        """How far it is at a time [s]."""
        if not self.total:
            return f"{self.done} {self.what}"
        known = self.done - self._first
        left = f", about {duration((now - self._start) / known * (self.total - self.done))} left" if known else ""
        return f"{self.done} of {self.total} {self.what}{left}"


def _seconds_between() -> float:
    """Seconds between lines."""
    try:
        return max(float(os.environ.get(OTHERWISE, EVERY)), 0.0)
    except ValueError as error:
        what = f"{os.environ[OTHERWISE]!r} is no number of seconds"
        raise UserError(what, f"{OTHERWISE} in the environment", f"{OTHERWISE}=10") from error


def duration(seconds: float) -> str:
    """A time in words: 42 s, 3 min 20 s, 2 h 5 min."""
    whole = round(max(seconds, 0.0))
    if whole < 60:
        return f"{whole} s"
    minutes, rest = divmod(whole, 60)
    return f"{minutes} min {rest} s" if minutes < 60 else f"{minutes // 60} h {minutes % 60} min"


class _Silent:
    """Shows nothing."""

    def __call__(self, steps: int) -> None:
        pass

    def say(self, text: str) -> None:
        pass


class _Bar:
    """A bar on a terminal."""

    def __init__(self, bar: RichProgress, what: str, total: int) -> None:
        self._bar, self._task = bar, bar.add_task(what, total=total or None)

    def __call__(self, steps: int) -> None:
        self._bar.advance(self._task, steps)

    def say(self, text: str) -> None:
        self._bar.console.print(text, markup=False, highlight=False)


@contextmanager
def progress(quiet: bool, total: int, what: str = "frames") -> Iterator[Advance]:
    """What counts steps, and shows how many of all are done and how much time is left.

    Args:
        quiet: show nothing.
        total: steps in all; 0: nobody knows.
        what: they are, in the plural.
    """
    if quiet:
        yield _Silent()
    elif sys.stderr.isatty():
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

        from restshape.cli.console import Output

        layout = (TextColumn(what), BarColumn(), MofNCompleteColumn(), TextColumn("left"), TimeRemainingColumn())
        with Progress(*layout, console=Output(stderr=True), transient=True, refresh_per_second=4) as bar:
            yield _Bar(bar, what, total)
    else:
        yield ProgressLines(what, total)
