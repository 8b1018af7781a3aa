"""Critical load factors of one frame after the other: what is kept between them, and how they are counted."""

import math

import numpy as np
from petsc4py import PETSc

from restshape.algebra.eigenproblems.davidson import Found, SearchSpace, davidson, ritz_values
from restshape.algebra.eigenproblems.eigen import (
    COUNT_EVERY,
    HISTORY,
    MOST_SOUGHT,
    ROOM,
    ROUNDING,
    ROUNDS,
    SPARE,
    EigenReport,
)
from restshape.algebra.eigenproblems.factor_life import FactorLife
from restshape.algebra.eigenproblems.load_pencil import UNLOADED, LoadPencil, load_modes
from restshape.algebra.eigenproblems.pencil import Deflation
from restshape.algebra.eigenproblems.spectrum import apart, fallen
from restshape.algebra.stages import Stages
from restshape.arrays import Integers, Reals
from restshape.calibration import Calibration
from restshape.errors import ReplayProblem

WIDEST = 1.5
"""A count goes so far beyond the last load factor at most, for what lies farther is hardly known."""
BESIDE = 1.01
"""The largest load factor over the one up to which is counted: at a mean strain of 1 itself the stiffness of a bar
cancels, and its matrix has no factor."""

LEAST, USUAL = 4, 12
"""Iterations that are always granted, and with a new factor."""


