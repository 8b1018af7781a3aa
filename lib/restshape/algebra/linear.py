"""Linear solves with a preconditioner that is kept for as long as it is worth it."""

import math
from dataclasses import dataclass

from petsc4py import PETSc

from restshape.algebra.stages import Stages
from restshape.calibration import Calibration
from restshape.errors import ReplayProblem

METHODS = ("direct", "stale", "ilu")


@dataclass
class LinearReport:
    """What one linear solve did: `age` counts the solves since the preconditioner was made."""

    iterations: int
    refreshed: bool
    age: int


class LinearSolver:
    """One KSP whose preconditioner outlives the matrix that it was made from.

    Args:
        comm: PETSc communicator.
        prefix: of its options in PETSc's database.
        method: `direct` (a complete Cholesky factor anew for each matrix, no Krylov iteration), `stale` (CG with an old
            complete factor, refreshed when that pays), `ilu` (CG with ILU(3), kept until the mesh is another one).
        tolerance: of the true residual, relative to the right side.
        calibration: seconds a unit of counted work, for the refresh of `stale`.
        stages: takes the time of factorizations and of Krylov iterations.

    On several ranks the factors are those of the ranks' own rows (block Jacobi), so that the bits repeat.

    Source: THEORY.md section 1 (rent or buy).
    """

    def __init__(
        self, comm: PETSc.Comm, prefix: str, method: str, tolerance: float, calibration: Calibration, stages: Stages
    ):
        self.method, self.tolerance, self.calibration, self.stages = method, tolerance, calibration, stages
        self.comm = comm
        self.ksp = PETSc.KSP().create(comm)
        self.ksp.setOptionsPrefix(prefix)
        self._set_types()
        self.ksp.setFromOptions()
        self.age = -1
        self.excess = 0
        self.fresh_iterations = 1
        self.budget = 0

    def _set_types(self) -> None:
        direct = self.method == "direct" and self.comm.size == 1
        self.ksp.setType("preonly" if direct else "cg")
        if not direct:
            self.ksp.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
            self.ksp.setInitialGuessNonzero(True)
        self.ksp.setTolerances(rtol=self.tolerance, atol=0.0, divtol=1e30, max_it=10_000)
        pc = self.ksp.getPC()
        kind = "ilu" if self.method == "ilu" else "cholesky"
        if self.comm.size == 1:
            pc.setType(kind)
            if kind == "ilu":
                pc.setFactorLevels(3)
                # Slender parts make incomplete factors indefinite, for which CG has no use.
                pc.setFactorShift(PETSc.Mat.FactorShiftType.POSITIVE_DEFINITE)
            else:
                pc.setFactorOrdering("amd")
            return
        # Block Jacobi as additive Schwarz without overlap: the petsc4py of 3.18 gives the blocks' solvers for that only.
        pc.setType("asm")
        pc.setASMOverlap(0)
        options = PETSc.Options(self.ksp.getOptionsPrefix() or "")
        wanted = {"sub_ksp_type": "preonly", "sub_pc_type": kind}
        if kind == "ilu":
            wanted |= {"sub_pc_factor_levels": 3, "sub_pc_factor_shift_type": "positive_definite"}
        for key, value in wanted.items():
            if not options.hasName(key):
                options.setValue(key, value)

    def solve(
        self, mat: PETSc.Mat, b: PETSc.Vec, x: PETSc.Vec, new_system: bool, same_matrix: bool = False
    ) -> LinearReport:
        """Solve mat x = b from the guess in x.

        Args:
            mat: symmetric positive definite.
            b: right side.
            x: guess on entry (but for `direct`), solution on return.
            new_system: the mesh is another one, so that no old preconditioner fits.
            same_matrix: mat is what it was in the last solve, so that `direct` has its factor.

        Raises:
            ReplayProblem: no convergence, or no factor.
        """
        refreshed = False
        if new_system:
            self.ksp.reset()
        if new_system or self.age < 0 or (self.method == "direct" and not same_matrix) or self._worth_refreshing():
            self._factor(mat)
            refreshed = True
        else:
            self.ksp.setOperators(mat)
        self.age += 1
        iterations = self._iterate(b, x, limited=self.method == "stale" and not refreshed)
        if (
            self.ksp.getConvergedReason() == PETSc.KSP.ConvergedReason.DIVERGED_MAX_IT
            and not refreshed
            and self.method == "stale"
        ):
            self._factor(mat)
            self.age = 0
            refreshed = True
            iterations += self._iterate(b, x, limited=False)
        self._check()
        if self.method == "stale":
            self._count(iterations, refreshed)
        return LinearReport(iterations, refreshed, self.age)

    def prepare(self, mat: PETSc.Mat, new_system: bool, uses: int) -> bool:
        """Whether this matrix now has a complete factor of its own, for `apply`; made if its uses are worth it.

        A solve with an old factor takes at least one iteration more than `apply`: as many uses as there are iterations in
        the cost of a refresh pay for it.

        Args:
            mat: symmetric positive definite.
            new_system: the mesh is another one, so that no old preconditioner fits.
            uses: solves with this matrix that are known to come.

        Raises:
            ReplayProblem: no factor.
        """
        if self.comm.size > 1 or self.method not in ("direct", "stale"):
            return False
        if new_system:
            self.ksp.reset()
        if not (new_system or self.method == "direct" or self.age < 0 or uses >= self.budget):
            return False
        self._factor(mat)
        return True

    def apply(self, b: PETSc.Vec, x: PETSc.Vec) -> LinearReport:
        """Solve with the factor that `prepare` has made: no guess, no iteration."""
        with self.stages("krylov"):
            self.ksp.getPC().apply(b, x)
        self.age += 1
        return LinearReport(1, self.age == 0, self.age)

    def _iterate(self, b: PETSc.Vec, x: PETSc.Vec, limited: bool) -> int:
        """Iterations of one run of the Krylov method, cut short when a refresh would have been cheaper."""
        if self.method == "stale":
            left = max(self.fresh_iterations + 1, self.fresh_iterations + self.budget - self.excess)
            self.ksp.setTolerances(max_it=left if limited else 10_000)
        with self.stages("krylov"):
            self.ksp.solve(b, x)
        return self.ksp.getIterationNumber()

    def _factor(self, mat: PETSc.Mat) -> None:
        """Make the preconditioner from `mat`, then keep it."""
        pc = self.ksp.getPC()
        with self.stages("factor"):
            pc.setReusePreconditioner(False)
            self.ksp.setOperators(mat)
            self.ksp.setUp()
            if self.comm.size > 1:
                self.ksp.setUpOnBlocks()
            pc.setReusePreconditioner(True)
        failed = pc.getFailedReason() if hasattr(pc, "getFailedReason") else 0
        if failed:
            raise ReplayProblem("the stiffness matrix has no factor: part of the body is not held, or has no stiffness")
        self.age = -1
        self.excess = 0
        if self.method == "stale":
            self._set_budget(mat)

    def _set_budget(self, mat: PETSc.Mat) -> None:
        """Iterations that cost as much as a refresh, from counted work on all ranks and the calibration."""
        nnz = mat.getInfo(PETSc.Mat.InfoType.GLOBAL_SUM)["nz_used"]
        size = mat.getSize()[0]
        filled = self._filled() or nnz
        refresh = self.calibration.refresh_seconds(size, nnz, filled)
        self.budget = max(1, math.ceil(refresh / self.calibration.iteration_seconds(size, nnz, filled)))

    def _filled(self) -> float:
        """Nonzeros of the factors of all ranks; 0 when PETSc's options ask for a preconditioner that is no factor."""
        pc = self.ksp.getPC()
        parts = [ksp.getPC() for ksp in pc.getASMSubKSP()] if pc.getType() == "asm" else [pc]
        factors = [part.getFactorMatrix() for part in parts if part.getType() in ("cholesky", "lu", "icc", "ilu")]
        filled = sum(factor.getInfo()["nz_used"] for factor in factors)
        return filled if self.comm.size == 1 else self.comm.tompi4py().allreduce(filled)

    def _worth_refreshing(self) -> bool:
        return self.method == "stale" and self.excess >= self.budget

    def _count(self, iterations: int, refreshed: bool) -> None:
        if refreshed and self.comm.size > 1:
            self.fresh_iterations = max(1, iterations)
        self.excess += 0 if refreshed else max(0, iterations - self.fresh_iterations)

    def _check(self) -> None:
        reason = self.ksp.getConvergedReason()
        if reason < 0:
            names = {v: k for k, v in vars(PETSc.KSP.ConvergedReason).items() if isinstance(v, int)}
            done = self.ksp.getIterationNumber()
            raise ReplayProblem(f"the linear solve did not converge ({names.get(reason, reason)}, {done} iterations)")


def true_residual(mat: PETSc.Mat, b: PETSc.Vec, x: PETSc.Vec) -> float:
    """The norm of b - mat x over that of b (0 when b is 0)."""
    r = b.duplicate()
    mat.mult(x, r)
    r.aypx(-1.0, b)
    scale, error = b.norm(), r.norm()
    r.destroy()
    return error / scale if scale > 0 else error
