"""What the refreshes of a replay cost beside the best schedule in hindsight."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from petsc4py import PETSc

from restshape.algebra.choice import prices
from restshape.algebra.linear import MOST_ITERATIONS, LinearSolver
from restshape.algebra.preconditioner import set_preconditioner, set_rigid_motions
from restshape.algebra.schedule import best_schedule
from restshape.errors import UserError
from restshape.replay.loop import Replay
from restshape.replay.request import Request

WINDOW = 40
"""Frames that a preconditioner is looked at for, in hindsight."""


@dataclass
class Solve:
    """What a frame's solve was given, and what it spent; `frame` is its index.

    Args:
        matrix, right, guess: copies, from before the solve.
        flipped: the pattern is not that of the frame before.
        aim: relative and absolute residual at which the solve ended.
        iterations: spent, those before a refresh in mid-solve too.
    """

    frame: int
    matrix: PETSc.Mat
    right: PETSc.Vec
    guess: PETSc.Vec
    flipped: bool
    aim: tuple[float, float]
    iterations: int
    refreshed: bool


@dataclass
class Segment:
    """The solves of one system, from one new mesh to the next, and its preconditioner."""

    kind: str
    levels: int
    iteration: float
    refresh: float
    setup: float
    solves: list[Solve] = field(default_factory=list)


def measure(request: Request, window: int = WINDOW) -> dict[str, Any]:
    """Seconds by the calibration of the schedule that is run and of the best one, their ratio, and both schedules.

    The replay runs once more; each frame's matrix is then solved with the preconditioners of all frames up to `window`
    before it, from the guess that the replay had. A new mesh begins a segment, whose first frame always makes one. In
    hindsight a frame of level 2 may be refreshed like any other.

    Args:
        request: of an analysis with one solve a frame, under a policy that refreshes.
        window: frames; 1 at least.

    Raises:
        UserError: a frame has several solves.

    Returns: run, best [s], ratio; schedule (frames refreshed), refreshes and iterations, each of run and best; frames.
    """
    replay = Replay(request, PETSc.COMM_WORLD)
    segments = _replay(replay)
    run = best = 0.0
    schedule: dict[str, list[int]] = {"run": [], "best": []}
    iterations = {"run": 0, "best": 0}
    for segment in segments:
        solves = segment.solves
        counts = _table(segment, PETSc.COMM_WORLD, window)
        refresh = _refresh_costs(segment)
        # A schedule that was run may keep a preconditioner for longer than the window.
        cost, spent = _cost_of_run(segment, refresh)
        costs = np.where(counts < 0, np.inf, segment.iteration * counts)
        least, refreshes = best_schedule(refresh, costs)
        run, best = run + cost, best + least
        schedule["run"] += [solve.frame for solve in solves if solve.refreshed]
        schedule["best"] += [solves[k].frame for k in refreshes]
        iterations["run"] += spent
        ends = [*refreshes[1:], len(solves)]
        iterations["best"] += int(sum(counts[i, i:end].sum() for i, end in zip(refreshes, ends)))
        for solve in solves:
            for part in (solve.matrix, solve.right, solve.guess):
                part.destroy()
    return {
        "run": run,
        "best": best,
        "ratio": run / best if best > 0 else 1.0,
        "schedule": schedule,
        "iterations": iterations,
        "refreshes": {name: len(frames) for name, frames in schedule.items()},
        "frames": sum(len(segment.solves) for segment in segments),
    }


def _replay(replay: Replay) -> list[Segment]:
    """Run a replay; its solves, segment by segment."""
    solver: LinearSolver = replay.analysis.solver
    found: list[Segment] = []
    pending: list[tuple[PETSc.Mat, PETSc.Vec, PETSc.Vec, bool]] = []

    def watch(mat: PETSc.Mat, b: PETSc.Vec, x: PETSc.Vec, new: bool, places: np.ndarray | None) -> None:
        matrix = mat.copy()
        if places is not None and matrix.getBlockSize() == places.shape[1]:
            set_rigid_motions(matrix, places)
        pending.append((matrix, b.copy(), x.copy(), new))

    solver.on_solve = watch
    for row in replay.frames():
        if not pending or row["refused"]:
            pending.clear()
            continue
        if len(pending) > 1:
            raise UserError(
                "the cost in hindsight is measured where a frame has one solve",
                str(replay.session.scene.path),
                "take a steady scene",
            )
        matrix, right, guess, new = pending[0]
        pending.clear()
        if new or not found:
            found.append(_segment(solver))
        aim, spent, refreshed = solver.ksp.getTolerances()[:2], row["iterations"], bool(row["pc_rebuilt"])
        solve = Solve(row["index"], matrix, right, guess, row["level"] == 2, aim, spent, refreshed)
        found[-1].solves.append(solve)
    solver.on_solve = None
    return found


def _segment(solver: LinearSolver) -> Segment:
    """An empty segment with the preconditioner that the solver has just made."""
    kept = solver.kept
    price = prices(kept.kind, kept.size, kept.filled or kept.size.nonzeros, kept.choice.calibration)
    levels = kept.candidate.levels if kept.candidate else 0
    return Segment(kept.kind, levels, *price)


def _refresh_costs(segment: Segment) -> np.ndarray:
    """Seconds (n, n) of a refresh at frame j after one at frame i: a patch between the two asks for a new analysis."""
    flips = np.cumsum([solve.flipped for solve in segment.solves])
    costs = np.where(flips[None, :] > flips[:, None], segment.setup, segment.refresh)
    costs[0, 0] = segment.setup
    return costs


def _cost_of_run(segment: Segment, refresh: np.ndarray) -> tuple[float, int]:
    """Seconds and iterations of a segment as it was run."""
    cost, spent, last = 0.0, 0, 0
    for j, solve in enumerate(segment.solves):
        if solve.refreshed:
            cost, last = cost + refresh[last, j], j
        cost += segment.iteration * solve.iterations
        spent += solve.iterations
    return float(cost), spent


def _table(segment: Segment, comm: PETSc.Comm, window: int) -> np.ndarray:
    """Iterations (n, n) of frame j with the preconditioner of frame i; -1 beyond the window or without convergence."""
    solves = segment.solves
    counts = np.full((len(solves),) * 2, -1)
    for i, made in enumerate(solves):
        ksp = PETSc.KSP().create(comm)
        ksp.setOptionsPrefix("hindsight_")
        ksp.setType("cg")
        ksp.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
        ksp.setInitialGuessNonzero(True)
        ksp.setTolerances(divtol=1e30, max_it=MOST_ITERATIONS)
        given = set_preconditioner(ksp, segment.kind, segment.levels)
        ksp.setOperators(made.matrix)
        ksp.setUp()
        if comm.size > 1:
            ksp.setUpOnBlocks()
        options = PETSc.Options("hindsight_")
        for key in given:
            options.delValue(key)
        ksp.getPC().setReusePreconditioner(True)
        for j in range(i, min(len(solves), i + window)):
            x = solves[j].guess.copy()
            ksp.setOperators(solves[j].matrix)
            ksp.setTolerances(*solves[j].aim)
            ksp.solve(solves[j].right, x)
            if ksp.getConvergedReason() > 0:
                counts[i, j] = ksp.getIterationNumber()
            x.destroy()
        ksp.destroy()
    return counts
