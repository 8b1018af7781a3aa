"""What the edit time between frames is spent on: work whose price by the calibration it pays for."""

from __future__ import annotations

ROUNDING = 1e-9
"""Seconds of edit time that are none."""


class IdleTime:
    """An account of edit time, from which counted work is paid.

    Frames in which nothing moves save up what a piece of work costs. One that cost more than was expected is paid for
    by the time that follows.

    Attributes:
        given, paid: seconds since the last frame, and of them those of work.
        done: names of what was done since the last frame.
    """

    def __init__(self) -> None:
        self.given = self.paid = self._balance = 0.0
        self.done: list[str] = []
        self._prices: dict[str, float] = {}

    def begin(self, seconds: float, fresh: bool) -> None:
        """A frame has come so many seconds after the last one; where the hand has moved in that, nothing is saved."""
        self.given, self.paid, self.done = (seconds if seconds > ROUNDING else 0.0), 0.0, []
        self._balance = (min(0.0, self._balance) if fresh else self._balance) + self.given

    def close(self) -> None:
        """Nothing can be done with the time that there was."""
        self.given = self.paid = self._balance = 0.0
        self.done = []

    def pays(self, work: str) -> bool:
        """Whether there is time for a piece of work, by what one cost last; the first one shows what it costs."""
        return self._prices.get(work, 0.0) <= self._balance and self._balance > 0.0

    def note(self, work: str, seconds: float) -> None:
        """Take in what a piece of work has cost, whatever it was paid from."""
        self._prices[work] = seconds

    def pay(self, work: str, seconds: float) -> None:
        """Pay for a piece of work that was done."""
        self.note(work, seconds)
        self._balance -= seconds
        self.paid += seconds
        self.done.append(work)
