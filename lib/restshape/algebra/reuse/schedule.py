"""The best schedule of refreshes in hindsight."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass


@dataclass
class LastRefresh:
    """A preconditioner, and the best of all schedules whose last refresh it is.

    Args:
        frame: for whose matrix it was made.
        cost: of the schedule, up to the last frame that was taken in.
        before: the one before it in the schedule; None for the first.
    """

    frame: int
    cost: float
    before: LastRefresh | None


class Schedule:
    """The least cost of all schedules of refreshes, frame by frame: dynamic programming over the last refresh.

    Args:
        window: frames that a preconditioner is looked at for.
        slack: what a preconditioner may have cost beyond the best schedule, and still be looked at. At the cost of a
            refresh a younger one can take its place, which costs no more in the frames to come, but where a drag comes
            back.

    Attributes:
        frames: how many were taken in; the first of them always refreshes.
        kept: preconditioners that are still looked at, the oldest first.

    Source: docs/theory/levels-of-reuse.md.
    """

    def __init__(self, window: float = math.inf, slack: float = math.inf) -> None:
        self.window, self.slack = window, slack
        self.frames, self.kept = 0, list[LastRefresh]()

    def add(self, refresh: Callable[[int], float], cost: Callable[[int], float]) -> None:
        """Take in the next frame.

        Args:
            refresh: cost of a refresh in it, after one in frame i; in frame 0 after none, given 0.
            cost: of the frame with the preconditioner of frame i; inf where that is of no use.
        """
        frame = self.frames
        ways = [(one.cost + refresh(one.frame), one) for one in self.kept]
        spent, before = min(ways, key=lambda way: way[0]) if ways else (refresh(0), None)
        kept = [one for one in self.kept if frame - one.frame < self.window]
        kept.append(LastRefresh(frame, spent, before))
        for one in kept:
            one.cost += cost(one.frame)
        most = min(one.cost for one in kept) + self.slack
        # The youngest stays, whatever it costs: none may be of use.
        self.kept = [one for one in kept if one.cost <= most or one.frame == frame]
        self.frames += 1

    def best(self) -> tuple[float, list[int]]:
        """The least cost of all schedules, and the frames in which it refreshes."""
        if not self.kept:
            return 0.0, []
        least = min(self.kept, key=lambda one: one.cost)
        refreshes, at = [least.frame], least.before
        while at:
            refreshes.append(at.frame)
            at = at.before
        return least.cost, refreshes[::-1]
