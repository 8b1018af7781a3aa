"""A frame of each level at growing size: a plate whose hole is dragged, on one core."""

import json
import math
import time
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from restshape_studies.bench.job import Job, Outcome, Row, run

from restshape.replay.summary import percentiles

PLATE_UNKNOWNS, PLATE_SIZE = 1820.0, 0.052
"""Unknowns of the plate at a mesh size [m], to be scaled by the square of the size; boundaries count little."""
HOLE, START = "window", (0.4, 0.5)
LARGE = 2e5
"""Unknowns above which the first frame serves as the level-3 frame and fewer frames are measured."""
SMALL_STEP, APPROACH_STEP, FLIP_STEP = 0.002, 0.03, 0.004
"""Steps of the hole [m]: of level 1, on the way to where triangles are of low quality, and there."""
APPROACH_FRAMES, FLIP_FRAMES = 9, 60
JUMP = 0.8
"""Steps of level 3 [m]: 40 % of the domain, so that triangles are inverted."""


def sizes(least: float, most: float, points: int) -> list[float]:
    """Numbers of unknowns, evenly spread on a logarithmic scale."""
    return [float(n) for n in np.geomspace(least, most, points)]


def mesh_size(unknowns: float) -> float:
    """The mesh size [m] at which the plate has about so many unknowns."""
    return PLATE_SIZE * math.sqrt(PLATE_UNKNOWNS / unknowns)


def drag(unknowns: float) -> tuple[list[dict[str, Any]], list[str]]:
    """Events of an edit script, and the phase of each frame, the first shape's included.

    Small steps give level 1; jumps give level 3, where the size is not too large; then the hole is brought to where
    triangles are about to be of low quality, and in small steps from there on some frames are of level 2.
    """
    small, jumps = (20, 4 if unknowns < LARGE / 5 else 2) if unknowns < LARGE else (6, 0)
    x, y = START
    path = [("small", x + SMALL_STEP * k) for k in range(1, small + 1)]
    path += [("jump", x + JUMP * (1 - k % 2)) for k in range(jumps)]
    # A gesture of its own, whose map is made on the mesh as it lies then.
    again = x if jumps else path[-1][1]
    way = [("approach", again + APPROACH_STEP * k) for k in range(1, APPROACH_FRAMES + 1)]
    way += [("flip", way[-1][1] + FLIP_STEP * k) for k in range(1, FLIP_FRAMES + 1)]
    events = [{"do": "press", "on": HOLE, "at": [x, y]}, *({"do": "drag", "to": [at, y]} for _, at in path)]
    events += [{"do": "release"}, {"do": "press", "on": HOLE, "at": [again, y]}]
    events += [{"do": "drag", "to": [at, y]} for _, at in way]
    phases = ["first", "press", *(name for name, _ in path), "release", "press", *(name for name, _ in way)]
    return [{"t": round(k / 60, 6), **event} for k, event in enumerate(events)], phases


def write_script(path: Path, events: Iterable[dict[str, Any]]) -> None:
    """Writes an edit script."""
    header = {"format": "restshape-edits", "version": 1, "units": "m"}
    path.write_text("".join(json.dumps(line) + "\n" for line in (header, *events)), encoding="utf-8")


def measure(
    scene: Path,
    unknowns: Sequence[float],
    folder: Path,
    seconds: float,
    policy: str = "auto",
    overrides: tuple[str, ...] = (),
    petsc: tuple[str, ...] = (),
    on_run: Callable[[str], None] = lambda words: None,
    play: Callable[[Job, float], Outcome] = run,
) -> list[Row]:
    """A record a size, as `bench size --json` writes it.

    Args:
        scene: the plate.
        unknowns: about how many, one size each, ascending.
        folder: for the scripts.
        seconds: for all sizes together; what has no time any more is reported in the record's `problem`.
        policy: of reuse.
        overrides: ``key=value`` as after --set.
        petsc: words for PETSc's options database.
        on_run: called with what comes next.
        play: runs a job for at most so many seconds.
    """
    end, found = time.monotonic() + seconds, []
    for n in unknowns:
        events, phases = drag(n)
        script = folder / f"drag-{n:.0f}.jsonl"
        write_script(script, events)
        on_run(f"about {n:,.0f} unknowns")
        own = (*overrides, f"mesh.size={mesh_size(n):.6g}")
        job = Job(str(scene), str(script), policy, own, petsc, enough={"2": 5 if n < LARGE else 3})
        left = end - time.monotonic()
        outcome = play(job, left) if left > 1 else Outcome([], "no time was left")
        found.append(size_record(n, outcome, phases))
    return found


def size_record(wanted: float, outcome: Outcome, phases: Sequence[str]) -> Row:
    """What one size gave: times of each level, stages, memory.

    Args:
        wanted: number of unknowns asked for.
        outcome: of the replay.
        phases: of each frame.
    """
    rows = [{**row, "phase": phase} for row, phase in zip(outcome.rows, phases)]
    chosen = {
        "1": [row for row in rows if row["phase"] == "small" and row["level"] == 1],
        "1_old": [row for row in rows if row["phase"] == "flip" and row["level"] == 1],
        "2": [row for row in rows if row["phase"] == "flip" and row["level"] == 2],
        "3": [row for row in rows if row["phase"] == "jump" and row["level"] == 3],
    }
    first_serves = not chosen["3"] and bool(rows) and wanted >= LARGE
    if first_serves:
        chosen["3"] = rows[:1]
    problem = outcome.problem or ("" if chosen["2"] else "no frame was of level 2")
    return {
        "wanted": wanted,
        "unknowns": rows[0]["unknowns"] if rows else None,
        "elements": rows[0]["elements"] if rows else None,
        "levels": {name: level_record(some) for name, some in chosen.items()},
        "first_frame_ms": rows[0]["ms"] if rows else None,
        "first_frame_serves_as_level_3": first_serves,
        "memory_mb": max((row["rss_mb"] for row in rows), default=None),
        "problem": problem,
    }


def level_record(rows: Sequence[Row]) -> Row | None:
    """Times, iterations and stages (medians) of the frames of a level; None without frames."""
    if not rows:
        return None
    stages = [key for key in rows[0] if key.startswith("ms_")]
    return {
        "frames": len(rows),
        "ms": percentiles(np.array([row["ms"] for row in rows])),
        "iterations": float(np.mean([row["iterations"] for row in rows])),
        "refreshes": int(sum(row["pc_rebuilt"] for row in rows)),
        "stages": {key[3:]: float(np.median([row[key] for row in rows])) for key in stages},
    }


def exponents(records: Sequence[Row]) -> dict[str, Row | None]:
    """For each level p and the coefficient c [ms] of time = c unknowns^p, by least squares over the upper half."""
    return {level: _exponent(records, level) for level in ("1", "2", "3")}


def _exponent(records: Sequence[Row], level: str) -> Row | None:
    """The fit of one level; None with fewer than two sizes."""
    points = [(r["unknowns"], r["levels"][level]["ms"]["p50"]) for r in records if r["levels"][level]]
    upper = points[len(points) // 2 :] if len(points) > 2 else points
    if len(upper) < 2:
        return None
    x, y = np.log(np.array(upper)).T
    p, c = np.polyfit(x, y, 1)
    return {"exponent": float(p), "coefficient_ms": float(np.exp(c)), "points": len(upper)}
