"""Large problems: a drag of a shape in the plane, of a body in space, and of one in motion, under policies of reuse."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import sqrt
from pathlib import Path
from statistics import mean, median
from time import perf_counter, process_time
from typing import Any

from restshape_studies.bench.job import Job, Outcome, Row, run
from restshape_studies.bench.order import sizes
from restshape_studies.bench.rank_process import own_work, peak_mb
from restshape_studies.bench.size import write_script
from restshape_studies.bench.turns import Announce

from restshape.errors import UserError
from restshape.interface.run import Run
from restshape.replay.request import Request
from restshape.scene.load import load_scene

PREDICTED = "predicted"
"""Beside policies: the frames of the drag, predicted linearly."""
ENOUGH = 0.9
"""Of the time of a replay: no frame begins that would end later if it took as long as the longest one so far."""
Play = Callable[[Job, float], Outcome]


@dataclass(frozen=True)
class Large:
    """A problem that can be as large as wanted.

    Args:
        title: of it, for people.
        scene: name of an installed one, with its application.
        unknowns: about how many.
        frames: of the drag.
        on, at, step: what the hand holds, where [m], and how far it goes a frame [m].
        overrides: ``key=value`` as after --set.
        policies: that are compared, and `PREDICTED`.
        long: frames of policies without reuse, whose every frame costs the same.
    """

    title: str
    scene: str
    unknowns: float
    frames: int
    on: str
    at: tuple[float, float]
    step: tuple[float, float]
    overrides: tuple[str, ...] = ()
    policies: tuple[str, ...] = ("auto", "refactor", "rebuild", PREDICTED)
    long: int = 3

    def events(self) -> list[dict[str, Any]]:
        """The drag."""
        (x, y), (dx, dy) = self.at, self.step
        way = [{"do": "drag", "to": [x + k * dx, y + k * dy]} for k in range(1, self.frames + 1)]
        return [
            {"t": round(k / 60, 6), **event}
            for k, event in enumerate([{"do": "press", "on": self.on, "at": [x, y]}, *way])
        ]


CASES = {
    "plane": Large("plate whose hole is dragged", "solid/plate", 1e6, 50, "window", (0.4, 0.5), (0.002, 0.0)),
    "space": Large(
        "one tone of a bar of tetrahedra whose end is dragged",
        "metallophone/bar_200",
        3e5,
        50,
        "right",
        (0.2, 0.015),
        (0.0002, 0.0),
        ("mesh.layers=4",),
        long=1,
    ),
    "motion": Large(
        "building on shaking ground whose window is dragged, a step of Newmark's method a frame",
        "vibration/building",
        1e6,
        10,
        "right_top",
        (5.7, 16.6),
        (0.0, -0.005),
        ("effects.dynamics.steps=1",),
        ("auto", "refactor"),
    ),
}
"""By name; sizes that the thesis aims at, and more."""


def study(
    case: Large,
    scene: Path,
    unknowns: float,
    folder: Path,
    overrides: Sequence[str],
    seconds: float,
    announce: Announce,
    play: Play = run,
) -> Row:
    """The record of a case, as `bench large --json` writes it.

    Args:
        case: what is dragged.
        scene: its file.
        unknowns: about how many.
        folder: for the script.
        overrides: ``key=value`` as after --set.
        seconds: that each replay may take.
        announce: called with what comes next; play: runs a job.

    Raises:
        UserError: the scene cannot be replayed.
    """
    given, script = (*case.overrides, *overrides), folder / "drag.jsonl"
    write_script(script, case.events())
    job = Job(str(scene), str(script), "auto", given, measure="large", details={"frames": 0, "seconds": seconds})
    first = play(job, seconds)
    own = first.found
    if own is None:
        raise UserError(f"its first shape: {first.problem}", str(scene), f"restshape replay {scene}")
    factor = sqrt(own["unknowns"] / unknowns)
    job = replace(job, overrides=(*given, *sizes(load_scene(scene, given), factor)))
    found: Row = {"title": case.title, "policies": {}}
    for policy in case.policies:
        announce(f"{case.title}: {policy}, about {unknowns:,.0f} unknowns")
        predict = "linear" if policy == PREDICTED else "none"
        frames = case.frames if policy in ("auto", PREDICTED) else min(case.long, case.frames)
        name = "auto" if policy == PREDICTED else policy
        one = play(
            replace(job, policy=name, predict=predict, details={"frames": frames, "seconds": ENOUGH * seconds}), seconds
        )
        found["policies"][policy] = measured = one.found or {"problem": one.problem or "nothing was measured"}
        announce(_said(policy, measured))
    return found | {"ratios": ratios(found["policies"])}


def _said(policy: str, one: Row) -> str:
    """What a policy took, so that it is known if those after it do not come to an end."""
    if "problem" in one:
        return f"{policy}: {one['problem']}"
    frames = f"; {one['frames']} frames, each {one['cpu_ms']:,.0f} ms" if one["frames"] else ""
    return f"{policy}: first frame {one['first_cpu_ms']:,.0f} ms of the processor{frames}; {one['peak_mb']:,.0f} MB"


def ratios(policies: Row) -> dict[str, float]:
    """How many times the processor time of `auto` the median frame of each other policy takes."""
    own = policies.get("auto", {}).get("cpu_ms")
    others = {name: one.get("cpu_ms") for name, one in policies.items() if name not in ("auto", PREDICTED)}
    return {name: ms / own for name, ms in others.items() if ms and own}


def measure(request: Request, frames: int, seconds: float) -> Row:
    """What a replay of a drag takes.

    Args:
        request: the replay.
        frames: that move nodes, after which it ends; 0: after the first one, which moves none.
        seconds: no frame begins that would end later if it took as long as the longest one so far.

    Returns: unknowns, elements; first_ms, first_cpu_ms (of the processor, which other work takes no part of); frames
        that moved, ms and cpu_ms (p50), iterations (mean), refreshes, levels (each frame's), preconditioner; peak_mb,
        base_mb (libraries), stored_mb (matrices and preconditioner, the most after any frame).

    Raises:
        UserError: the first shape has no solution.
    """
    base, begun = peak_mb(), perf_counter()
    run = Run(replace(request, measured="residual"), summed=False)
    first: Row = {}
    moved: list[Row] = []
    last, longest, stored = process_time(), 0.0, 0.0
    for row in run.rows():
        timed = dict(row) | {"cpu_ms": 1e3 * (process_time() - last)}
        if not first or row["pc_rebuilt"]:
            stored = max(stored, stored_mb(run))
        first = first or timed
        if row["index"] and (row["level"] or row["predicted"]) and not row["refused"]:
            moved.append(timed)
        longest = max(longest, 1e-3 * row["ms"])
        if len(moved) >= frames or perf_counter() - begun + longest > seconds:
            break
        last = process_time()
    stored = max(stored, stored_mb(run))
    found = {"unknowns": first["unknowns"], "elements": first["elements"], "first_ms": first["ms"]}
    found["first_cpu_ms"] = first["cpu_ms"]
    found |= {"peak_mb": peak_mb(), "base_mb": base, "stored_mb": stored, "frames": len(moved)}
    if moved:
        found |= {
            "ms": median(row["ms"] for row in moved),
            "cpu_ms": median(row["cpu_ms"] for row in moved),
            "iterations": mean(row["iterations"] for row in moved),
            "refreshes": int(sum(row["pc_rebuilt"] for row in moved)),
            "levels": [int(row["level"]) for row in moved],
            "preconditioner": moved[-1]["preconditioner"],
        }
    return found


def stored_mb(run: Run) -> float:
    """What matrices and preconditioner of a run take [MB]."""
    work = own_work(run.replay)
    return 1e-6 * (work["matrix"] + work["preconditioner"])
