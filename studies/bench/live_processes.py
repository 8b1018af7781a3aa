"""Processor time of the processes of a live session, and of all others on the machine, from Linux's /proc."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from pathlib import Path

PROC = Path("/proc")
KINDS = {
    "restshape.live.worker": "simulating process",
    "--type=renderer": "renderer",
    "--type=gpu-process": "GPU process",
    "--type=": "browser",
    "chromium": "browser",
    "playwright": "driver",
}
"""What the words of a process have in them, and what it is; the first that fits counts."""
IDLE = (3, 4)
"""Columns of /proc/stat in which nothing runs."""


@dataclass(frozen=True)
class Spent:
    """Seconds of the processor so far.

    Args:
        by: kind of process; elsewhere: of processes that do not belong to the session.
    """

    by: dict[str, float]
    elsewhere: float

    def since(self, before: Spent) -> Spent:
        """What was spent after another time."""
        by = {kind: seconds - before.by.get(kind, 0.0) for kind, seconds in self.by.items()}
        return Spent(by, max(self.elsewhere - before.elsewhere, 0.0))


def spent(roots: dict[int, str]) -> Spent:
    """What was spent by processes and all their descendants.

    Args:
        roots: what each process is that its words do not tell, by its number.
    """
    tick = os.sysconf("SC_CLK_TCK")
    numbers = [int(path.name) for path in PROC.iterdir() if path.name.isdecimal()]
    known = {number: stat for number in numbers if (stat := _stat(number))}
    by: dict[str, float] = {}
    for number, (_, ticks) in known.items():
        root = number
        while root not in roots and root in known:
            root = known[root][0]
        if root in roots:
            kind = roots[number] if number in roots else kind_of(words_of(number))
            by[kind] = by.get(kind, 0.0) + ticks / tick
    busy = sum(ticks for column, ticks in enumerate(_machine()) if column not in IDLE) / tick
    return Spent(by, busy - sum(by.values()))


def kind_of(words: str) -> str:
    """What a process is, by the words that it was started with."""
    return next((kind for part, kind in KINDS.items() if part in words), "driver")


def words_of(number: int) -> str:
    """The words that a process was started with; none where it has ended."""
    try:
        return (PROC / str(number) / "cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace")
    except OSError:
        return ""


def _stat(number: int) -> tuple[int, int] | None:
    """The parent of a process, and its ticks of the processor; None where it has ended."""
    try:
        fields = (PROC / str(number) / "stat").read_text(errors="replace").rpartition(")")[2].split()
    except OSError:
        return None
    return int(fields[1]), int(fields[11]) + int(fields[12])


def _machine() -> list[int]:
    """Ticks of all processors by what they did, without those of guests, which are counted twice."""
    line = re.match(r"cpu +([\d ]+)", (PROC / "stat").read_text())
    return [int(one) for one in line.group(1).split()[:8]] if line else []
