"""What the refreshes of a replay cost beside the best schedule in hindsight."""

from dataclasses import dataclass, field
from typing import TypedDict

import numpy as np
from petsc4py import PETSc

from restshape.algebra.choice import prices
from restshape.algebra.linear import MOST_ITERATIONS, RESTART, LinearSolver
from restshape.algebra.linear_report import LinearReport
from restshape.algebra.preconditioner import set_preconditioner, set_rigid_motions
from restshape.algebra.schedule import best_schedule
from restshape.analysis.row_values import whole
from restshape.arrays import Reals
from restshape.first_use import made
from restshape.replay.loop import Replay

WINDOW = 40
"""Matrices that a preconditioner is looked at for, in hindsight."""
SAMPLED = 3
"""Solves with one matrix that are repeated at most; they stand for all of these."""


@dataclass
class Solve:
    """What a solve was given: right side and guess, and the residuals, relative and absolute, at which it ended."""

    right: PETSc.Vec
    guess: PETSc.Vec
    aim: tuple[float, float] = (0.0, 0.0)


@dataclass
class Train:
    """The solves with one matrix, in a row; `frame` is the index of theirs.

    Args:
        matrix: a copy.
        flipped: its pattern is not that of the train before.
        solves: some of them; count: of all.
        iterations: spent, those before a refresh in mid-solve too; refreshed: a preconditioner was made for them.
    """

    frame: int
    matrix: PETSc.Mat
    flipped: bool = False
    solves: list[Solve] = field(default_factory=list)
    count: int = 0
    iterations: int = 0
    refreshed: bool = False

    def destroy(self) -> None:
        """Free PETSc's objects."""
        self.matrix.destroy()
        for solve in self.solves:
            solve.right.destroy()
            solve.guess.destroy()


@dataclass
class Segment:
    """Trains from one new mesh, or test of stability, to the next, and the preconditioner.

    Args:
        kind, levels, blocks: of the preconditioner, as `set_preconditioner` has them.
        iteration, refresh, setup: seconds by the calibration; first: of the first train's, 0 where a test has made it.
    """

    kind: str
    levels: int
    blocks: bool
    iteration: float
    refresh: float
    setup: float
    first: float
    trains: list[Train] = field(default_factory=list)


class Beside(TypedDict):
    """A schedule that was run, and the best one.

    Args:
        run, best: seconds by the calibration; ratio: of the two.
        schedule: frames refreshed; refreshes, iterations: how many; each of run and best.
        matrices: how many were solved with.
    """

    run: float
    best: float
    ratio: float
    schedule: dict[str, list[int]]
    refreshes: dict[str, int]
    iterations: dict[str, int]
    matrices: int


class Watch:
    """Notes the solves of a linear solver, segment by segment; the iteration that a replay goes on from sees no change.

    Args:
        solver: keeps its preconditioner for as long as it is worth it.
    """

    def __init__(self, solver: LinearSolver) -> None:
        self.solver, self.segments = solver, list[Segment]()
        self.frame, self._state, self._new = 0, (0, -1), True
        self._pending: tuple[Train, Solve] | None = None
        solver.on_solve, solver.on_solved = self._before, self._after

    def _before(self, mat: PETSc.Mat, b: PETSc.Vec, x: PETSc.Vec, new: bool, places: Reals | None) -> None:
        self._new |= new
        state = mat.handle, mat.stateGet()
        if state != self._state or new or not self.segments:
            copy = mat.copy()
            if places is not None and copy.getBlockSize() == places.shape[1]:
                set_rigid_motions(copy, places)
            flipped = mat.handle != self._state[0]
            self._state = state
            train = Train(self.frame, copy, flipped)
        else:
            train = self.segments[-1].trains[-1]
        self._pending = train, Solve(b.copy(), x.copy())

    def _after(self, report: LinearReport | None) -> None:
        train, solve = made(self._pending)
        if self._new or report is None or not self.segments:
            self.segments.append(_segment(self.solver, tested=report is None))
        self._new = False
        trains = self.segments[-1].trains
        if not trains or trains[-1] is not train:
            trains.append(train)
        solve.aim = self.solver.ksp.getTolerances()[:2]
        if report is None:
            train.refreshed = True
            return
        train.count += 1
        train.iterations += report.iterations
        train.refreshed |= report.refreshed
        if len(train.solves) < SAMPLED:
            train.solves.append(solve)


