"""The same edits on one rank of MPI, two, four: times by stage and level, beside what the machine's memory allows."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import sqrt
from statistics import mean, median

from restshape_studies.bench.job import Job, Outcome, Row
from restshape_studies.bench.order import outline_of, sizes
from restshape_studies.bench.rank_job import cores, run_on_ranks
from restshape_studies.bench.reuse import kind_of
from restshape_studies.bench.scaling_model import model
from restshape_studies.bench.turns import Announce

from restshape.algebra.stages import NAMES
from restshape.errors import UserError
from restshape.mesh.generate import generate
from restshape.scene.load import load_scene
from restshape.scene.model import Scene

LEVELS = ("1", "2", "3", "still")
PARTS = (*NAMES, "python", "estimate", "record")
"""Parts of a frame, which sum to it on each rank; `edit` is in `python`, `residual` in `estimate`."""
STRONG, WEAK = "strong", "weak"
LARGE_SET = 400e6
"""Bytes of the arrays of STREAM's triad on all ranks together, which no cache holds."""
Play = Callable[[Job, int], Outcome]


@dataclass(frozen=True)
class Plan:
    """How a scene is replayed on ranks.

    Args:
        ranks: numbers of them, ascending, of which the first is what others are compared with.
        modes: "strong" (one mesh), "weak" (finer ones, so that each rank has as many unknowns).
        triangles: about how many a mesh on the first number of ranks has; none: the scene's own.
        repeat: runs on each number of ranks, which take turns.
        oversubscribe: ranks may share cores.
    """

    ranks: tuple[int, ...]
    modes: tuple[str, ...] = (STRONG,)
    triangles: tuple[float, ...] = ()
    repeat: int = 1
    oversubscribe: bool = False


def study(name: str, job: Job, plan: Plan, announce: Announce, play: Play | None = None) -> Row:
    """The record of a scene, as `bench scaling --json` writes it.

    Args:
        name: of the scene, for people.
        job: its replay.
        plan: on how many ranks.
        announce: called with what comes next.
        play: runs a job on ranks; None: `run_on_ranks`.

    Raises:
        UserError: the scene or the script cannot be replayed, or not with other mesh sizes.
    """
    play = play or (lambda one, ranks: run_on_ranks(one, ranks, plan.oversubscribe))
    scene = load_scene(job.scene, job.overrides)
    machine = {str(ranks): _rates(job, ranks, announce, play) for ranks in plan.ranks}
    runs = []
    for factor in _factors(scene, job.scene, plan.triangles):
        for mode in plan.modes:
            jobs = {ranks: _sized(job, scene, factor, mode, ranks / plan.ranks[0]) for ranks in plan.ranks}
            runs.append(_compared(f"{name}, {mode}", mode, jobs, machine, plan, announce, play))
    return {"cores": cores(), "oversubscribed": max(plan.ranks) > cores(), "machine": machine, "runs": runs}


def _rates(job: Job, ranks: int, announce: Announce, play: Play) -> Row:
    """What the machine gives so many ranks at once: bandwidth, and what messages cost."""
    announce(f"STREAM's triad and messages on {ranks} rank{'s' * (ranks > 1)}")
    asked = replace(job, measure="rates", details={"working_set": LARGE_SET}, petsc=())
    return _found(play(asked, ranks), asked, ranks)


def _found(outcome: Outcome, job: Job, ranks: int) -> Row:
    """What ranks have measured.

    Raises:
        UserError: they have come to no end.
    """
    if outcome.found is None:
        edits = f" --edits {job.edits}" if job.edits else ""
        what = f"on {ranks} ranks the replay {outcome.problem or 'gave no frames'}"
        raise UserError(what, job.scene, f"mpiexec -n {ranks} restshape replay {job.scene}{edits}")
    return outcome.found


def _factors(scene: Scene, path: str, triangles: Sequence[float]) -> list[float]:
    """By how much mesh sizes are multiplied for about so many triangles; 1 where the scene's own are asked for.

    Raises:
        UserError: the scene's mesh cannot be as fine as wanted.
    """
    if not triangles:
        return [1.0]
    own = len(generate(outline_of(scene, path), scene.mesh).cells)
    return [sqrt(own / number) for number in triangles]


def _sized(job: Job, scene: Scene, factor: float, mode: str, times: float) -> Job:
    """The replay on `times` as many ranks; weak: on a mesh with as many times the triangles.

    Raises:
        UserError: the scene's mesh is a file, whose size is what it is.
    """
    factor = factor / sqrt(times) if mode == WEAK else factor
    if mode == WEAK and scene.mesh.file:
        raise UserError("the mesh is a file, and is as fine as it is", f"{job.scene}: mesh.file", "take --strong")
    return replace(job, overrides=(*job.overrides, *(sizes(scene, factor) if factor != 1.0 else ())))


