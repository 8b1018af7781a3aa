"""How far each way of prediction is from the solved answer along drags: figure 5.18 of the thesis, in numbers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from restshape_studies.bench.job import Row

from restshape.algebra.work_counts import pass_seconds
from restshape.analysis.analysis import Analysis
from restshape.analysis.modal.frequencies import largest_difference
from restshape.fem.residuals import energy
from restshape.interface.run import Run
from restshape.replay.request import Request
from restshape.scene.load import revise

NO_STEPS, MOTION = "gmls, no steps", "motion alone"
"""GMLS whose frames of drags take no solver steps; cloth that moves with kinetic damping, as far as a frame's time
goes."""
PASSES = 2.0
"""Passes over all elements of a step of motion, besides its factor."""


@dataclass
class Along:
    """What is seen of one way along the drags.

    Args:
        found: of each frame relative error, mean and largest distance of nodes [m], relative error of the energy.
        frames: their indices; sampled: those before which a sample was taken.
        lags: edit time [s] since the solved frame that each is nearest to.
    """

    found: list[tuple[float, ...]] = field(default_factory=list)
    frames: list[int] = field(default_factory=list)
    sampled: list[int] = field(default_factory=list)
    lags: list[float] = field(default_factory=list)

    def record(self) -> Row:
        """Of JSON."""
        error, mean, largest, off = np.array(self.found).T
        record: Row = {"error": error.tolist(), "mean": float(error.mean()), "max": float(error.max())}
        record |= {"frames_at": self.frames, "sampled": self.sampled}
        if np.isfinite(mean).all():
            record["distance"] = {"mean": float(mean.mean()), "max": float(largest.max())}
            record["lag_ms"] = {"mean": 1e3 * float(np.mean(self.lags)), "max": 1e3 * max(self.lags)}
        if np.isfinite(off).all():
            record["energy"] = {"mean": float(off.mean()), "max": float(off.max())}
        return record


def compare_ways(request: Request) -> Row:
    """How far each way of prediction is from the solved answer in all frames of drags, those that it solves included.

    Returns: by way `error` (of each frame, as of `difference`), `mean` and `max` of them, `frames_at` (their indices)
    and `sampled` (those before which a sample was taken); of a displacement `distance` (of nodes [m]: `mean`, and `max`
    of the largest), `lag_ms` (edit time since the solved frame of the same drag that it is nearest to) and `energy`
    (relative).
    """
    run = Run(replace(request, predict="none"), summed=False)
    frames, exact = run.rows(), run.replay
    first = next(frames)
    runs = {way: Run(one, summed=False) for way, one in _asked(request, exact.analysis).items()}
    if MOTION in runs:
        runs[MOTION].replay.analysis.start_from(exact.analysis)
    others = [one.rows() for one in runs.values()]
    seen = {way: Along() for way in runs}
    solved: list[tuple[float, np.ndarray]] = []
    line = 0
    for true, *rows in _together(first, frames, others):
        if true["event"] != "drag" or not true["level"] or true["refused"]:
            for way, row in zip(runs, rows):
                seen[way].sampled += [row["index"]] if "derivative" in row.get("idle_work", "") else []
            continue
        if true["line"] != line:
            solved, line = [], true["line"]
        place = exact.analysis.solution().field
        solved += [] if place is None else [(true["t"], place)]
        for (way, one), row in zip(runs.items(), rows):
            if not row["refused"]:
                note(seen[way], one.replay.analysis, exact.analysis, row, solved)
    return {way: one.record() for way, one in seen.items() if one.found}


def _together(first: Row, frames: Iterator[Row], others: list[Iterator[Row]]) -> Iterator[tuple[Row, ...]]:
    """The rows of all replays, frame by frame, of which the first one has begun."""
    yield (first, *(next(one) for one in others))
    yield from zip(frames, *others)


def _asked(request: Request, exact: Analysis) -> dict[str, Request]:
    """What is replayed, by way; motion alone of cloth only."""
    still = request.scene.predict.model_copy(update={"frame_time": 0.0})
    alone = request.scene.model_copy(update={"predict": still})
    asked = {
        "linear": replace(request, predict="linear"),
        "gmls": replace(request, predict="gmls"),
        NO_STEPS: replace(request, scene=alone, predict="gmls"),
    }
    if "drape" not in request.scene.effects and not hasattr(exact, "start_from"):
        return asked
    steps = _motion_steps(request, exact)
    moving = revise(revise(request.scene, "effects.drape.strategy", "kinetic"), "effects.drape.steps", steps)
    return asked | {MOTION: replace(request, scene=moving, predict="none")}


def _motion_steps(request: Request, exact: Any) -> int:
    """Implicit steps, a factor each, that a frame's time pays for by the calibration; one at least."""
    kept = exact.state.solver.linear.kept
    each = kept.price().refresh + PASSES * pass_seconds(kept.size.nonzeros, request.calibration)
    return max(1, int(request.scene.predict.frame_time / each))


def note(seen: Along, found: Analysis, exact: Analysis, row: Row, solved: list[tuple[float, np.ndarray]]) -> None:
    """Take in a frame of a drag: the answer of one way, and the solved answers of the drags so far."""
    seen.found.append(_apart(found, exact))
    seen.frames.append(row["index"])
    seen.sampled += [row["index"]] if "derivative" in row.get("idle_work", "") else []
    near = found.solution().field
    if near is not None and solved:
        ways = [np.linalg.norm(near - place) if place.shape == near.shape else np.inf for _, place in solved]
        seen.lags.append(row["t"] - solved[int(np.argmin(ways))][0])


def _apart(found: Analysis, exact: Analysis) -> tuple[float, ...]:
    """The relative error of an answer, mean and largest distance of nodes [m], and relative error of the energy."""
    near, true = found.solution().field, exact.solution().field
    if near is None or true is None or near.shape != true.shape:
        return (difference(found, exact), np.nan, np.nan, np.nan)
    way = np.linalg.norm(near - true, axis=1)
    energies = [_energy(one) for one in (found, exact)]
    off = abs(energies[0] - energies[1]) / abs(energies[1]) if energies[1] else np.nan
    return (difference(found, exact), float(way.mean()), float(way.max()), off)


def _energy(analysis: Any) -> float:
    """The potential energy [J] of an answer; not a number where it has none."""
    problem, x = analysis.state.problem, getattr(analysis, "x", None)
    own = getattr(problem, "energy", None)
    if x is None:
        return np.nan
    if own is not None:
        return float(own(x))
    return float(energy(problem, x)) if problem.traits(analysis.state.plan).minimises else np.nan


def difference(predicted: Analysis, solved: Analysis) -> float:
    """The relative error of a predicted answer: of the norm of a field, or the largest of single frequencies."""
    found, exact = predicted.solution(), solved.solution()
    if found.field is None or exact.field is None:
        return largest_difference(found.values, exact.values)
    size = float(np.linalg.norm(exact.field))
    return float(np.linalg.norm(found.field - exact.field)) / size if size > 0.0 else 0.0
