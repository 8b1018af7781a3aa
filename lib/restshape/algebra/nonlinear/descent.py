"""Ways down an energy that PETSc's SNES has: quasi-Newton, nonlinear conjugate gradients, Newton with line search."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.at_exit import destroyed_at_exit
from restshape.algebra.factors.shared_solves import set_shared_factor
from restshape.algebra.nodal import NodalVectors
from restshape.algebra.nonlinear.step_share import StepShare, whole_step
from restshape.algebra.preconditioner import set_preconditioner, substitute_by_panels
from restshape.algebra.weak_calls import weak_call
from restshape.arrays import Integers, Reals

Reason = PETSc.SNES.ConvergedReason
MEMORY = 15
"""Pairs of steps and gradients that quasi-Newton keeps, and its steps on one tangent."""
LONG = 150
"""Steps of conjugate gradients in a run: they restart with each."""


class Energy(Protocol):
    """An energy of nodal values, its gradient r and a tangent."""

    @property
    def constrained(self) -> Integers:
        """Unknowns, of all n f, that are constrained."""

    def residual(self, x: Reals, out: Reals) -> None:
        """Set `out` (n, f) to r; 0 at constrained unknowns."""

    def energy(self, x: Reals) -> float:
        """The energy whose gradient is r."""

    def tangent(self, x: Reals) -> PETSc.Mat:
        """The matrix that steps are made with."""


@dataclass(frozen=True)
class Kind:
    """A type of SNES.

    Args:
        snes: PETSc's type; options: of its own, without prefix.
        tangent: whether it solves with a tangent.
    """

    snes: str
    options: dict[str, object]
    tangent: bool = True


KINDS = {
    "quasi": Kind(
        "qn",
        {
            "snes_qn_type": "lbfgs",
            "snes_qn_m": MEMORY,
            "snes_qn_scale_type": "jacobian",
            "snes_qn_restart_type": "none",
            "snes_linesearch_type": "bt",
        },
    ),
    "newton": Kind("newtonls", {"snes_linesearch_type": "bt"}),
    # Steps along forces are lengths by stiffness: the line search must be let to find how long.
    "cg": Kind(
        "ncg",
        {"snes_ncg_type": "prp", "snes_linesearch_type": "cp", "snes_linesearch_max_it": 8},
        tangent=False,
    ),
}


# More than 15 attributes: what is called on the way, and what is known between two runs.
class Descent:
    """One SNES on an energy, run again and again from where it has come to.

    Args:
        comm: PETSc communicator.
        prefix: of its options in PETSc's database.
        energy: what is minimised.
        shape: (n, f) of the unknowns; rows: this rank's, of n f.
        kind: of `KINDS`.
        factor: PETSc's preconditioner for the tangent, applied once a step.
        reach: farthest way of a value in one step.

    Attributes:
        steps: of the last run; norm: of the residual after it.
        on_step: called with positions (n, f) and the norm of the residual at each iterate; a true answer ends the run.
        step_share: of positions (n, f) and a step (n, f), the largest share of it, at most 1, that may be gone.

    Source: docs/theory/cloth.md.
    """

    def __init__(
        self,
        comm: PETSc.Comm,
        prefix: str,
        energy: Energy,
        shape: tuple[int, ...],
        rows: slice,
        kind: str = "quasi",
        factor: str = "cholesky",
        reach: float = np.inf,
    ) -> None:
        self.energy, self.kind, self.reach = energy, KINDS[kind], reach
        self.nodal = NodalVectors(comm, shape, rows)
        self.x, self.f = self.nodal.vector(), self.nodal.vector()
        self.work = np.zeros(shape)
        self.on_step = lambda *_: False
        self.step_share: StepShare = whole_step
        self.steps, self.norm = 0, np.inf
        self.known: tuple[Reals, float] | None = None
        self._last = self.work
        self.prefix, self.ksp = prefix, self._solver(comm, prefix, factor) if self.kind.tangent else None
        self.tangent = PersistentKSP(self.ksp, self.kind.snes == "qn")
        self.snes = self._made()

    @property
    def uninterrupted(self) -> int:
        """Steps after which it restarts in any case, or may be restarted at little cost."""
        return MEMORY if self.kind.tangent else LONG

    @property
    def iterations(self) -> int:
        """Iterations of CG: it uses none."""
        return 0

    def destroy(self) -> None:
        """Free PETSc's objects."""
        for part in (self.snes, self.ksp, self.x, self.f):
            if part:
                part.destroy()

    def run(self, x: Reals, goal: float, most: int) -> float:
        """Go down from x (n, f), which is changed, to a residual of norm `goal`, in `most` steps.

        Returns: the norm that is reached.
        """
        self.goal, self.known, self._last = goal, None, x.copy()
        # A SNES that has run goes on with its steps, when tangent, friction or bodies were others.
        self.snes.destroy()
        self.snes = self._made()
        if self.kind.tangent:
            self.snes.setJacobian(weak_call(self._jacobian), self._taken(self.energy.tangent(x)))
        self.snes.setTolerances(max_it=most)
        self.nodal.put(x, self.x)
        self.snes.solve(None, self.x)
        self.steps = self.snes.getIterationNumber()
        x[:] = self.nodal.values(self.x)
        return self.norm

    def _function(self, snes: PETSc.SNES, X: PETSc.Vec, F: PETSc.Vec) -> None:
        self.energy.residual(self.nodal.values(X), self.work)
        self.nodal.put(self.work, F)

    def _objective(self, snes: PETSc.SNES, X: PETSc.Vec) -> float:
        x = self.nodal.values(X)
        # Line searches begin where the last one has ended.
        if self.known is None or not _kernels.same_values(self.known[0], x):
            self.known = x.copy(), self.energy.energy(x)
        return self.known[1]

    def _jacobian(self, snes: PETSc.SNES, X: PETSc.Vec, J: PETSc.Mat, P: PETSc.Mat) -> None:
        # That of the first iterate is there already.
        if snes.getIterationNumber():
            self._taken(self.energy.tangent(self.nodal.values(X)))

    def _taken(self, matrix: PETSc.Mat) -> PETSc.Mat:
        """A matrix that the solver takes next; its pattern may be another one, of which nothing informs PETSc."""
        if self.tangent.matrix.handle != matrix.handle:
            self.tangent.ksp.reset()
            self.tangent.matrix = matrix
            # SNES holds the first matrix of a run, which is as it was: it does not set up again within one.
            self.tangent.ksp.setOperators(matrix)
        return matrix

    def _shortened(self, X: PETSc.Vec, Y: PETSc.Vec) -> bool:
        """Make a step shorter that goes too far; returns whether it did."""
        far = Y.norm(PETSc.NormType.NORM_INFINITY)
        if far > self.reach:
            Y.scale(self.reach / far)
        # SNES goes along -Y. A search that makes steps longer is looked at when it has ended.
        share = self.step_share(self.nodal.values(X), -self.nodal.values(Y)) if self.kind.tangent else 1.0
        if share < 1.0:
            Y.scale(share)
        return far > self.reach or share < 1.0

    def _turned_back(self) -> bool:
        """Take back what the last step has gone too far, where its search may make steps longer; returns whether."""
        if self.kind.tangent:
            return False
        x = self.nodal.values(self.x).copy()
        share = self.step_share(self._last, x - self._last)
        if share < 1.0:
            x = self._last + share * (x - self._last)
            self.nodal.put(x, self.x)
            self.energy.residual(x, self.work)
            self.norm = float(np.linalg.norm(self.work))
        self._last = x
        return share < 1.0

    def _test(self, snes: PETSc.SNES, steps: int, norms: tuple[float, float, float]) -> int:
        self.norm = norms[2]
        if not np.isfinite(self.norm):
            return Reason.DIVERGED_FNORM_NAN
        if self._turned_back():
            # The next run starts from there.
            return Reason.CONVERGED_ITS
        if self.norm <= self.goal:
            return Reason.CONVERGED_FNORM_ABS
        return Reason.CONVERGED_ITS if self.on_step(self.nodal.values(self.x), self.norm) else Reason.ITERATING

    def _made(self) -> PETSc.SNES:
        snes = destroyed_at_exit(PETSc.SNES().create(self.nodal.comm))
        snes.setOptionsPrefix(self.prefix)
        snes.setType(self.kind.snes)
        options = PETSc.Options(self.prefix)
        given = [key for key in self.kind.options if not options.hasName(key)]
        for key in given:
            options.setValue(key, self.kind.options[key])
        snes.setFromOptions()
        snes.setFunction(weak_call(self._function), self.f)
        snes.setObjective(weak_call(self._objective))
        snes.setConvergenceTest(weak_call(self._test))
        snes.setLineSearchPreCheck(weak_call(self._shortened))
        if self.ksp:
            ksp = snes.getKSP()
            ksp.setType("preonly")
            ksp.getPC().setType("python")
            ksp.getPC().setPythonContext(self.tangent)
        for key in given:
            options.delValue(key)
        return snes

    def _solver(self, comm: PETSc.Comm, prefix: str, factor: str) -> PETSc.KSP:
        """One factor's application, whose pattern outlives runs."""
        ksp = destroyed_at_exit(PETSc.KSP().create(comm))
        ksp.setOptionsPrefix(prefix)
        ksp.setType("preonly")
        if factor == "cholesky" and comm.size > 1:
            # With factors of the ranks' own rows alone a descent would lead elsewhere.
            set_shared_factor(ksp, self.nodal.shape[1])
        else:
            set_preconditioner(ksp, factor, 0)
        ksp.setFromOptions()
        return ksp


class PersistentKSP:
    """A preconditioner that hands on to a solver, whose pattern SNES would forget with its own.

    Args:
        ksp: the solver.
        often: each matrix serves many steps.

    Attributes:
        matrix: what it solves with; SNES holds the first one of a run.
    """

    def __init__(self, ksp: PETSc.KSP, often: bool) -> None:
        self.ksp, self.often, self.matrix = ksp, often, PETSc.Mat()

    def setUp(self, pc: PETSc.PC) -> None:
        """Take in the matrix."""
        self.ksp.setOperators(self.matrix)
        self.ksp.setUp()
        if self.often:
            # In single precision descents of cloth that supports have torn end far above the others.
            substitute_by_panels(self.ksp, single=False)

    def apply(self, pc: PETSc.PC, x: PETSc.Vec, y: PETSc.Vec) -> None:
        """Set y to what the solver makes of x."""
        self.ksp.solve(x, y)