def _compared(
    what: str, mode: str, jobs: Mapping[int, Job], machine: Row, plan: Plan, announce: Announce, play: Play
) -> Row:
    """The record of one mesh on all numbers of ranks."""
    outcomes: dict[int, list[tuple[list[Row], Row]]] = {ranks: [] for ranks in jobs}
    for turn in range(plan.repeat):
        for ranks, job in jobs.items():
            announce(f"{what}: {ranks} rank{'s' * (ranks > 1)}, run {turn + 1} of {plan.repeat}")
            outcome = play(job, ranks)
            outcomes[ranks].append((outcome.rows, _found(outcome, job, ranks)))
    entries = [entry(ranks, runs) for ranks, runs in outcomes.items()]
    compare(entries, mode, {int(key): one["bandwidth"] for key, one in machine.items()})
    return {"mode": mode, "entries": entries, "model": model(entries, machine, mode)}


def entry(ranks: int, runs: Sequence[tuple[list[Row], Row]]) -> Row:
    """What runs on a number of ranks gave: each level's times, iterations and messages; memory and work of each rank.

    Args:
        ranks: how many.
        runs: rows of frames, and what the ranks have measured.
    """
    rows, found = runs[0]
    frames = [(row, slowest(measured["ranks"], k)) for own, measured in runs for k, row in enumerate(own)]
    kept = [(row, ms) for row, ms in frames if row["index"]]
    levels = {}
    for level in LEVELS:
        chosen = [(row, ms) for row, ms in kept if kind_of(row) == level and not row["refused"]]
        levels[level] = level_entry(chosen) if chosen else None
    first = [ms["ms"] for row, ms in frames if not row["index"]]
    return {
        "ranks": ranks,
        "unknowns": rows[0]["unknowns"],
        "elements": rows[0]["elements"],
        "preconditioner": next((row["preconditioner"] for row in reversed(rows) if row["preconditioner"]), ""),
        "first_ms": median(first),
        "levels": levels,
        "peak_mb": [one["peak_mb"] for one in found["ranks"]],
        "base_mb": [one["base_mb"] for one in found["ranks"]],
        "stored_mb": [1e-6 * (one["matrix"] + one["preconditioner"]) for one in found["ranks"]],
        "cells": [one["cells"] for one in found["ranks"]],
        "observed": [one["observed"] for one in found["ranks"]],
        "all_cells": found["ranks"][0]["all_cells"],
        "iteration_bytes": max(one["iteration"] for one in found["ranks"]),
        "working_set": found["working_set"],
        "bandwidth": found["ranks"][0].get("bandwidth"),
    }


def slowest(ranks: Sequence[Row], frame: int) -> dict[str, float]:
    """Milliseconds of a frame and of its stages, each on the rank that took the longest."""
    own = [one["ms"][frame] for one in ranks]
    return {key: max(row[key] for row in own) for key in own[0]}


def level_entry(frames: Sequence[tuple[Row, dict[str, float]]]) -> Row:
    """Medians over the frames of a level, and what they have sent."""
    rows = [row for row, _ in frames]
    iterations = mean(row["iterations"] for row in rows)
    sent = {key: mean(row[key] for row in rows) for key in ("messages", "message_bytes", "reductions")}
    return {
        "frames": len(rows),
        "ms": median(ms["ms"] for _, ms in frames),
        "iterations": iterations,
        "refreshes": int(sum(row["pc_rebuilt"] for row in rows)),
        "stages": {name: median(ms[f"ms_{name}"] for _, ms in frames) for name in PARTS},
        **sent,
    }


def compare(entries: Sequence[Row], mode: str, large: Mapping[int, float]) -> None:
    """Add to each level its speed-up over the first entry, the limit by memory, and the part of it that is reached.

    The limit is the ratio of the bandwidths of the triad, at the working sets of matrix and preconditioner where these
    are known, else at one that no cache holds. Of weak scaling it is that of a rank's share, 1 at best.

    Args:
        entries: of `entry`, completed here.
        mode: "strong" or "weak".
        large: ranks -> bandwidth [B/s] of all together at a working set that no cache holds.
    """
    first = entries[0]
    for one in entries:
        times = one["ranks"] / first["ranks"]
        here = one["bandwidth"] / first["bandwidth"] if one["bandwidth"] and first["bandwidth"] else None
        ratio = here or large[one["ranks"]] / large[first["ranks"]]
        one["limit"] = min(ratio, times) / (times if mode == WEAK else 1.0)
        one["stream_limit"] = large[one["ranks"]] / large[first["ranks"]] / (times if mode == WEAK else 1.0)
        for level, found in one["levels"].items():
            base = first["levels"][level]
            if found is None:
                continue
            gain = base["ms"] / found["ms"] if base and found["ms"] else None
            found["speed_up"] = gain
            found["efficiency"] = None if gain is None else gain / (1.0 if mode == WEAK else times)
            found["of_limit"] = None if gain is None else gain / one["limit"]
