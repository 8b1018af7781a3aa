"""Linear solves with a preconditioner that is kept for as long as it is worth it."""

import math
from collections.abc import Callable

import numpy as np
from petsc4py import PETSc

from restshape.algebra.choice import ILU, MEMORY, Candidate, Choice, Size, prices
from restshape.algebra.linear_report import LinearReport
from restshape.algebra.pivots import factors_of, negative_pivots, zero_pivots
from restshape.algebra.preconditioner import kind_of, nonzeros, set_preconditioner, set_rigid_motions
from restshape.algebra.projection import Projection
from restshape.algebra.stages import Stages
from restshape.calibration import Calibration
from restshape.errors import ReplayProblem

COMPLETE = ("cholesky", "lu")
METHODS = ("direct", "stale", "auto", "ilu")
MOST_ITERATIONS = 10_000
"""An iteration that has not ended by then never will: the preconditioner is made anew, or the frame given up."""
PROJECTED = 0.2
"""Part of the iterations of a solve that projection of the guess saves, one at least: measured on the dragged plate."""
RESTART = 100
"""Directions that GMRES keeps: complete factors need few, incomplete ones of slender bodies stall with PETSc's 30."""
INCOMPLETE = 0.25
"""An incomplete preconditioner leaves smooth errors, whose energy the residual tells too small (by up to 2.2 on the
plate): its solves end at this share of the tolerance, so that solutions agree within it in the energy norm."""
NO_FACTOR = "the stiffness matrix has no factor: part of the body is not held, or has no stiffness"
Reason = PETSc.KSP.ConvergedReason


