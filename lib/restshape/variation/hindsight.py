"""What the refreshes of a replay cost beside the best schedule in hindsight."""

import math
from dataclasses import dataclass, field
from typing import Self, TypedDict

from petsc4py import PETSc

from restshape.algebra.at_exit import destroyed_at_exit
from restshape.algebra.krylov_method import set_krylov, solve_from
from restshape.algebra.linear import MOST_ITERATIONS, LinearSolver
from restshape.algebra.linear_report import LinearReport
from restshape.algebra.preconditioner import cycle_in_single, set_preconditioner, set_rigid_motions
from restshape.algebra.reuse.prices import Prices, Size
from restshape.algebra.reuse.schedule import Schedule
from restshape.arrays import Reals
from restshape.first_use import made

WINDOW = 40
"""Matrices that a preconditioner is looked at for, in hindsight."""
SLACK = 1.0
"""Set-ups that a preconditioner may have cost beyond the best schedule, and still be looked at."""
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
        applied: of the iterations, applications of its own factor, which take no product with the matrix.
    """

    frame: int
    matrix: PETSc.Mat
    flipped: bool = False
    solves: list[Solve] = field(default_factory=list)
    count: int = 0
    iterations: int = 0
    applied: int = 0
    refreshed: bool = False

    def destroy(self) -> None:
        """Free PETSc's objects."""
        self.matrix.destroy()
        for solve in self.solves:
            solve.right.destroy()
            solve.guess.destroy()


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


@dataclass(frozen=True)
class Manner:
    """How a solver makes its preconditioners, and what they cost.

    Args:
        name: in tables.
        kind, levels, blocks, exchanges: as `set_preconditioner` has them; krylov: PETSc's type of the iteration.
        applies: it is a complete Cholesky factor, which is applied to its own matrix, without an iteration.
        price: of it; product: seconds of a product with the matrix.
        shared: ranks share it.
    """

    name: str
    kind: str
    levels: int
    blocks: bool
    exchanges: bool
    krylov: str
    applies: bool
    price: Prices
    product: float
    shared: bool

    @classmethod
    def of(cls, solver: LinearSolver) -> Self:
        """That of the preconditioner which the solver has."""
        kept = solver.kept
        levels, krylov = (kept.candidate.levels, kept.candidate.krylov) if kept.candidate else (0, "")
        krylov = krylov or solver.traits.krylov
        applies, price = kept.exact and kept.kind == "cholesky", kept.price()
        ways = kept.kind, levels, kept.blocks, kept.exchanges, krylov
        return cls(kept.name, *ways, applies, price, price.product, kept.shared)

    def seconds(self, iterations: float, applied: float) -> float:
        """Of iterations, among them applications of a factor to its own matrix."""
        return self.price.iteration * iterations - self.product * applied


class Segment:
    """Trains from one new mesh, or test of stability, to the next: what was run, and the best schedule.

    Args:
        solver: has just made the first preconditioner.
        tested: by a test of stability, whose factor is no choice.
        window: matrices that a preconditioner is looked at for.
    """

    def __init__(self, solver: LinearSolver, tested: bool, window: int) -> None:
        self.solver, self.manner = solver, Manner.of(solver)
        setup = self.manner.price.setup
        self.first = 0.0 if tested else setup
        self.schedule = Schedule(window, slack=SLACK * setup)
        self.run, self.spent, self.refreshed, self.last = 0.0, 0, list[int](), 0
        self._frames, self._flips = list[int](), list[int]()
        self._counts: dict[int, list[float]] = {}
        self._solvers: dict[int, PETSc.KSP] = {}

    def add(self, train: Train) -> None:
        """Take in a train that has ended, and let go of it."""
        now = self.schedule.frames
        self._frames.append(train.frame)
        self._flips.append((self._flips[-1] if self._flips else 0) + train.flipped)
        if train.refreshed:
            self.run, self.last = self.run + self._refresh(self.last), now
            self.refreshed.append(train.frame)
        self.run += self.manner.seconds(train.iterations, train.applied)
        self.spent += train.iterations
        self._counts[now], self._solvers[now] = [], _solver_of(self.solver, self.manner, train.matrix)
        self.schedule.add(self._refresh, lambda i: self._cost(i, train))
        kept = {one.frame for one in self.schedule.kept}
        for i in self._solvers.keys() - kept:
            self._solvers.pop(i).destroy()
        train.destroy()

    def best(self) -> tuple[float, list[int], int]:
        """Seconds of the best schedule, the frames in which it refreshes, and its iterations."""
        least, refreshes = self.schedule.best()
        ends = [*refreshes[1:], self.schedule.frames]
        iterations = sum(sum(self._counts[i][: end - i]) for i, end in zip(refreshes, ends))
        return least, [self._frames[i] for i in refreshes], int(iterations)

    def destroy(self) -> None:
        """Free PETSc's objects."""
        for ksp in self._solvers.values():
            ksp.destroy()
        self._solvers.clear()

    def _refresh(self, i: int) -> float:
        """Seconds of a refresh now, after one at train i: a patch between the two asks for a new analysis."""
        if len(self._flips) == 1:
            return self.first
        price = self.manner.price
        return price.setup if self._flips[-1] > self._flips[i] else price.refresh

    def _cost(self, i: int, train: Train) -> float:
        """Seconds of a train, the present one, with the preconditioner of train i; inf without convergence."""
        applied = self.manner.applies and i == self.schedule.frames
        count = _iterations(self._solvers[i], train, applied)
        self._counts[i].append(count)
        return self.manner.seconds(count, applied * count) if count >= 0 else math.inf


