"""What accuracy costs in furniture: samples of ranges, their ends, searches, Newton's tolerance, ratio of springs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np
from restshape_apps.furniture.analysis.plank_equilibrium import PlankEquilibrium
from restshape_apps.furniture.guidance.design import Design, DesignDirection
from restshape_apps.furniture.guidance.suggestions import suggest
from restshape_apps.furniture.physics.furniture import APART, LOST, OVERLAPPING, Compliance, Furniture
from restshape_apps.furniture.session.plank_session import PlankSession
from restshape_studies.accuracy.study import Case

from restshape.errors import UserError
from restshape.guidance.combination_search import Limits
from restshape.guidance.ranges import SAMPLES, Ranges, valid_ranges
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene
from restshape.scene.model import Scene

Row = dict[str, Any]

SAMPLED = (24, 48, 96, SAMPLES, 384, 768)
DENSE = 12289
"""Samples of the reference of a range."""
TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
"""Of ends, in parts of the way looked at."""
EXACT = 1e-10
EFFORTS = (1, 4, 16, 64, 256)
"""Combinations that a search tests in full, at most; what else it may do grows with it."""
ALL = Limits(trials=10**6, kept=0, glances=0, mended=10**6, continued=10**6)
"""A search that leaves nothing out."""
LARGE = Limits(trials=2000, kept=50, mended=100, continued=50)
"""What takes its place where there are more freedoms than `FEW`."""
FEW = 48
RESIDUALS = (1e-1, 1e-2, 1e-4, 1e-6, 1e-8, 1e-11)
RATIOS = (1e-2, 1e-1, 0.5, 1.0, 2.0, 10.0, 1e2)
"""Of the joints' compliance in rotation to the usual one."""
WAYS = 40
"""Parameters of a piece that ranges are taken along, at most, evenly among all."""
REPEATS = 5


@dataclass(frozen=True)
class PlankStudy:
    """What was found of a scene.

    Args:
        case: the scene with its script; scene: as it was read.
        planks, ways: of the first piece, and parameters that ranges were taken along; intervals: of the references.
        ranges: a row a number of samples, with and without hints of the force space.
        ends: a row a tolerance of their ends.
        searches: a row a limit of combinations tested, of the first piece at rest that asks for suggestions: the usual
            limits first, the search of everything last, or of `LARGE` limits. Empty where none does.
        newton: a row a tolerance of the residual.
        ratios: a row a ratio of the joints' compliances.
    """

    case: Case
    scene: Scene
    planks: int
    ways: int
    intervals: int
    ranges: tuple[Row, ...]
    ends: tuple[Row, ...]
    searches: tuple[Row, ...]
    newton: tuple[Row, ...]
    ratios: tuple[Row, ...]

    @property
    def records(self) -> list[Row]:
        """All rows, each with what was varied, for programs."""
        kinds = ("ranges", "ends", "searches", "newton", "ratios")
        return [{"scene": self.case.name, "varied": kind, **row} for kind in kinds for row in getattr(self, kind)]


def study_planks(case: Case, announce: Callable[[str], None] = lambda text: None) -> PlankStudy:
    """The study of a scene of furniture.

    Raises:
        UserError: nothing can be moved in its first piece, or no joint bears anything.
    """
    scene = load_scene(case.scene, case.overrides)
    session = PlankSession(scene, load_script(case.edits, scene))
    design = session.design
    freedoms = sorted(design.freedoms)
    chosen = np.unique(np.linspace(0, len(freedoms) - 1, min(WAYS, len(freedoms))).round().astype(int))
    ways = [design.parameter(*freedoms[k]) for k in chosen]
    if not ways or not design.piece.joints:
        raise UserError("nothing moves in the piece, or nothing joins it", str(case.scene), "name another scene")
    announce(f"{case.name}: references of {len(ways)} ranges")
    truths = [_range(way, DENSE, False, EXACT)[0] for way in ways]
    announce(f"{case.name}: ranges")
    ranges = tuple(sampled(ways, truths, count, hints) for hints in (True, False) for count in SAMPLED)
    ends = tuple(ended(ways, truths, tolerance) for tolerance in TOLERANCES)
    announce(f"{case.name}: searches, forces")
    asking = first_asking(session)
    searches = searched(asking) if asking else ()
    newton, ratios = solved(design.piece), proportioned(design.piece)
    found = sum(len(truth.intervals) for truth in truths)
    return PlankStudy(case, scene, len(design.piece.planks), len(ways), found, ranges, ends, searches, newton, ratios)


def _range(way: DesignDirection, samples: int, hints: bool, tolerance: float) -> tuple[Ranges, float]:
    """The range along a way, and the least time that it took [s]."""
    design, times = way.design, []
    for _ in range(1 if samples == DENSE else REPEATS):
        design.furniture.kernel.forget()
        start = perf_counter()
        expected = design.hints(way) if hints else np.zeros(0)
        found = valid_ranges(
            design.furniture.kernel, way.direction, way.low, way.high, expected, samples=samples, tolerance=tolerance
        )
        times.append(perf_counter() - start)
    return found, min(times)


def wrong(found: np.ndarray, truth: np.ndarray) -> float:
    """The length (in units of t) over which intervals (k, 2) and true ones (m, 2) differ."""
    marks = np.unique(np.concatenate([found.ravel(), truth.ravel()]))
    middles, lengths = 0.5 * (marks[1:] + marks[:-1]), np.diff(marks)
    return float(np.sum(lengths[_inside(middles, found) != _inside(middles, truth)]))