class LinearSolver:
    """One KSP whose preconditioner outlives the matrix that it was made from.

    Args:
        comm: PETSc communicator.
        prefix: of its options in PETSc's database.
        method: `direct` (a complete Cholesky factor anew for each matrix, no Krylov iteration), `stale` (CG with an old
            complete factor, refreshed when that pays), `auto` (the same with the preconditioner that each new system's
            `Choice` prefers, or that PETSc's options name), `ilu` (CG with ILU(3), kept until the mesh is another one).
        tolerance: of the true residual, relative to the right side.
        calibration: seconds a unit of counted work, for the choice and the refresh.
        stages: takes the time of factorizations and of Krylov iterations.
        memory: bytes that a complete factor may take under `auto`.
        directions: increments of the solution along which guesses are improved; 0 for none.
        symmetric: false where no matrix is: then GMRES and a complete LU factor take the place of CG and Cholesky, and
            `auto` is `stale`.

    On several ranks the factors are those of the ranks' own rows (block Jacobi), so that the bits repeat.
    An idle frame solves nothing and refreshes nothing, for a frame with nothing to do does nothing.

    Source: docs/theory.md, section 1 (rent or buy).
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
        symmetric: bool = True,
    ):
        self.method, self.tolerance, self.calibration, self.stages = method, tolerance, calibration, stages
        self.comm, self.symmetric = comm, symmetric
        self.ksp = PETSc.KSP().create(comm)
        self.ksp.setOptionsPrefix(prefix)
        self.choice = Choice(calibration, memory)
        self.candidate: Candidate | None = None
        self.projection = Projection(comm, directions) if directions else None
        self.projection_pays = False
        self.filled = 0.0
        self.on_solve: Callable[[PETSc.Mat, PETSc.Vec, PETSc.Vec, bool, np.ndarray | None], None] | None = None
        self._set_types()
        # Solves since the preconditioner was made; callers add frames that solve nothing to the age.
        self.age = self.uses = -1
        self.ready = False
        self.excess = 0
        self.fresh_iterations = 1
        self.budget = 0
        self.patched = self.pattern_changed = False
        self._handle, self.size = 0, Size(0, 0.0)
        self._begun = False
        self.scale: float | None = None
        self._aimed: tuple[float | None, float] = (None, tolerance)

    @property
    def name(self) -> str:
        """The preconditioner in use, as in tables."""
        return self.candidate.name if self.candidate else self.kind

    @property
    def aim(self) -> float:
        """The tolerance that residuals must meet for solutions to agree within the scene's."""
        complete = self.kind in COMPLETE and self.comm.size == 1
        return self.tolerance if complete else INCOMPLETE * self.tolerance

    @property
    def keeps(self) -> bool:
        """Tell whether an old preconditioner serves until a new one pays."""
        return self.method in ("stale", "auto")

    def _set_types(self) -> None:
        direct = self.method == "direct" and self.comm.size == 1
        self.ksp.setType("preonly" if direct else "cg" if self.symmetric else "gmres")
        if not self.symmetric:
            self.ksp.setGMRESRestart(RESTART)
            # The true residual is what GMRES sees with the preconditioner on the right.
            self.ksp.setPCSide(PETSc.PC.Side.RIGHT)
        if not direct:
            self.ksp.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
            self.ksp.setInitialGuessNonzero(True)
        self.ksp.setTolerances(rtol=self.tolerance, atol=0.0, divtol=1e30, max_it=MOST_ITERATIONS)
        options = PETSc.Options(self.ksp.getOptionsPrefix() or "")
        named = next((options.getString(key) for key in ("pc_type", "sub_pc_type") if options.hasName(key)), None)
        complete = "cholesky" if self.symmetric else "lu"
        self.kind = named or ("ilu" if self.method == "ilu" else complete)
        self.chooses = self.method == "auto" and named is None and self.symmetric
        self._given: list[str] = []
        if self.method == "ilu" and named is None:
            self.candidate = ILU
        self._set_preconditioner(ILU.levels)
        self.ksp.setFromOptions()

    def _set_preconditioner(self, levels: int) -> None:
        self._forget_options()
        self._given = set_preconditioner(self.ksp, self.kind, levels)

    def _forget_options(self) -> None:
        """Take out of PETSc's database what was put there for a set-up: it is not what the user said."""
        options = PETSc.Options(self.ksp.getOptionsPrefix() or "")
        for key in self._given:
            options.delValue(key)
        self._given = []

    def solve(
        self,
        mat: PETSc.Mat,
        b: PETSc.Vec,
        x: PETSc.Vec,
        new_system: bool,
        same_matrix: bool = False,
        patched: bool = False,
        places: np.ndarray | None = None,
        scale: float | None = None,
        aside: bool = False,
    ) -> LinearReport:
        """Solve mat x = b from the guess in x.

        Args:
            mat: symmetric positive definite, or not symmetric where the solver was told so.
            b: right side.
            x: guess on entry (but for `direct`), solution on return.
            new_system: the mesh is another one, so that no old preconditioner fits.
            same_matrix: mat is what it was in the last solve, so that `direct` has its factor.
            patched: flips have changed the pattern: level 2, which never factors ahead of the iteration.
            places: (n, d) nodes of this rank [m], whose rigid motions algebraic multigrid interpolates.
            scale: what the residual is measured against, in place of the norm of b.
            aside: the solution is not one of the sequence that guesses come from.

        Raises:
            ReplayProblem: no convergence, or no factor.
        """
        self.scale = scale
        if not self._begun:
            self._begin(mat, new_system, same_matrix, patched)
        self._begun = False
        if self.projection and self.projection_pays and not aside:
            with self.stages("krylov"):
                self.projection(mat, b, x)
        if self.on_solve:
            self.on_solve(mat, b, x, new_system, places)
        stale = self.ready and not ((self.method == "direct" and not same_matrix) or self._worth_refreshing())
        if stale:
            self.ksp.setOperators(mat)
        else:
            self._factor(mat, places)
        self.age, self.uses = self.age + 1, self.uses + 1
        iterations = last = self._iterate(b, x, limited=stale and self.keeps)
        while self.ksp.getConvergedReason() < 0 and self._try_again(stale):
            self._clean(x)
            stale = False
            self._factor(mat, places, anew=True)
            self.age = self.uses = 0
            last = self._iterate(b, x, limited=False)
            iterations += last
        self._check()
        if self.keeps:
            self._count(last, not stale, new_system)
        if self.projection and self.projection_pays and not aside:
            self.projection.keep(x)
        return LinearReport(iterations, not stale, self.age, self.name)

    def interpolate(self, interpolate: Callable[[np.ndarray], np.ndarray]) -> None:
        """Take solutions of before where their nodes are now, by a function of rows (n f,) of all unknowns."""
        if self.projection:
            self.projection.interpolate(interpolate)

    def prepare(self, mat: PETSc.Mat, new_system: bool, uses: int, patched: bool = False) -> bool:
        """Whether this matrix now has a complete factor of its own, for `apply`; made if its uses are worth it.

        A solve with an old factor takes at least one iteration more than `apply`: as many uses as there are iterations
        in the cost of a refresh pay for it.

        Args:
            mat: symmetric positive definite.
            new_system: the mesh is another one, so that no old preconditioner fits.
            uses: solves with this matrix that are known to come.
            patched: flips have changed the pattern, so that nothing is factored ahead.

        Raises:
            ReplayProblem: no factor.
        """
        if self.comm.size > 1 or self.method == "ilu":
            return False
        self._begin(mat, new_system, False, patched)
        self._begun = True
        if self.kind != "cholesky":
            return False
        if not (self.method == "direct" or not self.ready or (uses >= self.budget and not self.patched)):
            return False
        self._factor(mat, None)
        return True

    def apply(self, b: PETSc.Vec, x: PETSc.Vec) -> LinearReport:
        """Solve with the factor that `prepare` has made: no guess, no iteration."""
        self._begun = False
        with self.stages("krylov"):
            self.ksp.getPC().apply(b, x)
        if not math.isfinite(x.norm()):
            self.ready = False
            raise ReplayProblem(NO_FACTOR)
        self.age, self.uses = self.age + 1, self.uses + 1
        return LinearReport(1, self.age == 0, self.age, self.name)

    def negative_pivots(self) -> int:
        """Negative eigenvalues of the matrix that the complete factor was made from; 0 where there is none to ask.

        Of a matrix that is not symmetric, the negative pivots of an elimination without exchanges: as many if it is
        nearly symmetric, and an odd number where its determinant is negative.

        On several ranks, those of the ranks' own blocks: none of them has any where the matrix is positive definite.
        """
        if self.kind not in COMPLETE:
            return 0
        found = sum(negative_pivots(part.getFactorMatrix(), self.kind) for part in factors_of(self.ksp))
        return found if self.comm.size == 1 else self.comm.tompi4py().allreduce(found)

    def definite(self, mat: PETSc.Mat, places: np.ndarray | None, new_system: bool = False) -> bool:
        """Tell whether a matrix is positive definite, by a new factor of it, which ends at a pivot that is zero.

        True where the preconditioner is no complete factor, which could tell. Arguments as in `solve`.
        """
        self._begin(mat, new_system, False, False)
        if self.kind not in COMPLETE:
            return True
        self._factor(mat, places)
        zero = sum(zero_pivots(part.getFactorMatrix(), self.kind) for part in factors_of(self.ksp))
        zero = zero if self.comm.size == 1 else self.comm.tompi4py().allreduce(zero)
        return zero == 0 and self.negative_pivots() == 0

    def _aim(self) -> None:
        """Set what ends the iteration with the preconditioner as it is now."""
        scale, aim = self.scale, self.aim
        if (scale, aim) != self._aimed:
            self.ksp.setTolerances(rtol=aim if scale is None else 1e-300, atol=0.0 if scale is None else aim * scale)
            self._aimed = (scale, aim)

    # --- a new system, a new pattern ------------------------------------------------------------------------------

    def _begin(self, mat: PETSc.Mat, new_system: bool, same_matrix: bool, patched: bool) -> None:
        """See what is new about a matrix, and choose its preconditioner where the system is another one."""
        # A patch that adds to the pattern makes another matrix object, beside the one that the KSP still holds.
        grown, before = mat.handle != self._handle, self.size
        if grown or new_system:
            self._handle, self.size = mat.handle, self._size(mat)
            grown = patched or self.size != before
        if new_system or (self.chooses and not self.candidate):
            self.ksp.reset()
            self.ready = self.pattern_changed = self.patched = False
            if self.projection:
                self.projection.restart()
            if self.chooses:
                self._choose()
            return
        self.patched = patched or grown or (same_matrix and self.patched)
        if grown and self.ready and not self.pattern_changed:
            self.pattern_changed = True
            if self.keeps:
                self._set_budget()

    def _choose(self) -> None:
        chosen = self.choice(self.size)
        if chosen is not self.candidate:
            self.candidate, self.kind = chosen, chosen.kind
            self._set_preconditioner(chosen.levels)

    def _size(self, mat: PETSc.Mat) -> Size:
        nonzeros = mat.getInfo(PETSc.Mat.InfoType.GLOBAL_SUM)["nz_used"]
        return Size(mat.getSize()[0], nonzeros, 3 if mat.getBlockSize() == 3 else 2, self.comm.size)

    def _factor(self, mat: PETSc.Mat, places: np.ndarray | None, anew: bool = False) -> None:
        """Make the preconditioner from `mat`, then keep it; `anew` keeps no interpolation of multigrid either."""
        pc = self.ksp.getPC()
        with self.stages("factor"):
            if self.kind == "gamg" and (anew or self.pattern_changed or not self.ready):
                # A reset, or a kept interpolation with another pattern, leaves coarse grids of the old sizes.
                pc.setType("none")
                self._set_preconditioner(0)
            if places is not None and self.kind == "gamg" and mat.getBlockSize() == places.shape[1]:
                set_rigid_motions(mat, places)
            pc.setReusePreconditioner(False)
            self.ksp.setOperators(mat)
            self.ksp.setUp()
            if self.comm.size > 1:
                self.ksp.setUpOnBlocks()
            pc.setReusePreconditioner(True)
        self._forget_options()
        self.age = self.uses = -1
        self.ready = True
        self.excess = 0
        self.pattern_changed = False
        self.kind = kind_of(pc)
        if self.keeps:
            self._set_budget()

    # --- refreshes ------------------------------------------------------------------------------------------------

    def _set_budget(self) -> None:
        """Iterations that cost as much as a refresh, from counted work on all ranks and the calibration."""
        size = self.size
        counted = self.filled = nonzeros(self.ksp.getPC())
        if self.candidate and counted:
            self.choice.count_fill(self.candidate, size, counted)
        # An LU factor has the nonzeros of two triangles, of which the prices expect one.
        filled = 0.5 * counted if self.kind == "lu" else counted
        price = prices(self.kind, size, filled or size.nonzeros, self.calibration)
        if self.projection:
            spent = (self.projection.directions + 1) * self.calibration.pass_seconds(size.unknowns, size.nonzeros)
            saved = max(1.0, PROJECTED * self.fresh_iterations) * size.ranks * price.iteration
            self.projection_pays = spent < saved
        refresh = price.setup if self.pattern_changed else price.refresh
        self.budget = max(1, math.ceil(refresh / price.iteration))

    def _worth_refreshing(self) -> bool:
        """Tell whether the iterations beyond those of a fresh preconditioner have cost as much as a refresh."""
        return self.keeps and not self.patched and self.excess >= self.budget

    def _iterate(self, b: PETSc.Vec, x: PETSc.Vec, limited: bool) -> int:
        """Iterations of one run of the Krylov method, cut short when a refresh would have been cheaper."""
        if self.keeps:
            most = self._limit() if limited else MOST_ITERATIONS
            self.ksp.setTolerances(max_it=most)
        self._aim()
        with self.stages("krylov"):
            self.ksp.solve(b, x)
        return self.ksp.getIterationNumber()

    def _limit(self) -> int:
        """Iterations after which a solve with an old preconditioner is better given up for a new one."""
        # An iteration that is cut short has to begin anew: where a fresh one is long too, that must be paid twice.
        fresh = self.fresh_iterations if self.kind in COMPLETE else 2 * self.fresh_iterations
        budget = 2 * self.budget if self.patched else self.budget
        return min(MOST_ITERATIONS, max(fresh + 1, fresh + budget - self.excess))

    def _try_again(self, stale: bool) -> bool:
        """After a failure, tell whether another preconditioner is left: a fresh one, or one of another kind."""
        if not self.keeps:
            return False
        if stale:
            return True
        if not self.chooses or self.candidate is None or self.candidate.kind == "cholesky":
            return False
        self.choice.exclude(self.candidate)
        left = self.choice.open(self.size)
        if left[0] is self.candidate or left[0].name in self.choice.excluded:
            return False
        self.ksp.reset()
        self.candidate, self.kind = left[0], left[0].kind
        self._set_preconditioner(self.candidate.levels)
        return True

    def _clean(self, x: PETSc.Vec) -> None:
        """Leave a guess that is a number everywhere."""
        if not math.isfinite(x.norm()):
            x.set(0.0)

    def _count(self, iterations: int, refreshed: bool, new_system: bool) -> None:
        """Take in the iterations of a solve, all of them with the preconditioner as it is now."""
        complete = self.kind in COMPLETE and self.comm.size == 1
        if self.candidate and not new_system:
            self.choice.count(self.candidate, self.size, self.uses, iterations)
        if refreshed:
            self.fresh_iterations = 1 if complete else max(1, iterations)
            return
        if self.uses == 1 and not complete:
            # The guess on a new mesh is worse than those that follow it.
            self.fresh_iterations = max(1, min(self.fresh_iterations, iterations))
        self.excess += max(0, iterations - self.fresh_iterations)

    def _check(self) -> None:
        reason = self.ksp.getConvergedReason()
        if reason >= 0:
            return
        self.ready = False
        if reason == Reason.DIVERGED_PCSETUP_FAILED:
            raise ReplayProblem(NO_FACTOR)
        names = {v: k for k, v in vars(Reason).items() if isinstance(v, int)}
        done = self.ksp.getIterationNumber()
        raise ReplayProblem(
            f"the linear solve did not converge, with a new preconditioner ({self.name}) either "
            f"({names.get(reason, reason)}, {done} iterations)"
            if self.keeps
            else f"the linear solve did not converge ({names.get(reason, reason)}, {done} iterations)"
        )
