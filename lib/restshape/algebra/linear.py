"""Linear solves with a preconditioner that is kept for as long as it is worth it."""

import logging
import math
from collections.abc import Callable

from petsc4py import PETSc

from restshape.algebra.krylov_method import set_krylov, solve_from
from restshape.algebra.linear_report import LinearReport, true_residual
from restshape.algebra.preconditioner import COMPLETE
from restshape.algebra.projection import Projection
from restshape.algebra.reuse.candidates import DECADES
from restshape.algebra.reuse.choice import MEMORY, Choice
from restshape.algebra.reuse.kept_preconditioner import KeptPreconditioner
from restshape.algebra.reuse.refresh import RefreshCriterion
from restshape.algebra.reuse.traits import Traits
from restshape.algebra.solve_counts import SolveCounts
from restshape.algebra.stages import Stages
from restshape.arrays import Indices, Reals
from restshape.calibration import Calibration
from restshape.errors import ReplayProblem

log = logging.getLogger("restshape.algebra")

__all__ = ["COMPLETE", "METHODS", "MOST_ITERATIONS", "LinearSolver"]

METHODS = ("direct", "stale", "auto", "ilu")
MOST_ITERATIONS = 10_000
"""An iteration that has not ended by then never will: the preconditioner is rebuilt, or the frame given up."""
PROJECTED, PROJECTED_MULTIGRID = 0.2, 0.3
"""Part of the iterations of a solve that projection of the guess saves, one at least: measured on the dragged plate."""
INCOMPLETE = 0.25
"""An incomplete preconditioner leaves smooth errors, whose energy the residual reports too small (by up to 2.2 on the
plate): its solves end at this share of the tolerance, so that solutions agree within it in the energy norm."""
INCOMPLETE_FLOW = 0.1
"""The same of systems that are not symmetric: by up to 4.2 on `flow.toml`, with ILU(0)."""
FRESH = 4
"""Iterations with a new complete factor that exchanges no rows, beyond which its pivots are too small."""
INACCURATE = 1e-6
"""Residual over the right side that such a factor leaves by itself, likewise."""
LEAST_DECADES = 0.3
"""Powers of ten by which any solve makes its residual smaller."""
MARGIN = 1.5
"""What rounding leaves of the residual of a new factor grows like the solution; on one mesh hardly by more than this
factor besides."""
NO_FACTOR = "the stiffness matrix has no factor: part of the body is not constrained, or has no stiffness"
NO_EXCHANGED = (
    "the matrix has no factor, nor one with its rows exchanged: part of the shape has no condition; see its boundaries"
)
Reason = PETSc.KSP.ConvergedReason
REASONS = {value: name for name, value in vars(Reason).items() if isinstance(value, int)}


