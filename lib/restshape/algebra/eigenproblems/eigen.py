"""Eigenproblems of one frame after the other: what is kept between them, and what each of them is solved with."""

import math
from dataclasses import dataclass

import numpy as np
from petsc4py import PETSc

from restshape.algebra.eigenproblems.davidson import Found, SearchSpace, davidson
from restshape.algebra.eigenproblems.factor_life import FactorLife
from restshape.algebra.eigenproblems.inverse_iteration import EPSILON, inverse_iteration
from restshape.algebra.eigenproblems.krylov_schur import krylov_schur
from restshape.algebra.eigenproblems.pencil import Deflation, Pencil
from restshape.algebra.eigenproblems.spectrum import apart, fallen, gap
from restshape.algebra.stages import Stages
from restshape.arrays import Reals
from restshape.calibration import Calibration
from restshape.errors import ReplayProblem
from restshape.first_use import made
from restshape.outputs.si_numbers import counted, counted_are

SPARE = 2
"""Modes beyond the wanted ones that are carried along: one that comes down from above is seen before it is wanted."""

HISTORY = 3
"""Frames whose modes the search of the next one begins with."""

COUNT_EVERY = 20
"""Frames that are solved after which the eigenvalues are counted, at the latest, whatever else asks for it before."""

ROUNDS, LOOKS = 6, 2
"""Searches at most for modes that a count has shown to be missing, and of these with the same factor."""

MOST_SOUGHT = 12
"""Of those as many at once."""

ROUNDING = 64.0 * np.finfo(float).eps
"""A residual below this share of what its products are summed up from may be rounding."""

MOST_ROUNDING = 1e-6
"""Residuals above this share are refused, though rounding may be to blame."""

ROUNDING_SLACK = 4.0
"""Residuals of later frames that rounding leaves over those that it was seen to leave."""

LEAST_MASS = 0.25
"""Least eigenvalue of the elements' masses over their diagonals: 1/2 of simplices of first order, 0.39 of triangles and
1/4 of tetrahedra of second order, with straight sides."""

ROOM = 40
"""Rows of the search space beside those that it begins with."""

MOST_ITERATIONS = 60
"""Davidson's iterations in one search: with a factor of the same matrices what has not converged by then does not."""


PRIOR_DAVIDSON, PRIOR_KRYLOV = 5.0, 3.0
"""Iterations a mode on a new mesh, and substitutions a mode from nothing, before any has been counted."""


@dataclass
class EigenReport:
    """What the solve of a frame did.

    Args:
        iterations: substitutions with a factor.
        refreshed: the factor is rebuilt.
        age: frames since it was made.
        method: "davidson", "krylov-schur" or "inverse iteration".
        inertia_checked: an inertia count has shown in this frame that no mode is missed.
        missed_modes: modes that a count has shown to be missing, found afterwards.
    """

    iterations: int
    refreshed: bool
    age: int
    method: str
    inertia_checked: bool = False
    missed_modes: int = 0

    def followed_by(self, other: "EigenReport") -> "EigenReport":
        """This solve and another one of the same frame, as one."""
        return EigenReport(
            self.iterations + other.iterations,
            self.refreshed or other.refreshed,
            other.age,
            other.method,
            other.inertia_checked,
            self.missed_modes + other.missed_modes,
        )


