"""Timed replays that take turns, each in a process of its own: a slow spell of the machine meets all of them."""

import math
import os
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from restshape_studies.bench.job import Job, Outcome, Row

from restshape.errors import UserError

Play = Callable[[Job], Outcome]
Announce = Callable[[str], None]


class OutOfTime(UserError):
    """No run of a scene has come to its end in the time that it has; other scenes may."""


@dataclass(frozen=True)
class Case:
    """One scene with one script.

    Args:
        name: of the scene, for people.
        scene: scene file.
        edits: edit script; None where there is none.
    """

    name: str
    scene: Path
    edits: Path | None


@dataclass(frozen=True)
class Run:
    """One replay.

    Args:
        rows: of its frames.
        load: of the machine before it.
    """

    rows: list[Row]
    load: float


def in_turns(
    name: str, jobs: Mapping[str, Job], repeat: int, announce: Announce, play: Play, seconds: float = math.inf
) -> dict[str, tuple[Run, ...]]:
    """The runs of each job by its key, `repeat` of them, or as many turns as begin within the seconds; one at least.

    Args:
        name: of the scene, for people; jobs: by what varies.
        announce: called with what comes next; play: runs a job.
        seconds: after which no other turn begins.

    Raises:
        UserError: a replay does not come to its end.
    """
    runs: dict[str, list[Run]] = {key: [] for key in jobs}
    begun = time.monotonic()
    for turn in range(repeat):
        if turn and time.monotonic() - begun >= seconds:
            break
        for key, job in jobs.items():
            announce(f"{name}: {key}, run {turn + 1} of {repeat}")
            load = os.getloadavg()[0]
            runs[key].append(Run(rows_of(play(job), job), load))
    return {key: tuple(found) for key, found in runs.items()}


def median_ratio(over: Sequence[float], under: Sequence[float]) -> float | None:
    """The median over the turns of a number over another one of the same turn; None where that is always 0."""
    found = [a / b for a, b in zip(over, under, strict=True) if b]
    return median(found) if found else None


def rows_of(outcome: Outcome, job: Job) -> list[Row]:
    """The rows of a run that came to its end.

    Raises:
        UserError: it did not.
    """
    if outcome.problem or not outcome.rows:
        what = f"policy {job.policy}: the replay {outcome.problem or 'gave no frames'}"
        edits = f" --edits {job.edits}" if job.edits else ""
        raise UserError(what, job.scene, f"restshape replay {job.scene}{edits} --policy {job.policy}")
    return outcome.rows


def found_of(outcome: Outcome, job: Job) -> Row:
    """What a run has measured in place of its frames' times.

    Raises:
        UserError: nothing.
    """
    if outcome.found is None:
        raise UserError(outcome.problem or "nothing was measured", job.scene, "see restshape replay on it")
    return outcome.found