def _inside(t: np.ndarray, intervals: np.ndarray) -> np.ndarray:
    """Whether places (n,) are in one of the intervals (k, 2)."""
    if not len(intervals):
        return np.zeros(len(t), dtype=bool)
    return ((intervals[:, 0] <= t[:, None]) & (t[:, None] <= intervals[:, 1])).any(axis=1)


def unseen(found: np.ndarray, truth: np.ndarray) -> int:
    """How many true intervals (m, 2) meet none of those found (k, 2)."""
    return sum(not ((found[:, 0] <= high) & (low <= found[:, 1])).any() for low, high in truth)


def sampled(ways: Sequence[DesignDirection], truths: Sequence[Ranges], samples: int, hints: bool) -> Row:
    """What so many samples of each range miss, and cost."""
    parts, missed, times = [], 0, []
    for way, truth in zip(ways, truths):
        found, seconds = _range(way, samples, hints, 1e-6)
        parts.append(wrong(found.intervals, truth.intervals) / (way.high - way.low))
        missed += unseen(found.intervals, truth.intervals)
        times.append(seconds)
    row = {"samples": samples, "hints": hints, "ms": 1e3 * float(np.median(times)), "missed": missed}
    return row | {"worst": max(parts), "mean": float(np.mean(parts))}


def ended(ways: Sequence[DesignDirection], truths: Sequence[Ranges], tolerance: float) -> Row:
    """How far ends are from the true ones, where they were seen, in parts of the way; and what they cost."""
    errors, times = [], []
    for way, truth in zip(ways, truths):
        found, seconds = _range(way, SAMPLES, True, tolerance)
        times.append(seconds)
        spacing = (way.high - way.low) / (SAMPLES - 1)
        for end in truth.intervals.ravel():
            near = np.abs(found.intervals.ravel() - end).min(initial=np.inf)
            errors += [near / (way.high - way.low)] if near <= spacing else []
    return {"tolerance": tolerance, "ms": 1e3 * float(np.median(times)), "worst": max(errors, default=0.0)}


def first_asking(session: PlankSession) -> Design | None:
    """The first piece of a session at rest that falls or breaks, and can be mended by moving its planks."""
    for frame in session.frames():
        if not frame.edit_ended or frame.gamma.any():
            continue
        flaws = frame.design.furniture.test().flaws
        if flaws and not flaws & (LOST | OVERLAPPING | APART):
            return frame.design
    return None


def searched(design: Design) -> tuple[Row, ...]:
    """What searches with so many combinations tested find, and cost; the last one is what they are counted from."""
    rows = []
    efforts = [Limits(trials=e, kept=2 + e // 16, mended=e // 8, continued=e // 4) for e in EFFORTS]
    last = ALL if len(design.freedoms) <= FEW else LARGE
    for limits in (Limits(), *efforts, last):
        times = []
        for _ in range(1 if limits is last else REPEATS):
            design.furniture.kernel.forget()
            start = perf_counter()
            found = suggest(design.furniture, design.guidance.freedoms, 10**6, limits)
            times.append(perf_counter() - start)
        names = {one.modes for one in found.found if one.valid}
        rows.append(
            {"trials": limits.trials, "tested": found.tested, "ms": 1e3 * float(np.median(times)), "names": names}
        )
    everything = rows[-1]["names"]
    tallied = [{**row, "found": len(row["names"] & everything), "all": len(everything)} for row in rows]
    return tuple({key: value for key, value in row.items() if key != "names"} for row in tallied if everything)


def solved(piece: Any) -> tuple[Row, ...]:
    """What Newton's tolerance makes of the forces of all cases, and costs."""
    furniture = Furniture(piece)
    furniture.test()
    rows, truth = [], None
    for tolerance in reversed(RESIDUALS):
        solver, times, steps = PlankEquilibrium(furniture, tolerance=tolerance), [], 0
        for _ in range(REPEATS):
            start, found, steps = perf_counter(), [], 0
            for case in range(len(furniture.cases)):
                forces = solver.solve(case)
                found += [forces.bending, forces.tension, forces.shear.ravel()]
                steps += solver.steps
            times.append(perf_counter() - start)
        solver.destroy()
        values = np.concatenate(found)
        truth = values if truth is None else truth
        error = float(np.abs(values - truth).max() / np.abs(truth).max())
        rows.append({"tolerance": tolerance, "steps": steps, "ms": 1e3 * min(times), "error": error})
    return tuple(rows)


def proportioned(piece: Any) -> tuple[Row, ...]:
    """Utilisation over the ratio of the joints' compliances: a choice of the model, which has no right value."""
    usual, rows, first = Compliance(), [], None
    for ratio in (1.0, *(ratio for ratio in RATIOS if ratio != 1.0)):
        furniture = Furniture(piece, Compliance(joint_t=usual.joint_t, joint_r=ratio * usual.joint_r))
        result = furniture.test()
        cases = [furniture.forces(case) for case in range(len(furniture.cases))]
        utilisation = np.max([np.maximum(one.pull_utilisation, one.shear_utilisation) for one in cases], axis=0)
        first = utilisation if first is None else first
        change = np.abs(utilisation - first)
        rows.append(
            {
                "ratio": ratio,
                "utilisation": float(utilisation.max()),
                "worst": float(change.max()),
                "flaws": result.flaws,
            }
        )
    return tuple(sorted(rows, key=lambda row: row["ratio"]))