class EigenSolver:
    """The lowest eigenpairs of K phi = lambda M phi, frame after frame.

    Args:
        method: `direct` (Davidson iteration with a new factor in each frame on the modes of the last frames), `ilu`
            (the thesis: factor and inverse iteration with projection, from the last modes), `auto` or `stale` (Davidson
            iteration with an old factor, or Krylov-Schur, whichever counted work expects to be cheaper).
        tolerance: of the residual |K phi - lambda M phi| relative to |lambda M phi|.
        calibration: seconds a unit of counted work.
        stages: takes the time of factorisations and of iterations.
        warm: later frames start from the modes of the last ones; else each is solved by Krylov-Schur from nothing.

    Source: docs/theory/free-vibrations.md.
    """

    def __init__(
        self, method: str, tolerance: float, calibration: Calibration, stages: Stages, warm: bool = True
    ) -> None:
        self.method, self.tolerance, self.stages, self.warm = method, tolerance, stages, warm
        self.pencil = Pencil(stages, counted=True)
        self.life = FactorLife(self.pencil, calibration, method != "direct")
        self._deflation: Deflation | None = None
        self.space: SearchSpace | None = None
        self.history: list[Reals] = []
        self.unchecked = self.fresh_below = 0
        self.doubtful = False
        self.davidson_cost, self.krylov_cost = PRIOR_DAVIDSON, PRIOR_KRYLOV
        self.floor = 0.0

    @property
    def deflation(self) -> Deflation:
        """Of the rigid motions of the last solve."""
        return made(self._deflation)

    @property
    def reach(self) -> float:
        """The tolerance, or what rounding has been seen to leave of it."""
        return max(self.tolerance, self.floor)

    def restart(self, modes: Reals | None) -> None:
        """Begin a new system with this rank's columns of modes (k, n) as guess, or with none."""
        self.history = [] if modes is None else [modes]

    def solve(
        self,
        stiffness: PETSc.Mat,
        mass: PETSc.Mat,
        rigid: Reals,
        count: int,
        new_system: bool,
        verify: bool = False,
        again: bool = False,
    ) -> tuple[Found, EigenReport]:
        """The `count` lowest eigenpairs, and under `auto` some more, rigid motions left out.

        Args:
            stiffness, mass: of the frame.
            rigid: (r, n) the rigid motions, whole on each rank.
            count: wanted.
            new_system: the unknowns are others than in the last solve.
            verify: eigenvalues are counted in this frame, and found where they are missing; `ilu` never counts.
            again: the same matrices as in the last solve, for more modes: a factor that was new there still is.

        Raises:
            ReplayProblem: no convergence, or no factor.
        """
        self.pencil.set_matrices(stiffness, mass, new_system)
        if self.space is not None:
            # What it holds is of the matrices before.
            self.space.begun = None
        self.floor = 0.0 if new_system else self.floor
        self._deflation = Deflation(self.pencil.share.own(rigid), self.pencil)
        substitutions, factorisations = self.pencil.substitutions, self.pencil.factorisations
        # A mode that has just come down among the others may be lost again in the next frame.
        verify = verify or self.doubtful
        if not (self.warm and self.history):
            self.history = []
            found, report = self._cold_solve(count, "no modes to start from", verify)
        elif self.method == "ilu":
            found, report = self._thesis(count)
        else:
            found, report = self._follow(count, new_system, verify, again)
        self.doubtful = report.missed_modes > 0
        report.iterations = self.pencil.substitutions - substitutions
        report.refreshed = self.pencil.factorisations > factorisations
        self.history = [found.modes, *self.history[: HISTORY - 1]]
        return found, report

    # --- from nothing -------------------------------------------------------------------------------------------------

    def _cold_solve(self, count: int, why: str, verify: bool = True) -> tuple[Found, EigenReport]:
        """Krylov-Schur about 0 with a new factor; from nothing no better shift is known; `why` is for the log."""
        if count > self._elastic:
            raise ReplayProblem(f"{counted_are(count, 'mode')} asked for, and the mesh has {self._elastic} only")
        shift = self._start_shift()
        self.pencil.factor(shift)
        start = self.history[0].sum(axis=0) if self.history and self.method != "direct" else None
        wanted = min(count + SPARE, self._elastic)
        with self.stages("krylov"):
            found = krylov_schur(self.pencil, self.deflation, start, wanted, self.tolerance)
        self.krylov_cost = found.iterations / wanted
        self.life.begin(f"Krylov-Schur, {why}")
        report = EigenReport(0, True, 0, "krylov-schur")
        if self.method in ("auto", "stale") or (verify and self.method == "direct"):
            self.history = []
            # The factor's shift is that which serves the frames to come.
            found = self._completed(found, count, report)
        elif self.method == "direct":
            self.unchecked += 1
        return found, report

    def _rounding(self, found: Found, count: int) -> float:
        """What rounding leaves of residuals that do not come to meet the tolerance; as before if it is not to blame.

        Raises:
            ReplayProblem: it leaves more than `MOST_ROUNDING`.
        """
        rows, worst = found.modes[:count], float(found.residuals[:count].max())
        mass_products = np.empty_like(rows)
        self.pencil.apply(self.pencil.mass, rows, mass_products)
        norms = self.pencil.share.norms
        sizes = norms(rows) / (np.abs(found.values[:count]) * norms(mass_products))
        largest = self.pencil.stiffness.norm(PETSc.NormType.NORM_INFINITY)
        ratio = largest * float(sizes.max())
        left = ROUNDING * ratio
        if MOST_ROUNDING < worst <= left:
            raise ReplayProblem(
                f"modes do not converge: rounding leaves a residual of {worst:.1e}, and {MOST_ROUNDING:g} is let pass:"
                f" elements are {ratio:.0e} times as stiff as the body (thin ones, or nu near 0.5)"
            )
        return ROUNDING_SLACK * worst if worst <= min(MOST_ROUNDING, left) else self.floor

    @property
    def _elastic(self) -> int:
        """Eigenvalues that are finite, for there is mass, and not of rigid motions."""
        return self.pencil.dofs_with_mass - self.deflation.count

    def _start_shift(self) -> float:
        """A shift a little below 0, where K - s M is positive definite, small beside the eigenvalues looked for.

        The Rayleigh quotient of a vector that is smoothed by nothing is far too large; so the lowest eigenvalue is
        guessed from the traces, which see the elements, and the number of unknowns, which sees the body.
        """
        ends = (self.stiffness_trace() / self.mass_trace(), float(self.pencil.size))
        return -1e-3 * ends[0] / ends[1] ** 2

    def stiffness_trace(self) -> float:
        """The sum of the diagonal of K."""
        return self._trace(self.pencil.stiffness)

    def mass_trace(self) -> float:
        """The sum of the diagonal of M."""
        return self._trace(self.pencil.mass)

    @staticmethod
    def _trace(matrix: PETSc.Mat) -> float:
        diagonal = matrix.getDiagonal()
        total = diagonal.sum()
        diagonal.destroy()
        return total

    def _thesis(self, count: int) -> tuple[Found, EigenReport]:
        """Inverse iteration on K + eps M, factored in each frame."""
        starts = self.history[0][:count]
        if len(starts) < count:
            return self._cold_solve(count, "more modes than before")
        guess = _rayleigh(self.pencil, starts[:1])
        self.pencil.factor(-EPSILON * guess)
        with self.stages("krylov"):
            found = inverse_iteration(self.pencil, self.deflation, starts, count, self.reach)
        return found, EigenReport(0, True, 0, "inverse iteration")

    # --- from the frames before ---------------------------------------------------------------------------------------

    def _follow(self, count: int, new_system: bool, verify: bool, again: bool) -> tuple[Found, EigenReport]:
        """Davidson's iteration with an old factor; where that is too dear, with a new one; else Krylov-Schur."""
        self.life.age += not again
        self.unchecked += not again
        report = EigenReport(0, False, self.life.age, "davidson")
        price = self.life.price()
        if new_system and self.krylov_cost * (count + SPARE) < self.davidson_cost * count:
            return self._cold_solve(count, "another system, on which Davidson's iteration is expected to cost more")
        why = "" if self.life.age == 0 else self.life.stale(new_system, price)
        if verify and not why and self.life.age:
            # A factor is due in any case, to count with: of these matrices it also takes the fewest iterations.
            why = "eigenvalues are counted in this frame"
        if why:
            self._refresh(count, why)
        fresh = self.life.age == 0
        found = self._iterate(count, self._limit(count, price, fresh))
        if not found.converged and not fresh:
            self.history = [found.modes, *self.history]
            self._refresh(count, f"no convergence in {found.iterations} iterations with the old one")
            found = self._iterate(count, self._limit(count, price, True))
        if not found.converged:
            self.history = [found.modes]
            return self._cold_solve(count, f"no convergence in {found.iterations} of Davidson's iterations")
        if new_system:
            self.davidson_cost = found.iterations
        self.life.spend(found.iterations, count)
        try:
            found = self._checked(found, count, verify, report)
        except ReplayProblem as problem:
            self.history = []
            found, cold = self._cold_solve(count, str(problem))
            cold.missed_modes += report.missed_modes
            return found, cold
        report.age = self.life.age
        return found, report

    def _iterate(self, count: int, limit: int) -> Found:
        starts, space = self._starts(count), self._search_space(count)
        with self.stages("krylov"):
            space.found = davidson(space, self.deflation, starts, count, SPARE, self.reach, limit)
        return space.found

    def _starts(self, count: int) -> list[Reals]:
        """Blocks of modes that a search begins with: of older frames only what was wanted, which had converged."""
        return [self.history[0], *(block[:count] for block in self.history[1:HISTORY])]

    def _search_space(self, count: int) -> SearchSpace:
        """The space of a search that begins with the modes of the last frames."""
        capacity = sum(map(len, self._starts(count))) + max(ROOM, 4 * (count + SPARE))
        if self.space is None or not self.space.holds(capacity):
            self.space = SearchSpace(self.pencil, capacity)
        return self.space

    def _limit(self, count: int, price: float, fresh: bool) -> int:
        """Iterations after which what is left is dearer than a new factor, or than Krylov-Schur from nothing."""
        most = self.krylov_cost * (count + SPARE) + price
        return min(MOST_ITERATIONS, max(4, math.ceil(most / count) + (2 if fresh else 0)))

    def _refresh(self, count: int, why: str) -> None:
        """A new factor, at a shift between the eigenvalues that are wanted and the next as the last modes estimate
        them; `why` is for the log."""
        space = self._search_space(count)
        space.begin_with(self.deflation, self.history[0])
        shift, _ = gap(space.ritz_values(), count)
        self.fresh_below = self.pencil.factor(shift)
        self.life.begin(why)

    # --- counting -----------------------------------------------------------------------------------------------------

    def _checked(self, found: Found, count: int, verify: bool, report: EigenReport) -> Found:
        """`found`, with what a count has shown to be missing: free with a new factor, else where one is due."""
        free = self.life.age == 0 and self.pencil.shift > found.values[:count][-1]
        missing = self._missing(found) if free else 0
        if free and not missing and apart(found, count, self.pencil.shift, self.reach, self._distances(found)):
            self.unchecked, report.inertia_checked = 0, True
            return found
        if missing <= 0 and not verify and self.unchecked < COUNT_EVERY:
            return found
        return self._completed(found, count, report)

    def _completed(self, found: Found, count: int, report: EigenReport) -> Found:
        """`found`, with all modes below the shift of a new factor behind the wanted ones, which counts them.

        What is missing is sought from random rows that the factor has smoothed: among equal eigenvalues, or on bodies
        that do not couple, no search that starts at known modes comes to the others.

        Raises:
            ReplayProblem: some are missing even so, or do not converge.
        """
        first, stalled, looks = found, False, 0
        for turn in range(ROUNDS):
            # A count stays what it is: of a factor of these matrices it also serves what has been sought since.
            if self.life.age or looks == LOOKS or self.pencil.shift <= found.values[:count][-1]:
                self.fresh_below = self.pencil.factor(gap(found.values, count)[0])
                self.life.begin("eigenvalues below it are counted by its inertia")
                looks = 0
            looks += 1
            shift, missing = self.pencil.shift, self._missing(found)
            if missing <= 0 and (stalled or turn == ROUNDS - 1):
                self.floor = self._rounding(found, count)
            if missing <= 0 and apart(found, count, shift, self.reach, self._distances(found)):
                report.inertia_checked = missing == 0
                self.unchecked = 0 if report.inertia_checked else self.unchecked
                report.missed_modes = max(report.missed_modes, fallen(first, found, count, self.reach))
                return found
            report.missed_modes = max(report.missed_modes, missing)
            sought = self._sought(found, count, min(max(0, missing), MOST_SOUGHT), turn)
            stalled = not sought.converged and sought.iterations >= MOST_ITERATIONS
            # Where rounding holds a search up, it may end farther off than it began.
            if not (stalled and missing <= 0 and sought.residuals[:count].max() > found.residuals[:count].max()):
                found = sought
        raise ReplayProblem(
            f"{counted(missing, 'mode')} {'was' if missing == 1 else 'were'} not found"
            if missing > 0
            else f"modes do not converge (residual {found.residuals[:count].max():.1e})"
        )

    def _distances(self, found: Found) -> Reals:
        """How far (k,) an eigenvalue is from each value at most: the residual's norm in the inverse of the mass.

        Source: B. N. Parlett, The Symmetric Eigenvalue Problem, chapter 15; A. J. Wathen, IMA J. Numer. Anal. 7
            (1987) 449, for the bound of the mass by its diagonal.
        """
        pencil, rows, forces = self.pencil, found.modes, found.forces
        if forces is None:
            stiff, mass_products = np.empty_like(rows), np.empty_like(rows)
            pencil.apply(pencil.stiffness, rows, stiff)
            pencil.apply(pencil.mass, rows, mass_products)
            forces = stiff - found.values[:, None] * mass_products
        diagonal = pencil.mass.getDiagonal()
        weights = diagonal.getArray().copy()
        diagonal.destroy()
        weights[weights == 0.0] = np.inf
        return np.sqrt(pencil.share.summed((forces**2 / weights).sum(axis=1)) / LEAST_MASS)

    def _missing(self, found: Found) -> int:
        """How many more eigenvalues the kept factor has counted below its shift than were found there."""
        return self.fresh_below - self.deflation.count - int(np.sum(found.values < self.pencil.shift))

    def _sought(self, found: Found, count: int, missing: int, turn: int) -> Found:
        """`found` with as many modes more, as far as random rows lead to them."""
        wanted = max(count, int(np.sum(found.values < self.pencil.shift)) + missing)
        limit = min(MOST_ITERATIONS, math.ceil(self.krylov_cost * (wanted + SPARE)))
        if not missing and self.space is not None and found is self.space.found:
            with self.stages("krylov"):
                return davidson(self.space, self.deflation, [], wanted, SPARE, self.reach, limit)
        starts = [found.modes]
        if missing:
            shape = (missing + SPARE, self.pencil.size)
            rows = self.pencil.share.own(np.random.default_rng(7 + turn).uniform(-1.0, 1.0, shape))
            mass_products = np.empty_like(rows)
            # What supports hold has no mass, so that nothing of it is left.
            self.pencil.apply(self.pencil.mass, rows, mass_products)
            starts.append(self.pencil.solve(self.pencil.solve(mass_products)))
        space = SearchSpace(self.pencil, sum(map(len, starts)) + max(ROOM, 4 * (wanted + SPARE)))
        with self.stages("krylov"):
            return davidson(space, self.deflation, starts, wanted, SPARE, self.reach, limit)


def _rayleigh(pencil: Pencil, rows: Reals) -> float:
    """The Rayleigh quotient of one row (1, n)."""
    stiff, mass_products = np.empty_like(rows), np.empty_like(rows)
    pencil.apply(pencil.stiffness, rows, stiff)
    pencil.apply(pencil.mass, rows, mass_products)
    summed = pencil.share.summed
    return float(summed(np.vdot(rows, stiff)) / summed(np.vdot(rows, mass_products)))