class Watch:
    """Notes the solves of a linear solver, segment by segment; the iteration that a replay goes on from sees no change.

    Each matrix is solved with the preconditioners of earlier ones, from the guesses that the replay has. A new mesh
    begins a segment, whose first matrix always makes one; so does a test of stability, whose factor is no choice. In
    hindsight a frame of level 2 may be refreshed like any other, but no preconditioner is made between two solves with
    one matrix.

    Args:
        solver: keeps its preconditioner for as long as it is worth it.
        window: matrices that a preconditioner is looked at for; 1 at least.
    """

    def __init__(self, solver: LinearSolver, window: int = WINDOW) -> None:
        self.solver, self.window = solver, window
        self.frame, self._state, self._size, self._new = 0, (0, -1), Size(0, 0.0), True
        self._pending: tuple[Train, Solve] | None = None
        self._segments, self._trains = list[Segment](), list[tuple[Segment, Train]]()
        solver.on_solve, solver.on_solved = self._before, self._after

    def _before(self, mat: PETSc.Mat, b: PETSc.Vec, x: PETSc.Vec, new: bool, places: Reals | None) -> None:
        self._new |= new
        state = mat.handle, mat.stateGet()
        if state != self._state or new or not self._trains:
            copy = mat.copy()
            if places is not None and copy.getBlockSize() == places.shape[1]:
                set_rigid_motions(copy, places)
            # Patterns only grow until the next mesh.
            size = self.solver.kept.size
            train = Train(self.frame, copy, flipped=size != self._size)
            self._state, self._size = state, size
        else:
            train = self._trains[-1][1]
        self._pending = train, Solve(b.copy(), x.copy())

    def _after(self, report: LinearReport | None) -> None:
        train, solve = made(self._pending)
        # Another candidate than before is another segment.
        self._new |= bool(self._segments) and self._segments[-1].manner.name != self.solver.name
        if self._new or report is None or not self._segments:
            self._segments.append(Segment(self.solver, report is None, self.window))
        self._new = False
        segment, known = self._segments[-1], self._trains[-1] if self._trains else (None, None)
        if known[1] is train and known[0] is not segment:
            train = Train(self.frame, train.matrix.copy())
        if known[1] is not train:
            self._trains.append((segment, train))
        # Not those of the Krylov method, which a factor that is applied to its own matrix leaves as they were.
        solve.aim = self.solver.tolerances
        if report is None:
            train.refreshed = True
            return
        train.count += 1
        train.iterations += report.iterations
        train.applied += segment.manner.applies and self.solver.factored
        train.refreshed |= report.refreshed
        if len(train.solves) < SAMPLED:
            train.solves.append(solve)

    def settle(self, ended: bool = False) -> None:
        """Look at the trains that have ended, all of them where the replay has; between two frames."""
        self.frame += 1
        ready = self._trains if ended else self._trains[:-1]
        for segment, train in ready:
            segment.add(train)
        self._trains = self._trains[len(ready) :]
        for segment in self._segments if ended else self._segments[:-1]:
            segment.destroy()

    def found(self) -> Beside:
        """The schedule of refreshes that was run, and the best one; the replay has ended."""
        self.solver.on_solve = self.solver.on_solved = None
        self.settle(ended=True)
        segments = [(one, *one.best()) for one in self._segments]
        run, best = sum(one.run for one in self._segments), sum(least for _, least, _, _ in segments)
        schedule = {
            "run": [frame for one in self._segments for frame in one.refreshed],
            "best": [frame for _, _, frames, _ in segments for frame in frames],
        }
        return {
            "run": run,
            "best": best,
            "ratio": run / best if best > 0 else 1.0,
            "schedule": schedule,
            "iterations": {
                "run": sum(one.spent for one in self._segments),
                "best": sum(spent for _, _, _, spent in segments),
            },
            "refreshes": {name: len(frames) for name, frames in schedule.items()},
            "matrices": sum(one.schedule.frames for one in self._segments),
        }


def _solver_of(solver: LinearSolver, manner: Manner, matrix: PETSc.Mat) -> PETSc.KSP:
    """A Krylov method like the solver's, with the preconditioner of a matrix."""
    traits, ksp = solver.traits, PETSc.KSP().create(solver.comm)
    ksp.setOptionsPrefix("hindsight_")
    set_krylov(ksp, manner.krylov)
    ksp.setTolerances(divtol=1e30, max_it=MOST_ITERATIONS)
    shifts = traits.symmetric or traits.definite
    with_rows = (solver.kept.overlap, traits.symmetric)
    if manner.shared:
        from restshape.algebra.factors.shared_solves import set_shared_factor

        set_shared_factor(destroyed_at_exit(ksp), traits.fields or traits.dimension)
        given = []
    else:
        given = set_preconditioner(ksp, manner.kind, manner.levels, manner.exchanges, manner.blocks, shifts, *with_rows)
    ksp.setOperators(matrix)
    ksp.setUp()
    if solver.comm.size > 1:
        ksp.setUpOnBlocks()
    if manner.kind == "gamg":
        cycle_in_single(ksp.getPC())
    options = PETSc.Options("hindsight_")
    for key in given:
        options.delValue(key)
    ksp.getPC().setReusePreconditioner(True)
    return ksp


def _iterations(ksp: PETSc.KSP, train: Train, applied: bool) -> float:
    """Iterations of all solves of a train, from those that are repeated; -1 where one does not converge.

    A complete factor of their very matrix is `applied`, once each.
    """
    if applied or not train.solves:
        return float(train.count)
    spent = 0
    ksp.setOperators(train.matrix)
    for solve in train.solves:
        x = solve.guess.copy()
        ksp.setTolerances(*solve.aim)
        solve_from(ksp, solve.right, x)
        x.destroy()
        if ksp.getConvergedReason() < 0:
            return -1.0
        spent += ksp.getIterationNumber()
    return spent * train.count / len(train.solves)
