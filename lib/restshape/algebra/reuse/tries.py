"""When something that may fail is worth a try."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass
class Tries:
    """When a method that often fails is tried: after tries in vain 1, 3, 7 and 15 turns are left out.

    Args:
        vain: tries in a row; ahead: turns that are still left out.
    """

    vain: int = 0
    ahead: int = 0

    def left_out(self) -> bool:
        """Whether this turn is left out."""
        self.ahead -= 1
        return self.ahead >= 0

    def count(self, good: bool) -> None:
        """Take in how a try has ended."""
        self.vain = 0 if good else self.vain + 1
        self.ahead = min(2**self.vain - 1, 15)
