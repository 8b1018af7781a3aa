"""Policies side by side on the same edits, interleaved, each replay in a process of its own."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from statistics import median
from typing import Any

import numpy as np
from restshape_studies.bench.job import STOPPED, Job, Row, run
from restshape_studies.bench.turns import Announce, Case, OutOfTime, Play, in_turns, median_ratio, rows_of

from restshape.replay.columns import STAGES
from restshape.replay.summary import percentiles, summarise
from restshape.replay.tally import beside

BASES = ("rebuild", "refactor")
"""Policies that the others are compared with."""
LEVELS = ("1", "2", "3", "still")
"""Kinds of frames that solve: by what happens to the mesh, and those in which it rests, as in time."""
MOVES = "moves"
"""All frames in which the mesh moves, by whatever level."""


@dataclass(frozen=True)
class Plan:
    """How cases are replayed.

    Args:
        policies: names, in the order in which they take turns.
        repeat: timed runs of each policy.
        frames: of each script, the first included; None for all.
        overrides: ``key=value`` as after --set.
        petsc: words for PETSc's options database.
        seconds: of a scene, after which no other turn begins; a policy that takes longer by itself is left out.
    """

    policies: tuple[str, ...]
    repeat: int = 3
    frames: int | None = None
    overrides: tuple[str, ...] = ()
    petsc: tuple[str, ...] = ()
    seconds: float = math.inf


def compare(case: Case, plan: Plan, announce: Announce, play: Play = run) -> Row:
    """Policy -> its record, as `bench reuse --json` writes it.

    Each policy is replayed once with PETSc's events counted, which also warms the machine's caches, then `repeat` times
    with the clock, the policies taking turns so that a slow spell of the machine meets all of them. Those with their
    own guess are replayed as often with errors and jumps estimated as a replay does by itself (`solve.estimate`).

    Each record says how many `turns` were asked for, and which policies were `left_out`, and why.

    Raises:
        OutOfTime: no policy ends within the seconds.
        UserError: the scene or the script cannot be replayed.
    """
    jobs = {
        name: Job(str(case.scene), str(case.edits), name, plan.overrides, plan.petsc, plan.frames)
        for name in plan.policies
    }
    limit = None if math.isinf(plan.seconds) else plan.seconds
    counted, left_out = {}, {}
    for name, job in jobs.items():
        announce(f"{case.name}: {name}, counted")
        outcome = play(replace(job, count=True, seconds=limit))
        if outcome.problem.startswith(STOPPED):
            left_out[name] = outcome.problem
        else:
            counted[name] = rows_of(outcome, job)
    jobs = {name: job for name, job in jobs.items() if name in counted}
    if not jobs:
        raise OutOfTime(f"no policy ends within {plan.seconds:g} s", str(case.scene), "give more --seconds")
    runs = {
        name: [{"load": run.load, **timed(run.rows)} for run in turns]
        for name, turns in in_turns(case.name, jobs, plan.repeat, announce, play, plan.seconds).items()
    }
    found = {name: record(counted[name], name, runs[name]) for name in jobs}
    own = {name: replace(job, estimate=True) for name, job in jobs.items() if ":" not in name}
    what = f"{case.name}, errors estimated"
    for name, turns in in_turns(what, own, plan.repeat, announce, play, plan.seconds).items():
        found[name]["estimated"] = medians([whole(run.rows) for run in turns])
    for name, entry in found.items():
        entry |= {"turns": plan.repeat, "left_out": left_out}
        entry["ratios"] = {base: ratios(runs[name], runs[base]) for base in bases_of(name) if base in runs}
    return found


def bases_of(name: str) -> tuple[str, ...]:
    """What a policy is compared with: the others with the best guesses, and those with the guess that it names."""
    guess = name.partition(":")[2]
    same = [f"{base}:{guess}" for base in BASES if guess]
    return tuple(base for base in (*BASES, *same) if base != name)


def kind_of(row: Row) -> str:
    """Which of `LEVELS` a frame is; empty where nothing had to be solved."""
    return str(row["level"]) if row["level"] else "still" if row["iterations"] else ""


def solved(rows: Sequence[Row], kind: str = "") -> list[Row]:
    """The frames that were solved, or those of a kind, without the first one."""
    if kind == MOVES:
        return [row for row in rows[1:] if row["level"]]
    return [row for row in rows[1:] if (kind_of(row) == kind if kind else kind_of(row))]


def answered(row: Row) -> float:
    """Milliseconds until the answer of a frame is known."""
    return row["ms"] - beside(row)


def frames_a_second(rows: Sequence[Row]) -> float:
    """Solved frames over the seconds until their answers; 0 without any. The first frame is left out."""
    times = [answered(row) for row in solved(rows)]
    return 1e3 * len(times) / sum(times) if times else 0.0


def timed(rows: Sequence[Row]) -> Row:
    """What the clock reported of one run."""
    kinds = {"all": solved(rows), MOVES: solved(rows, MOVES), **{kind: solved(rows, kind) for kind in LEVELS}}
    ms = {kind: percentiles(np.array([answered(row) for row in some])) for kind, some in kinds.items()}
    return {
        "fps": frames_a_second(rows),
        "ms": ms,
        "whole": whole(rows),
        "python_ms": {"p50": middle(kinds["all"], "ms_python"), "1": middle(kinds["1"], "ms_python")},
        "stages": {name: sum(row[f"ms_{name}"] for row in rows) for name in STAGES},
        "stages_by_level": {kind: stage_medians(kinds[kind]) for kind in LEVELS},
    }


def whole(rows: Sequence[Row]) -> dict[str, float]:
    """All that frames cost, with what is done after their answers: residual, and estimates where they are made.

    Returns: p50 [ms] of solved frames and how many of them a second; session_s, seconds of all frames but the first.
    """
    times = [row["ms"] for row in solved(rows)]
    session = sum(row["ms"] for row in rows[1:])
    fps = 1e3 * len(times) / sum(times) if times else 0.0
    return {"p50": median(times) if times else 0.0, "fps": fps, "session_s": 1e-3 * session}


def middle(rows: Sequence[Row], column: str) -> float:
    """The median of a column; 0 without frames."""
    return median(row[column] for row in rows) if rows else 0.0


def stage_medians(rows: Sequence[Row]) -> dict[str, float]:
    """The median time [ms] of each stage over frames; zeros without frames."""
    return {name: middle(rows, f"ms_{name}") for name in (*STAGES, "python")}


def record(counted: list[Row], policy: str, runs: Sequence[Row]) -> Row:
    """The record of a policy: medians over its runs of what the clock reported, and what was counted."""
    summary = summarise(counted, policy, 1)
    middle = {
        "fps": median(run["fps"] for run in runs),
        "ms": medians([run["ms"]["all"] for run in runs]),
        "ms_by_level": {level: medians([run["ms"][level] for run in runs]) for level in LEVELS},
        "moves": {"frames": len(solved(counted, MOVES)), **medians([run["ms"][MOVES] for run in runs])},
        "whole": medians([run["whole"] for run in runs]),
        "python_ms": medians([run["python_ms"] for run in runs]),
        "stages": medians([run["stages"] for run in runs]),
        "stages_by_level": {level: medians([run["stages_by_level"][level] for run in runs]) for level in LEVELS},
        "levels": {kind: len(solved(counted, kind)) for kind in LEVELS},
        "idle": len(counted) - 1 - len(solved(counted)),
    }
    counts = {
        key: summary[key]
        for key in (
            "frames",
            "refused",
            "iterations",
            "refreshes",
            "unknowns",
            "elements",
            "preconditioners",
        )
    }
    spread = [{"load": run["load"], "fps": run["fps"], "p50": run["ms"]["all"]["p50"]} for run in runs]
    return {**middle, **counts, **event_totals(counted), "runs": spread}


def medians(runs: Sequence[dict[str, float]]) -> dict[str, float]:
    """The median over runs of each number."""
    return {key: median(run[key] for run in runs) for key in runs[0]}


def ratios(runs: Sequence[Row], base: Sequence[Row]) -> dict[str, float | None]:
    """How many times as fast as the base's: in frames a second and in the median frame.

    The runs of one turn are compared, and the median over the turns is taken; None where nothing moved.
    """

    def middle(of: Sequence[Row]) -> list[float]:
        return [run["ms"]["all"]["p50"] for run in of]

    fps = median_ratio([run["fps"] for run in runs], [run["fps"] for run in base])
    return {"fps": fps, "p50": median_ratio(middle(base), middle(runs))}


def event_totals(rows: Sequence[Row]) -> dict[str, Any]:
    """Counts of PETSc's events over a replay, and by level without the first frame."""
    names = list(rows[0]["events"])
    by_level = {
        str(level): {name: sum(row["events"][name] for row in rows[1:] if row["level"] == level) for name in names}
        for level in (0, 1, 2, 3)
    }
    return {"events": {name: sum(row["events"][name] for row in rows) for name in names}, "events_by_level": by_level}
