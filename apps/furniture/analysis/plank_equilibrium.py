"""Equilibrium of furniture by SNES in its mixed form: displacements of planks and forces of joints."""

import numpy as np
from petsc4py import PETSc
from restshape_apps.furniture import _kernels
from restshape_apps.furniture.physics.furniture import Forces, Furniture

from restshape.algebra.weak_calls import weak_call
from restshape.errors import ReplayProblem

TOLERANCE = 1e-11
"""Of the residual, in parts of the loads."""

BALANCED = 1e-7
"""Part of the loads that contacts may fail to balance by rounding."""

MOST_STEPS = 30


class PlankEquilibrium:
    """Newton's method of SNES on one piece, for each of its cases.

    Args:
        furniture: the model; its last test or shape says where the planks are.
        prefix: of PETSc's options.
        tolerance: of the residual, in parts of the loads.

    Attributes:
        sprung: the last solution is that of springs which pull or slide, for no other was found.

    Source: docs/theory/furniture.md.
    """

    def __init__(self, furniture: Furniture, prefix: str = "planks_", tolerance: float = TOLERANCE) -> None:
        self.furniture, self.tolerance = furniture, tolerance
        self.mixed = _kernels.Furniture.Mixed(furniture.kernel)
        self.case, self.law, self.sprung = 0, 0, False
        n = self.mixed.size
        rows, columns = self.mixed.pattern()
        self.values = np.zeros(len(columns))
        self.mat = PETSc.Mat().createAIJWithArrays((n, n), (rows, columns, self.values), comm=PETSc.COMM_SELF)
        self.x, self.f = self.mat.createVecs()
        self.snes = self._snes(prefix)
        self.scale = self._scale()

    def solve(self, case: int = 0, one_sided: bool | None = None, guess: np.ndarray | None = None) -> Forces:
        """The equilibrium of a case, which becomes the model's state.

        Args:
            case: 0 is the weights alone, k is push k beside them.
            one_sided: contacts only push, and slide beyond Coulomb's limit; else they are springs both ways. Default:
                one-sided where springs would pull or slide, unless no such equilibrium is found.
            guess: (n, 6) displacements to start from; default: at rest.

        Raises:
            ReplayProblem: Newton's method does not come to an end.
        """
        if one_sided and guess is not None:
            return self._solved(case, 1, np.ascontiguousarray(guess).ravel())
        start = np.zeros(6 * self.furniture.count) if guess is None else np.ascontiguousarray(guess).ravel()
        springs, self.sprung = self._solved(case, 0, start), False
        of_springs = self.last
        if one_sided or (one_sided is None and self._leans(case, springs)):
            try:
                return self._solved(case, 1, springs.u.ravel())
            except ReplayProblem:
                found = self._eased(case, springs)
                if found is None and one_sided:
                    raise
                self.sprung = found is None
                if found is None:
                    self.last = of_springs
                return found or springs
        return springs

    def _eased(self, case: int, springs: Forces) -> Forces | None:
        """The one-sided equilibrium by way of bounded friction; None, and springs again, where that has no end."""
        kernel = self.furniture.kernel
        kernel.set_state(case, springs.u.ravel(), 0)
        if kernel.one_sided(case):
            try:
                return self._solved(case, 1, self.furniture.forces(case).u.ravel())
            except ReplayProblem:
                kernel.set_state(case, springs.u.ravel(), 0)
        return None

    def _leans(self, case: int, springs: Forces) -> bool:
        """Whether springs pull or slide where contacts could do without."""
        return springs.unbalanced <= BALANCED and not self.furniture.kernel.inside(case)

    def _solved(self, case: int, law: int, start: np.ndarray) -> Forces:
        self.case, self.law = case, law
        kernel = self.furniture.kernel
        kernel.set_state(case, start, law)
        self.x.setArray(self.mixed.join(case))
        self.snes.solve(None, self.x)
        if self.snes.getConvergedReason() < 0:
            raise ReplayProblem(f"no equilibrium of the piece: SNES ends with reason {self.snes.getConvergedReason()}")
        kernel.set_state(case, self.mixed.part(self.x.getArray(readonly=True)), law)
        return self.furniture.forces(case)

    @property
    def steps(self) -> int:
        """Newton steps of the last solve."""
        return self.snes.getIterationNumber()

    def destroy(self) -> None:
        """Give PETSc's objects back."""
        for each in (self.snes, self.mat, self.x, self.f):
            each.destroy()

    def _scale(self) -> float:
        loads = np.abs(self.furniture.cases).sum(axis=(1, 2)).max(initial=0.0)
        return float(loads + self.furniture.kernel.shape()["mass"].sum() * np.linalg.norm(self.furniture.piece.gravity))

    def _residual(self, snes: PETSc.SNES, x: PETSc.Vec, f: PETSc.Vec) -> None:
        with f as out:
            self.mixed.residual(self.case, self.law, x.getArray(readonly=True), out)

    def _tangent(self, snes: PETSc.SNES, x: PETSc.Vec, mat: PETSc.Mat, preconditioner: PETSc.Mat) -> None:
        shift = self.furniture.compliance.shift
        self.mixed.tangent(self.case, self.law, x.getArray(readonly=True), self.values, shift)
        mat.assemble()

    def _test(self, snes: PETSc.SNES, steps: int, norms: tuple[float, float, float]) -> int:
        norm = norms[2]
        previous, self.last = (self.last if steps else np.inf), norm
        if not np.isfinite(norm):
            return PETSc.SNES.ConvergedReason.DIVERGED_FNORM_NAN
        # A residual that stays small is rounding.
        if norm <= self.tolerance * self.scale or (norm <= 1e-6 * self.scale and norm > 0.5 * previous):
            return PETSc.SNES.ConvergedReason.CONVERGED_FNORM_ABS
        return (
            PETSc.SNES.ConvergedReason.ITERATING if steps < MOST_STEPS else PETSc.SNES.ConvergedReason.DIVERGED_MAX_IT
        )

    def _snes(self, prefix: str) -> PETSc.SNES:
        snes = PETSc.SNES().create(PETSc.COMM_SELF)
        snes.setOptionsPrefix(prefix)
        options = PETSc.Options(prefix)
        # Forces of joints come first, and their pivots are -1.
        for key, value in {"snes_linesearch_type": "basic", "pc_factor_mat_ordering_type": "natural"}.items():
            if not options.hasName(key):
                options.setValue(key, value)
        options.setValue("pc_factor_zeropivot", 0.0)
        snes.setFunction(weak_call(self._residual), self.f)
        snes.setJacobian(weak_call(self._tangent), self.mat)
        snes.setConvergenceTest(weak_call(self._test))
        ksp = snes.getKSP()
        ksp.setType("preonly")
        ksp.getPC().setType("lu")
        snes.setFromOptions()
        return snes