class BucklingSolver:
    """The lowest positive load factors mu of K phi = -mu G phi, frame after frame.

    Args:
        warm: begin at the modes of the last frames; else each frame is solved from nothing.
        kept: an old factor serves for as long as counted work says that it pays.
        tolerance: of the residual |K phi + mu G phi| relative to |K phi|.
        calibration: seconds a unit of counted work.
        stages: takes the time of factorisations and of iterations.

    Attributes:
        reach: the tolerance, or what rounding may leave of it.
        left: the largest residual of the modes that were found last.

    Source: docs/theory/buckling.md.
    """

    def __init__(self, warm: bool, kept: bool, tolerance: float, calibration: Calibration, stages: Stages) -> None:
        self.warm, self.tolerance, self.stages = warm, tolerance, stages
        self.pencil = LoadPencil(stages)
        self.life = FactorLife(self.pencil, calibration, kept)
        self.space: SearchSpace | None = None
        self.history: list[Reals] = []
        self.unchecked = self.known = 0
        self.doubtful = False
        self.reach, self.left = tolerance, 0.0

    def restart(self, modes: Reals | None) -> None:
        """Begin a new system with this rank's columns of modes (k, n) as guess, or with none."""
        self.history = [] if modes is None or not len(modes) else [modes]

    def solve(
        self,
        stiffness: PETSc.Mat,
        geometric: PETSc.Mat,
        constrained: Integers,
        count: int,
        most: float,
        new_system: bool,
        verify: bool = False,
    ) -> tuple[Found, EigenReport]:
        """The lowest positive load factors, as eigenvalues -1/mu in ascending order, at most `count` of them.

        Args:
            stiffness: K, positive definite.
            geometric: G, on the same pattern.
            constrained: indices of unknowns that supports hold, among those of all ranks.
            count: wanted.
            most: load factors beyond this one are none; infinite where there is no load.
            new_system: the unknowns are others than in the last solve.
            verify: load factors are counted in this frame, and found where they are missing.

        Raises:
            ReplayProblem: no convergence, or no factor.
        """
        pencil = self.pencil
        pencil.set_matrices(geometric, stiffness, new_system)
        self.deflation = Deflation(np.empty((0, pencil.share.count)), pencil)
        self.constrained = constrained
        substitutions, factorisations = pencil.substitutions, pencil.factorisations
        self.report = EigenReport(0, False, 0, "davidson")
        found = None
        if self.warm and self.history:
            # A mode that has just come down among the others may be lost again in the next frame.
            found = self._follow(min(count, self.known), new_system, verify or self.doubtful)
        end = -BESIDE / most
        if found is not None and len(lowest_below(found, end, count)) < count:
            # Fewer than asked for: so that none comes unseen, they are counted in each frame.
            self.report.inertia_checked, self.unchecked = True, 0
            if end == 0.0 or pencil.below(end) != len(lowest_below(found, end, count)):
                found = None
        if found is None:
            found = self._cold_solve(count, end)
        within = lowest_below(found, end, count)
        self.known = len(within)
        self.left = float(found.residuals[: self.known].max(initial=0.0))
        self.history = [found.modes, *self.history[: HISTORY - 1]] if len(within) else []
        report = self.report
        self.doubtful = report.missed_modes > 0
        report.iterations = pencil.substitutions - substitutions
        report.refreshed, report.age = pencil.factorisations > factorisations, self.life.age
        return Found(within, found.modes[: len(within)], found.residuals[: len(within)], 0, True), report

    # --- from nothing -------------------------------------------------------------------------------------------------

    def _cold_solve(self, count: int, end: float) -> Found:
        """Count first, for where there is none an iteration would not end; then Krylov-Schur with a factor of K."""
        pencil, report = self.pencil, self.report
        report.method, report.inertia_checked = "krylov-schur", True
        self.life.age = self.unchecked = 0
        there = pencil.below(end) if end < 0.0 else 0
        if not there:
            return Found(np.empty(0), np.empty((0, pencil.share.count)), np.empty(0), 0, True)
        pencil.factor(UNLOADED)
        start = self.history[0].sum(axis=0) if self.history and self.warm else self._random(1)[0]
        with self.stages("krylov"):
            modes = load_modes(pencil, start, min(count + SPARE, there), self.tolerance)
        self.history = []
        return self._converge([modes], min(count, there), "Krylov-Schur, no modes to start from")

    def _converge(self, starts: list[Reals], count: int, why: str) -> Found:
        """Iterate with a new factor, at a load factor behind the wanted ones, which counts those before it.

        Args:
            starts: blocks of modes (k, n) to start from, the last ones first.
            count: wanted.
            why: there is a new factor, for the log.

        Raises:
            ReplayProblem: some are missing even so, or do not converge.
        """
        missing, wanted = 0, count
        for turn in range(ROUNDS):
            # The last modes alone: what else older ones span looks like load factors that there are not.
            values = ritz_values(self.pencil, self.deflation, starts[0])
            if values[0] >= 0.0:
                raise ReplayProblem("buckling: the modes at hand belong to no positive load factor")
            shift, _ = gap(values, count)
            inertia_count = self.pencil.factor(shift)
            self.unchecked = 0
            self.life.begin(f"{missing} load factors are missing" if missing else why)
            self._see_rounding(starts[0][:count])
            if missing:
                starts = [*starts, self.pencil.solve(self._random(min(missing, MOST_SOUGHT) + SPARE, turn))]
            # As long as known modes alone were asked for, the search would end at them.
            found = self._iterate(starts, min(wanted, max(count, inertia_count)), USUAL)
            known = int(np.sum(found.values < shift))
            missing = max(0, inertia_count - known)
            if not missing and apart(found, count, shift, self.reach):
                self.report.inertia_checked = True
                return found
            self.report.missed_modes = max(self.report.missed_modes, missing)
            starts, wanted = [found.modes], max(count, known + min(missing, MOST_SOUGHT))
        raise ReplayProblem(
            f"buckling: {missing} load factors were not found"
            if missing
            else f"buckling: load factors do not converge (residual {found.residuals[:count].max():.1e})"
        )

    def _random(self, count: int, turn: int = 0) -> Reals:
        """This rank's columns of rows (count, n) that have a share of every mode; 0 where the body is constrained."""
        rows = np.random.default_rng(7 + turn).uniform(-1.0, 1.0, (count, self.pencil.size))
        rows[:, self.constrained] = 0.0
        return self.pencil.share.own(rows)

    # --- from the frames before ---------------------------------------------------------------------------------------

    def _follow(self, count: int, new_system: bool, verify: bool) -> Found | None:
        """Davidson's iteration with an old factor; where that is too dear, with a new one; None where that fails."""
        self.life.age, self.unchecked = self.life.age + 1, self.unchecked + 1
        price = self.life.price()
        why = self.life.stale(new_system, price)
        if why:
            return self._verified(self.history[:HISTORY], count, why)
        found = self._iterate(self.history, count, max(LEAST, math.ceil(price / count)))
        if not found.converged:
            why = f"no convergence in {found.iterations} iterations with the old one"
            return self._verified([found.modes, *self.history[: HISTORY - 1]], count, why)
        self.life.spend(found.iterations, count)
        if verify or self.unchecked >= COUNT_EVERY:
            verified = self._verified([found.modes], count, "load factors before it are counted by its inertia")
            if verified is not None:
                self.report.missed_modes = max(self.report.missed_modes, fallen(found, verified, count, self.reach))
            return verified
        return found

    def _verified(self, starts: list[Reals], count: int, why: str) -> Found | None:
        """The iteration with a new factor from known modes; None where that fails."""
        try:
            return self._converge(starts, count, why)
        except ReplayProblem:
            # What has failed as a start is none for the solve from nothing.
            self.history = []
            return None

    def _iterate(self, starts: list[Reals], count: int, limit: int) -> Found:
        # Of older frames only what was wanted, which had converged.
        blocks = [starts[0], *(block[: count + SPARE] for block in starts[1:])]
        capacity = sum(map(len, blocks)) + max(ROOM, 4 * (count + SPARE))
        if self.space is None or not self.space.holds(capacity):
            self.space = SearchSpace(self.pencil, capacity)
        with self.stages("krylov"):
            return davidson(self.space, self.deflation, blocks, count, SPARE, self.reach, limit)

    def _see_rounding(self, rows: Reals) -> None:
        """Set `reach` to what residuals of modes such as rows (k, n) can be brought down to."""
        forces = np.empty_like(rows)
        self.pencil.apply(self.pencil.mass, rows, forces)
        sizes = self.pencil.share.norms(rows) / self.pencil.share.norms(forces)
        largest = self.pencil.mass.norm(PETSc.NormType.NORM_INFINITY)
        self.reach = max(self.tolerance, ROUNDING * largest * float(sizes.max()))


def lowest_below(found: Found, end: float, count: int) -> Reals:
    """The eigenvalues below `end`, at most `count`."""
    values = found.values[:count]
    return values[values < end]


def gap(values: Reals, count: int) -> tuple[float, int]:
    """A shift behind the `count` lowest of eigenvalues -1/mu (k,), in the widest gap, and how many lie below it.

    The first is below 0. The shift is never far beyond the last load factor before it.
    """
    factors = np.where(values < 0.0, -1.0 / np.where(values < 0.0, values, -1.0), np.inf)
    last = len(factors) - 1
    places = [k for k in range(min(count, last), last + 1) if k > 0 and np.isfinite(factors[k - 1])]
    if not places:
        return -1.0 / (WIDEST * float(factors[0])), 1
    k = max(places, key=lambda place: factors[place] / factors[place - 1])
    before = float(factors[k - 1])
    return -1.0 / min(WIDEST * before, before + 0.4 * (float(factors[k]) - before)), k