def measure(replay: Replay, solver: LinearSolver, window: int = WINDOW) -> Beside:
    """The schedule of refreshes that is run, and the best one.

    The replay runs to its end; each matrix is then solved with the preconditioners of all matrices up to `window`
    before it, from the guesses that the replay had. A new mesh begins a segment, whose first matrix always makes one;
    so does a test of stability, whose factor is no choice. In hindsight a frame of level 2 may be refreshed like any
    other, but no preconditioner is made between two solves with one matrix.

    Args:
        replay: under a policy that refreshes; solver: of its analysis.
        window: matrices; 1 at least.
    """
    watch = Watch(solver)
    for row in replay.frames():
        watch.frame = whole(row, "index") + 1
    solver.on_solve = solver.on_solved = None
    run = best = 0.0
    schedule: dict[str, list[int]] = {"run": [], "best": []}
    iterations = {"run": 0, "best": 0}
    for segment in watch.segments:
        trains = segment.trains
        counts = _table(segment, solver, window)
        refresh = _refresh_costs(segment)
        # A schedule that was run may keep a preconditioner for longer than the window.
        cost, spent = _cost_of_run(segment, refresh)
        costs = np.where(counts < 0, np.inf, segment.iteration * counts)
        least, refreshes = best_schedule(refresh, costs)
        run, best = run + cost, best + least
        schedule["run"] += [train.frame for train in trains if train.refreshed]
        schedule["best"] += [trains[k].frame for k in refreshes]
        iterations["run"] += spent
        ends = [*refreshes[1:], len(trains)]
        iterations["best"] += int(sum(counts[i, i:end].sum() for i, end in zip(refreshes, ends)))
        for train in trains:
            train.destroy()
    return {
        "run": run,
        "best": best,
        "ratio": run / best if best > 0 else 1.0,
        "schedule": schedule,
        "iterations": iterations,
        "refreshes": {name: len(frames) for name, frames in schedule.items()},
        "matrices": sum(len(segment.trains) for segment in watch.segments),
    }


def _segment(solver: LinearSolver, tested: bool) -> Segment:
    """An empty segment with the preconditioner that the solver has just made; `tested`: by a test of stability."""
    kept = solver.kept
    price = prices(kept.kind, kept.size, kept.filled or kept.size.nonzeros, kept.choice.calibration)
    levels = kept.candidate.levels if kept.candidate else 0
    return Segment(kept.kind, levels, kept.blocks, *price, 0.0 if tested else price.setup)


def _refresh_costs(segment: Segment) -> Reals:
    """Seconds (n, n) of a refresh at train j after one at train i: a patch between the two asks for a new analysis."""
    flips = np.cumsum([train.flipped for train in segment.trains])
    costs = np.where(flips[None, :] > flips[:, None], segment.setup, segment.refresh)
    costs[0, 0] = segment.first
    return costs


def _cost_of_run(segment: Segment, refresh: Reals) -> tuple[float, int]:
    """Seconds and iterations of a segment as it was run."""
    cost, spent, last = 0.0, 0, 0
    for j, train in enumerate(segment.trains):
        if train.refreshed:
            cost, last = cost + refresh[last, j], j
        cost += segment.iteration * train.iterations
        spent += train.iterations
    return float(cost), spent


def _table(segment: Segment, solver: LinearSolver, window: int) -> Reals:
    """Iterations (n, n) of train j with the preconditioner of train i; -1 beyond the window or without convergence."""
    trains = segment.trains
    counts = np.full((len(trains),) * 2, -1.0)
    for i, train in enumerate(trains):
        ksp = _solver_of(segment, solver, train.matrix)
        for j in range(i, min(len(trains), i + window)):
            counts[i, j] = _iterations(ksp, trains[j], solver.kept.exact and i == j)
        ksp.destroy()
    return counts


def _solver_of(segment: Segment, solver: LinearSolver, matrix: PETSc.Mat) -> PETSc.KSP:
    """A Krylov method like the solver's, with the preconditioner of a matrix."""
    traits, ksp = solver.traits, PETSc.KSP().create(solver.comm)
    ksp.setOptionsPrefix("hindsight_")
    ksp.setType(traits.krylov)
    if traits.krylov == "gmres":
        ksp.setGMRESRestart(RESTART)
        ksp.setPCSide(PETSc.PC.Side.RIGHT)
    ksp.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
    ksp.setInitialGuessNonzero(True)
    ksp.setTolerances(divtol=1e30, max_it=MOST_ITERATIONS)
    given = set_preconditioner(ksp, segment.kind, segment.levels, traits.pivots, segment.blocks)
    ksp.setOperators(matrix)
    ksp.setUp()
    if solver.comm.size > 1:
        ksp.setUpOnBlocks()
    options = PETSc.Options("hindsight_")
    for key in given:
        options.delValue(key)
    ksp.getPC().setReusePreconditioner(True)
    return ksp


def _iterations(ksp: PETSc.KSP, train: Train, exact: bool) -> float:
    """Iterations of all solves of a train, from those that are repeated; -1 where one does not converge.

    With an exact factor of their very matrix (`exact`) it is one each, an application.
    """
    if exact or not train.solves:
        return float(train.count)
    spent = 0
    ksp.setOperators(train.matrix)
    for solve in train.solves:
        x = solve.guess.copy()
        ksp.setTolerances(*solve.aim)
        ksp.solve(solve.right, x)
        x.destroy()
        if ksp.getConvergedReason() < 0:
            return -1.0
        spent += ksp.getIterationNumber()
    return spent * train.count / len(train.solves)