# More than 15 attributes: half of them are the solver, the others what it was given last, and who watches.
class LinearSolver:
    """One KSP whose preconditioner outlives the matrix that it was made from.

    Args:
        comm: PETSc communicator.
        prefix: of its options in PETSc's database.
        method: `direct` (a new complete Cholesky factor for each matrix, no Krylov iteration), `stale` (CG with an old
            complete factor, refreshed when that pays), `auto` (the same with the preconditioner that each new system's
            `Choice` prefers, or that PETSc's options name), `ilu` (CG with ILU(3), of flow
            BiCGStab with ILU(0), kept until the mesh is another one).
        tolerance: of the true residual, relative to the right side.
        calibration: seconds a unit of counted work, for the choice and the refresh.
        stages: takes the time of factorisations and of Krylov iterations.
        memory: bytes that a complete factor may take under `auto`.
        directions: increments of the solution along which guesses are improved; 0 for none.
        traits: of all matrices: where they are not symmetric and definite, GMRES takes the place of CG; a complete
            factor is LU where they are not symmetric, and one with exchanges of rows (MUMPS) where they are symmetric
            and not definite. `auto` is `stale` where the choice has no candidates for them.

    Attributes:
        kept: the preconditioner; refresh: the criterion of when it is made again.
        keeps: an old preconditioner serves until a new one pays; takes_guess: solves start from a guess.
        age: solves since it was made; callers add frames that solve nothing to it.
        counts: of all solves so far.
        on_solve: called with matrix, right side, guess, whether the system is new, and places, before each solve.
        on_solved: called with the report of each solve; with None where a factor was made that no solve asked for.

    On several ranks factors are those of the ranks' own rows (block Jacobi), or one that they share, so that the bits
    repeat. That of symmetric matrices that are not definite is of the whole matrix: their blocks may have none.
    An idle frame solves nothing and refreshes nothing, for a frame with nothing to do does nothing.

    Source: docs/theory/levels-of-reuse.md (rent or buy).
    """

    def __init__(
        self,
        comm: PETSc.Comm,
        prefix: str,
        method: str,
        tolerance: float,
        calibration: Calibration,
        stages: Stages,
        memory: float = MEMORY,
        directions: int = 0,
        *,
        traits: Traits,
    ) -> None:
        self.comm, self.method, self.tolerance, self.stages, self.traits = comm, method, tolerance, stages, traits
        self.ksp = PETSc.KSP().create(comm)
        self.ksp.setOptionsPrefix(prefix)
        # An old preconditioner serves until a new one pays; a complete factor of the very matrix takes no guess.
        self.keeps, self.takes_guess = method in ("stale", "auto"), method != "direct" or comm.size > 1
        self._set_iteration()
        self.kept = KeptPreconditioner(self.ksp, Choice(calibration, memory, traits), traits, self._named(), method)
        self.ksp.setFromOptions()
        self.refresh = RefreshCriterion(MOST_ITERATIONS)
        self.projection = Projection(comm, directions) if directions else None
        self.on_solve: Callable[[PETSc.Mat, PETSc.Vec, PETSc.Vec, bool, Reals | None], None] | None = None
        self.on_solved: Callable[[LinearReport | None], None] | None = None
        self.age, self.counts = -1, SolveCounts()
        self._begun = self._new = self._current = False
        # The matrix whose pattern `factor_beside` has analysed, for the system that comes next; kept, so that no other
        # one has its handle.
        self._analysed: PETSc.Mat | None = None
        self._rounding = math.inf
        self.scale: float | None = None
        self.decades = DECADES
        self._aimed: tuple[float | None, float] = (None, tolerance)
        self._most = 0

    @property
    def name(self) -> str:
        """The preconditioner in use, as in tables."""
        return self.kept.name

    @property
    def kind(self) -> str:
        """PETSc's type of it."""
        return self.kept.kind

    @property
    def symmetric(self) -> bool:
        """Whether all matrices are taken for symmetric."""
        return self.traits.symmetric

    @property
    def aim(self) -> float:
        """The tolerance that residuals must meet for solutions to agree within the scene's."""
        if self.kept.exact:
            return self.tolerance
        return (INCOMPLETE_FLOW if self.kept.may_exchange else INCOMPLETE) * self.tolerance

    def starts_from_guess(self, mat: PETSc.Mat) -> bool:
        """Whether the first solve of a new system with such a matrix does; a complete factor is of that very one."""
        return self.takes_guess and not (self.keeps and self.kept.foresees_inverse(mat))

    def _set_iteration(self) -> None:
        """Set what iterates, and what ends it."""
        if self.method == "direct" and self.comm.size == 1:
            self.ksp.setType("preonly")
        else:
            set_krylov(self.ksp, self.traits.krylov)
        self.ksp.setTolerances(rtol=self.tolerance, atol=0.0, divtol=1e30, max_it=MOST_ITERATIONS)

    def _named(self) -> str | None:
        """The preconditioner that PETSc's options name; None where they leave it open."""
        options = PETSc.Options(self.ksp.getOptionsPrefix() or "")
        return next((options.getString(key) for key in ("pc_type", "sub_pc_type") if options.hasName(key)), None)

    def solve(
        self,
        mat: PETSc.Mat,
        b: PETSc.Vec,
        x: PETSc.Vec,
        new_system: bool,
        same_matrix: bool = False,
        patched: bool = False,
        places: Reals | None = None,
        scale: float | None = None,
        auxiliary: bool = False,
        uses: int = 1,
    ) -> LinearReport:
        """Solve mat x = b from the guess in x.

        Args:
            mat: as the traits say.
            b: right side.
            x: guess on entry (but for `direct`), solution on return.
            new_system: the mesh is another one, so that no old preconditioner fits.
            same_matrix: mat is what it was in the last solve.
            patched: flips have changed the pattern.
            places: (n, d) nodes of this rank [m], whose rigid motions algebraic multigrid interpolates.
            scale: what the residual is measured against, in place of the norm of b.
            auxiliary: the solution is not one of the sequence that guesses come from.
            uses: solves with this matrix that are known to come, this one among them.

        Raises:
            ReplayProblem: no convergence, or no factor.
        """
        self.scale = scale
        if not self._begun:
            self._begin(mat, new_system, same_matrix, patched, uses)
        self._begun = False
        if self.projection and self.projection.pays and not auxiliary:
            with self.stages("krylov"):
                self.projection(mat, b, x)
        if self.on_solve:
            self.on_solve(mat, b, x, new_system, places)
        again = not self._current and (self.method == "direct" or (self.keeps and self.refresh.worth_refreshing(uses)))
        stale = self.kept.ready and not (again or (self.keeps and self.kept.outdone))
        if stale:
            self._take_old(mat, same_matrix)
        else:
            self._factor(mat, places, self._why(self.kept.ready), uses)
        self._use()
        self._weigh(b)
        iterations, last, refreshed = self._converge(mat, b, x, places, uses, stale)
        self.counts.matrices += not same_matrix
        self.counts.iterations += iterations
        if self.keeps:
            self._count(last, refreshed, new_system, uses)
        if self.projection and self.projection.pays and not auxiliary:
            with self.stages("krylov"):
                self.projection.keep(x)
        return self._reported(LinearReport(iterations, refreshed, self.age, self.kept.name))

    def _weigh(self, b: PETSc.Vec) -> None:
        """Take in how much smaller a solve from the guess 0 is to make a residual: iterations are about as many."""
        if self.kept.candidate and self.kept.candidate.krylov:
            size = b.norm()
            goal = self.aim * (size if self.scale is None else self.scale)
            self.decades = max(LEAST_DECADES, math.log10(size / goal)) if size > 0.0 and goal > 0.0 else LEAST_DECADES
            self.refresh.weight = 1.0 if self.kept.exact else self.decades

    def _reported(self, report: LinearReport) -> LinearReport:
        if self.on_solved:
            self.on_solved(report)
        return report

    def flip(self, nodes: Indices) -> None:
        """Take in that edges of cells with these nodes (m, k) were flipped, before the next matrix is solved with."""
        self.kept.flip(nodes)

    def interpolate(self, interpolate: Callable[[Reals], Reals]) -> None:
        """Take solutions of before where their nodes are now, by a function of rows (n f,) of all unknowns."""
        if self.projection:
            self.projection.interpolate(interpolate)

    def prepare(self, mat: PETSc.Mat, new_system: bool, uses: int) -> None:
        """Take up another matrix, and make a complete factor of it, for `apply`, if its uses are worth it.

        Args:
            mat: as the traits say.
            new_system: the mesh is another one, so that no old preconditioner fits.
            uses: solves with this matrix that are known to come.

        Raises:
            ReplayProblem: no factor.
        """
        self._current = False
        if self.comm.size > 1 or self.method == "ilu":
            return
        self._begin(mat, new_system, False, False, uses)
        self._begun, self._new = True, new_system
        if (
            self.kind == "cholesky"
            and not self.kept.outdone
            and (self.method == "direct" or not self.kept.ready or self.refresh.worth_refreshing(uses))
        ):
            self._factor(
                mat, None, f"{uses} solves with this matrix, worth {self.refresh.break_even:.3g} iterations", uses
            )

    def factor_beside(self, mat: PETSc.Mat, uses: int) -> PETSc.PC | None:
        """A complete factor of another matrix than those of the system that comes next, whose pattern it has.

        The pattern is analysed once: the next `prepare` of a new system, for as many uses, makes numbers alone.
        None where the system is to have another preconditioner, or this matrix has no factor.
        """
        if self.comm.size > 1 or self.method == "ilu":
            return None
        self._begin(mat, True, False, False, uses)
        if self.kind != "cholesky":
            return None
        # Its work is the caller's: it is in no stage of this solver's.
        self.kept.make(mat, None)
        self.kept.note_kind()
        # It serves none of the system's own matrices.
        self.kept.ready, self._analysed = False, mat
        return None if self.kept.zero_pivots() else self.ksp.getPC()

    @property
    def factored(self) -> bool:
        """Whether there is a complete factor of the very matrix of the last solve, or of `prepare`, for `apply`."""
        return self._current and self.kept.ready and self.kept.exact and not self.kept.rounded

    def apply(self, b: PETSc.Vec, x: PETSc.Vec) -> LinearReport:
        """Solve with the factor that there is (`factored`): no guess, no iteration."""
        new_system, self._begun = self._begun and self._new, False
        if self.on_solve:
            self.on_solve(self.ksp.getOperators()[0], b, x, new_system, None)
        with self.stages("krylov"):
            self.ksp.getPC().apply(b, x)
        if not math.isfinite(x.norm()):
            self.kept.ready = False
            raise ReplayProblem(NO_FACTOR)
        self._use()
        self.kept.count_application()
        return self._reported(LinearReport(1, self.age == 0, self.age, self.name))

    def negative_pivots(self) -> int:
        """Negative eigenvalues of the matrix that the complete factor was made from; 0 where there is none to ask.

        Of a matrix that is not symmetric, the negative pivots of an elimination without exchanges: as many if it is
        nearly symmetric, and an odd number where its determinant is negative.

        On several ranks, those of the factor that they share, or of their own blocks: none of them has any where the
        matrix is positive definite.
        """
        return self.kept.negative_pivots()

    def definite(self, mat: PETSc.Mat, places: Reals | None, new_system: bool = False) -> bool:
        """Whether a matrix is positive definite, by a new factor of it, which ends at a pivot that is zero.

        True where the preconditioner is no complete factor, which could show it. Pivots of the ranks' own rows prove
        nothing of symmetric matrices if they are positive: a factor that ranks share does. Arguments as in `solve`.
        """
        self._begin(mat, new_system, False, False)
        if not self.kept.complete:
            return True
        if self.on_solve:
            self.on_solve(mat, mat.createVecLeft(), mat.createVecRight(), new_system, places)
        self._factor(mat, places, "a test of positive definiteness", rebuild=True)
        if self.on_solved:
            self.on_solved(None)
        with self.stages("factor"):
            return self.kept.shows_definite(mat)

    @property
    def tolerances(self) -> tuple[float, float]:
        """Of the residual of the present system, relative to its right side and absolute."""
        return (self.aim, 0.0) if self.scale is None else (1e-300, self.aim * self.scale)

    def _aim(self) -> None:
        """Set what ends the iteration with the preconditioner as it is now."""
        scale, aim = self.scale, self.aim
        if (scale, aim) != self._aimed:
            relative, absolute = self.tolerances
            self.ksp.setTolerances(rtol=relative, atol=absolute)
            self._aimed = (scale, aim)

    # --- a new system, a new pattern ------------------------------------------------------------------------------

    def _begin(self, mat: PETSc.Mat, new_system: bool, same_matrix: bool, patched: bool, uses: int = 1) -> None:
        """See what is new about a matrix, and choose its preconditioner where the system is another one."""
        # A patch that adds to the pattern makes another matrix object, beside the one that the KSP still holds.
        kept, grown = self.kept, mat.handle != self.kept.handle
        self._current = self._current and same_matrix and not grown
        if grown or new_system:
            grown = kept.measure(mat) or patched
        if new_system:
            analysed, self._analysed = self._analysed, None
            if analysed and analysed.handle == mat.handle:
                return
        if new_system or (kept.chooses and not kept.candidate):
            if self.projection:
                self.projection.restart()
            self._rounding = math.inf
            kept.begin_system(uses)
            return
        if grown and kept.ready and not kept.pattern_changed:
            kept.pattern_changed = True
            if self.keeps:
                self._set_refresh_price()

    def _factor(self, mat: PETSc.Mat, places: Reals | None, why: str, uses: int = 1, *, rebuild: bool = False) -> None:
        """Make the preconditioner of `mat` for known uses, and keep it; `why` is for the log, the rest for `make`."""
        with self.stages("factor"):
            if not rebuild:
                self.kept.choose_again()
            self.kept.make(mat, places, rebuild)
            self.kept.note_kind()
            if uses > 1:
                self.kept.substitute_by_panels(iterates=False)
        self.age, self._current = -1, True
        self.counts.factors += 1
        log.info("KSP %s PC %s rebuilt: %s", self.ksp.getOptionsPrefix(), self.name, why)
        self.refresh.restart()
        if self.keeps:
            self._set_refresh_price()

    def _why(self, again: bool) -> str:
        """Why the preconditioner is rebuilt before an iteration, for the log."""
        if not again:
            return "another system"
        if not self.keeps:
            return "another matrix"
        if self.kept.outdone:
            return f"{self.name} has cost more than another preconditioner with its set-up would have"
        more, worth = self.refresh.extra_iterations, self.refresh.break_even
        return f"refactorisation criterion: {more:g} extra iterations, a refresh is worth {worth:.3g}"

    def _take_old(self, mat: PETSc.Mat, same_matrix: bool) -> None:
        """Go on with the preconditioner of an old matrix."""
        if self.refresh.uses == 0:
            # A copy of the factor in another order: of a million unknowns that takes as long as several frames.
            with self.stages("factor"):
                self.kept.substitute_by_panels(iterates=self.takes_guess)
        self.ksp.setOperators(mat)
        if not same_matrix:
            with self.stages("krylov"):
                self.kept.correct(mat)

    def _give_up(self, x: PETSc.Vec, iterations: int, uses: int, stale: bool) -> None:
        """Take in that a solve has failed, and leave a guess for the next preconditioner."""
        if not stale:
            # What a fresh one has failed with is no guess.
            x.set(0.0)
            return
        if not math.isfinite(x.norm()):
            x.set(0.0)
        self.refresh.give_up(iterations, uses)
        # Whether the matrix has changed or single precision was not enough for it, is not known.
        self.kept.single = False

    def _use(self) -> None:
        self.age, self.refresh.uses = self.age + 1, self.refresh.uses + 1

    # --- refreshes ------------------------------------------------------------------------------------------------

    def _set_refresh_price(self) -> None:
        """Take in what the preconditioner costs, and whether better guesses pay."""
        price, size, calibration = self.kept.price(), self.kept.size, self.kept.choice.calibration
        if self.projection:
            spent = (self.projection.directions + 1) * calibration.pass_seconds(size.unknowns, size.nonzeros)
            share = PROJECTED_MULTIGRID if self.kind == "gamg" else PROJECTED
            saved = max(1.0, share * self.kept.expected(self.refresh.fresh_iterations)) * size.ranks * price.iteration
            self.projection.pays = spent < saved
        product = calibration.matvec_nonzero * size.nonzeros / size.ranks
        self.refresh.set_refresh_price(price, self.kept.pattern_changed, product)

    def _apply_new(self, b: PETSc.Vec, x: PETSc.Vec) -> int:
        """Iterations of a solve with the factor that was made of its very matrix: one, unless it is not accurate.

        What the first one on a mesh leaves of the residual is looked at, by an iteration that hardly ever takes a step.
        Later ones leave as much of the solution's size, but for a factor; they are looked at where that is too much.
        """
        with self.stages("krylov"):
            self.ksp.getPC().apply(b, x)
        size = x.norm()
        goal = self.aim * (b.norm() if self.scale is None else self.scale)
        if math.isfinite(size) and MARGIN * self._rounding * size <= goal:
            self.ksp.setConvergedReason(Reason.CONVERGED_ITS)
            self._log_solve(1)
            return 1
        iterations = self._iterate(b, x)
        self._rounding = self.ksp.getResidualNorm() / size if not iterations and size else math.inf
        return max(1, iterations)

    def _converge(
        self, mat: PETSc.Mat, b: PETSc.Vec, x: PETSc.Vec, places: Reals | None, uses: int, stale: bool
    ) -> tuple[int, int, bool]:
        """Iterations of a solve, those with its last preconditioner, and whether that was made for it.

        A `stale` one that is worth no more iterations is made again in mid-solve. Arguments as in `solve`.
        """
        if not stale and self.keeps and self.kept.inverts:
            iterations = last = self._apply_new(b, x)
        else:
            iterations = last = self._iterate(b, x, uses if stale and self.keeps else 0)
        if self.ksp.getConvergedReason() >= 0:
            return iterations, last, not stale
        while self.ksp.getConvergedReason() < 0 and self._try_again(stale):
            self._give_up(x, last, uses, stale)
            stale = False
            self._factor(mat, places, f"no convergence in {last} iterations with the old one", uses, rebuild=True)
            self._use()
            last = self._iterate(b, x)
            iterations += last
        self._check()
        return iterations, last, not stale

    def _iterate(self, b: PETSc.Vec, x: PETSc.Vec, uses: int = 0) -> int:
        """Iterations of one run of the Krylov method, cut short when a refresh would have been cheaper for the uses."""
        if self.keeps:
            most = self.refresh.limit(self.kept.complete, uses) if uses else MOST_ITERATIONS
            if most != self._most:
                self.ksp.setTolerances(max_it=most)
                self._most = most
        self._aim()
        if self.kept.has_no_factor():
            self.ksp.setConvergedReason(Reason.DIVERGED_PCSETUP_FAILED)
            return 0
        with self.stages("krylov"):
            solve_from(self.ksp, b, x)
        iterations: int = self.ksp.getIterationNumber()
        if self.age == 0 and self.kept.exchangeable and self.ksp.getConvergedReason() > 0:
            # Nothing else shows that pivots are near zero.
            alone = self.ksp.getType() == "preonly"
            bad = not true_residual(self.ksp.getOperators()[0], b, x) <= INACCURATE if alone else iterations > FRESH
            if bad:
                self.ksp.setConvergedReason(Reason.DIVERGED_BREAKDOWN)
        if log.isEnabledFor(logging.DEBUG):
            self._log_solve(iterations)
        return iterations

    def _log_solve(self, iterations: int) -> None:
        """Log how a solve ended, in PETSc's words."""
        reason = self.ksp.getConvergedReason()
        log.debug(
            "Linear %s solve %s due to %s iterations %d",
            self.ksp.getOptionsPrefix(),
            "converged" if reason > 0 else "did not converge",
            REASONS.get(reason, reason),
            iterations,
        )

    def _try_again(self, stale: bool) -> bool:
        """Whether, after a failure, another preconditioner is left: a fresh one, or one of another kind."""
        return (self.keeps or self.kept.may_exchange) and (stale or self.kept.replace_failed())

    def _count(self, iterations: int, refreshed: bool, new_system: bool, uses: int) -> None:
        """Take in the iterations of a solve, all of them with the preconditioner as it is now."""
        if not new_system:
            self.kept.count(self.refresh.uses, iterations, self.decades)
        self.refresh.count(iterations, refreshed, self.kept.exact, uses)

    def _check(self) -> None:
        reason = self.ksp.getConvergedReason()
        if reason >= 0:
            return
        self.kept.ready = False
        if reason == Reason.DIVERGED_PCSETUP_FAILED:
            raise ReplayProblem(NO_EXCHANGED if self.kept.may_exchange else NO_FACTOR)
        done = self.ksp.getIterationNumber()
        raise ReplayProblem(
            f"the linear solve did not converge, with a new preconditioner ({self.name}) either "
            f"({REASONS.get(reason, reason)}, {done} iterations)"
            if self.keeps
            else f"the linear solve did not converge ({REASONS.get(reason, reason)}, {done} iterations)"
        )
