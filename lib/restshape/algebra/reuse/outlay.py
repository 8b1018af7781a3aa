"""What the preconditioner of a system has cost by counted work, beside what the next best one is expected to cost."""

from typing import NamedTuple

from restshape.algebra.reuse.candidates import Candidate

FEW = 4
"""Solves that are counted on a system before its preconditioner may be left for another one."""


class Rival(NamedTuple):
    """The next best candidate of a system.

    Args:
        candidate: which one.
        cost: seconds of a solve that it is expected to cost.
        setup: seconds until it has been made.
    """

    candidate: Candidate
    cost: float
    setup: float


class Outlay:
    """Rent or buy between candidates: one is left once it has cost a set-up of its rival more than that would have.

    All seconds are those of the calibration, by counted work.

    Attributes:
        rival: None: there is no other.
        spent: seconds of all that was counted since the candidate was chosen, but for its first set-up.
        solves: since then.

    Source: docs/theory/levels-of-reuse.md.
    """

    def __init__(self) -> None:
        self.begin(None)

    def begin(self, rival: Rival | None) -> None:
        """Take in that a candidate has been chosen for a system, and which one is the next best."""
        self.rival, self.spent, self.solves = rival, 0.0, 0

    def refresh(self, seconds: float) -> None:
        """Take in that the preconditioner has been made once more."""
        self.spent += seconds

    def solve(self, seconds: float) -> None:
        """Take in a solve."""
        self.spent += seconds
        self.solves += 1

    @property
    def exceeded(self) -> bool:
        """Whether the rival would be cheaper by now, its set-up included."""
        rival = self.rival
        return rival is not None and self.solves >= FEW and self.spent >= rival.setup + self.solves * rival.cost
