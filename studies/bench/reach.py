"""A drag whose hole moves the nodes near it alone, beside the same drag that moves all of them."""

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from statistics import median

from restshape_studies.bench.job import Job, Row, run
from restshape_studies.bench.size import HOLE, SMALL_STEP, START, mesh_size, write_script
from restshape_studies.bench.turns import Announce, Play, in_turns, median_ratio

AREA, RADIUS = 2.0, 0.12
"""Of the plate without its hole [m^2], and of the hole [m]."""
TIMES = {"p50_ms": "ms", "cpu_p50_ms": "cpu_ms"}
"""Medians: of a frame's time, and of its processor's, which other work of the machine hardly lengthens."""
WHOLE, PART = "the whole", "with reach"


def reach_of(share: float) -> float:
    """The reach [m] from the hole of the plate within which that share of its area lies."""
    hole = math.pi * RADIUS**2
    return math.sqrt((hole + share * (AREA - hole)) / math.pi) - RADIUS


def study(
    scene: Path,
    unknowns: float,
    share: float,
    frames: int,
    repeat: int,
    folder: Path,
    policy: str = "auto",
    overrides: tuple[str, ...] = (),
    petsc: tuple[str, ...] = (),
    announce: Announce = lambda words: None,
    play: Play = run,
) -> Row:
    """A record with and without reach, as `bench reach --json` writes it; the two take turns.

    Args:
        scene: the plate.
        unknowns: about how many.
        share: of the nodes that move.
        frames: of the drag.
        repeat: runs of each.
        folder: for the script.
        policy: of reuse.
        overrides: ``key=value`` as after --set.
        petsc: words for PETSc's options database.
        announce: called with what comes next.
        play: runs a job.
    """
    x, y = START
    path = [{"do": "drag", "to": [x + SMALL_STEP * k, y]} for k in range(1, frames + 1)]
    events = [{"do": "press", "on": HOLE, "at": [x, y]}, *path]
    script = folder / "reach.jsonl"
    write_script(script, [{"t": round(k / 60, 6), **event} for k, event in enumerate(events)])
    job = Job(str(scene), str(script), policy, (*overrides, f"mesh.size={mesh_size(unknowns):.6g}"), petsc)
    reach = reach_of(share)
    jobs = {WHOLE: job, PART: replace(job, overrides=(*job.overrides, f"mesh.reach={reach:.6g}"))}
    runs = {key: [one.rows for one in found] for key, found in in_turns(HOLE, jobs, repeat, announce, play).items()}
    return {
        "reach": reach,
        "records": {key: record(found) for key, found in runs.items()},
        "ratios": {name: _ratio(runs, column) for name, column in TIMES.items()},
    }


def moved(rows: Sequence[Row]) -> list[Row]:
    """The frames of level 1; the first of a drag makes what the others keep."""
    return [row for row in rows if row["level"] == 1][1:]


def record(runs: Sequence[Sequence[Row]]) -> Row:
    """Medians over the frames of level 1 of all runs [ms], with their stages; of the press and the whole drag likewise.

    Args:
        runs: rows of each.
    """
    rows, first = [row for run in runs for row in moved(run)], runs[0]
    stages = [key for key in rows[0] if key.startswith("ms_")]
    return {
        "unknowns": first[0]["unknowns"],
        "frames": len(moved(first)),
        "iterations": sum(row["iterations"] for row in moved(first)) / len(moved(first)),
        **{name: median(_middle(one, column) for one in runs) for name, column in TIMES.items()},
        "press_ms": median(rows[1]["ms"] for rows in runs),
        "drag_ms": median(sum(row["ms"] for row in rows[1:]) for rows in runs),
        "stages": {key[3:]: median(row[key] for row in rows) for key in stages},
    }


def _middle(rows: Sequence[Row], column: str) -> float:
    """The median time [ms] of its frames of level 1."""
    return median(row[column] for row in moved(rows))


def _ratio(runs: dict[str, list[list[Row]]], column: str) -> float | None:
    whole, part = ([_middle(rows, column) for rows in runs[key]] for key in (WHOLE, PART))
    return median_ratio(whole, part)
