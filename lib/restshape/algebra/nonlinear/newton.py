"""Newton's method by PETSc's SNES, on the one linear solver whose preconditioner outlives matrices and frames."""

import logging
from collections.abc import Callable

import numpy as np
from petsc4py import PETSc

from restshape.algebra.at_exit import destroyed_at_exit
from restshape.algebra.linear import LinearSolver
from restshape.algebra.nodal import NodalVectors
from restshape.algebra.nonlinear.equations import Equations
from restshape.algebra.nonlinear.forcing_terms import ForcingTerms
from restshape.algebra.nonlinear.newton_convergence import MOST_SEARCHED, WORDS, ConvergenceTest, Outcome
from restshape.algebra.nonlinear.newton_step import NewtonStep
from restshape.algebra.nonlinear.step_share import StepShare
from restshape.algebra.nonlinear.tangent import Tangent
from restshape.algebra.weak_calls import weak_call
from restshape.arrays import Reals
from restshape.first_use import made

log = logging.getLogger("restshape.algebra")

INFINITE = PETSc.NormType.INFINITY
SEARCHED = 1e-3
"""Residual over load at which a line search ends."""


class Newton:
    """Solves equations on the nodes of one mesh, again and again.

    Steps have full length, or one that a line search finds: on the energy where there is one, else on the residual.

    Args:
        comm: PETSc communicator.
        prefix: of the options of the two SNES in PETSc's database.
        linear: solves for the steps.
        shape: (n, f) of the unknowns.
        rows: this rank's, of n f.

    Attributes:
        step_share: of values (n, f) and a step (n, f), the largest share of it that may be gone; None: all of any.

    Source: docs/theory/solids.md.
    """

    def __init__(
        self, comm: PETSc.Comm, prefix: str, linear: LinearSolver, shape: tuple[int, ...], rows: slice
    ) -> None:
        self.nodal, self.prefix = NodalVectors(comm, shape, rows), prefix
        self._taken: Tangent | None = None
        self._step, self._forcing = NewtonStep(linear), ForcingTerms()
        self._test = ConvergenceTest(0.0, 0.0, False, 0.0)
        self._offset: Reals | None = None
        self._x, self._f, self._work = self.nodal.vector(), self.nodal.vector(), np.zeros(shape)
        self.step_share: StepShare | None = None
        self._snes: dict[bool, PETSc.SNES] = {}
        self._handles: dict[bool, int] = {}

    def destroy(self) -> None:
        """Free PETSc's objects."""
        for part in (*self._snes.values(), self._x, self._f):
            part.destroy()

    @property
    def equations(self) -> Equations:
        """What is solved."""
        return self._tangent.equations

    @property
    def _tangent(self) -> Tangent:
        """Of what is solved."""
        return made(self._taken)

    def set_equations(self, equations: Equations) -> None:
        """Solve these equations from now on, whose matrix has the same size."""
        before, self._taken = self._taken, Tangent(equations)
        if before:
            # The two SNES carry it until there is another one.
            self._taken.mat = before.mat

    def tangent(self, x: Reals) -> PETSc.Mat:
        """The tangent at x (n, f), assembled unless it is there."""
        return self._tangent.at(x)

    def definite(self, x: Reals) -> bool:
        """Whether the tangent at x (n, f) is positive definite, as far as the preconditioner can show."""
        return self._step.definite(self._tangent.at(x))

    def solve_linear(self, mat: PETSc.Mat, right: Reals, part: float) -> Reals | None:
        """The solution (n, f) of a system with a matrix of these equations, by the linear solver of the steps.

        Args:
            mat: another tangent than the true one, too.
            right: (n, f).
            part: of the right side's norm that may be left.

        Returns: None where the matrix is found not to be positive definite.
        """
        self.nodal.put(right, self._f)
        self._step.begin_run()
        good = self._step.solve_with(mat, self._f, self._x, part * self._f.norm())
        return self.nodal.values(self._x).copy() if good else None

    @property
    def linear_work(self) -> tuple[int, int]:
        """Iterations, and preconditioners made, of the last run or linear system."""
        return self._step.iterations, int(self._step.refreshed)

    def begin(self, new_system: bool, patched: bool, places: Reals | None) -> None:
        """A new frame: whether the mesh is another one, or has flips; `places` are those of this rank's nodes."""
        self._step.begin_frame(new_system, patched, places)

    def solve(
        self,
        x: Reals,
        goal: float,
        scale: float,
        searched: bool = False,
        offset: Reals | None = None,
        rounding: float = 0.0,
    ) -> Outcome:
        """Find r(x) = offset from the guess in x (n, f), which is set to the last iterate.

        Args:
            x: constrained unknowns have their prescribed values.
            goal: norm of the residual at which it ends.
            scale: norm of the load, against which residuals are small or large, however small the goal is.
            searched: with line search, until the residual is small; an energy cannot resolve the last digits.
            offset: (n, f) added load; None: none.
            rounding: times the largest value, the norm below which a residual that steps do not lower any more is
                rounding, and the end.
        """
        self._offset = offset
        if not searched:
            return self._run(x, ConvergenceTest(goal, scale, False, rounding))
        rough = max(goal, SEARCHED * scale)
        outcome = self._run(x, ConvergenceTest(rough, scale, True, rounding))
        if outcome.converged and rough > goal:
            outcome = self._run(x, ConvergenceTest(goal, scale, False, rounding)).after(outcome)
        return outcome

    def _run(self, x: Reals, test: ConvergenceTest) -> Outcome:
        """One SNES from the guess in x (n, f), which is set to the last iterate."""
        self._test, step = test, self._step
        step.begin_run()
        self._forcing.begin(test.goal, test.searched, step.linear.keeps)
        self.nodal.put(x, self._x)
        snes = self._snes_for(test.searched)
        snes.solve(None, self._x)
        x[:] = self.nodal.values(self._x)
        reason = snes.getConvergedReason()
        why = step.why
        if reason < 0 and not why:
            why = WORDS.get(reason, "Newton's method fails")
        newton = snes.getIterationNumber()
        log.debug("Nonlinear %s solve %s iterations %d", self.prefix, why or "converged", newton)
        return Outcome(reason > 0, newton, step.iterations, step.refreshed, test.monotone, why, test.last)

    # --- what SNES asks for ---------------------------------------------------------------------------------------

    def _function(self, snes: PETSc.SNES, X: PETSc.Vec, F: PETSc.Vec) -> None:
        x = self.nodal.values(X)
        out = F.getArray().reshape(self.nodal.shape) if self.nodal.whole else self._work
        if self._forcing.fused:
            self._tangent.assemble(x, out)
        else:
            self.equations.residual(x, out)
        if self._offset is not None:
            out -= self._offset
        if not self.nodal.whole:
            self.nodal.put(out, F)

    def _jacobian(self, snes: PETSc.SNES, X: PETSc.Vec, J: PETSc.Mat, P: PETSc.Mat) -> None:
        x, test = self.nodal.values(X), self._test
        assembled = self._tangent.is_at(x)
        if not self._forcing.choose_tangent(test.steps, test.last, assembled) and not assembled:
            self._tangent.assemble(x, None)

    def _objective(self, snes: PETSc.SNES, X: PETSc.Vec) -> float:
        x = self.nodal.values(X)
        energy = self.equations.energy(x)
        return energy if self._offset is None else energy - float(np.vdot(self._offset, x))

    def _shortened(self, X: PETSc.Vec, Y: PETSc.Vec) -> bool:
        """Make a step shorter that would pass what must not be passed; returns whether it did."""
        # SNES goes along -Y.
        share = self.step_share(self.nodal.values(X), -self.nodal.values(Y)) if self.step_share else 1.0
        if share < 1.0:
            Y.scale(share)
        return share < 1.0

    def solve_step(self, b: PETSc.Vec, y: PETSc.Vec) -> bool:
        """Solve for the step y of the residual b; returns whether that went well."""
        target = self._forcing.tolerance(self._test.steps, b.norm())
        shifts = self._test.searched and self.equations.potential
        return self._step.solve(self._tangent, b, y, target, shifts)

    def _converged(self, snes: PETSc.SNES, steps: int, norms: tuple[float, float, float]) -> int:
        test, norm = self._test, norms[2]
        log.debug("%3d SNES Function norm %.12e", steps, norm)
        stalled = steps > 0 and test.stalled(norm, lambda: self._x.norm(INFINITE))
        if steps and not stalled:
            # Nothing is learned from rounding.
            self._forcing.learn(steps - 1, test.last, norm)
        return test.reason(steps, norm, stalled)

    # --- set-up ---------------------------------------------------------------------------------------------------

    def _snes_for(self, searched: bool) -> PETSc.SNES:
        if searched not in self._snes:
            self._snes[searched] = self._make(searched)
        snes, tangent = self._snes[searched], self._tangent
        if tangent.mat is None:
            tangent.assemble(self.nodal.values(self._x), None)
        # SNES only carries a matrix; the step's solver has the present one from the equations.
        if self._handles.get(searched) != tangent.mat.handle:
            snes.setJacobian(weak_call(self._jacobian), tangent.mat)
            self._handles[searched] = tangent.mat.handle
        return snes

    def _make(self, searched: bool) -> PETSc.SNES:
        snes = destroyed_at_exit(PETSc.SNES().create(self.nodal.comm))
        prefix = f"{self.prefix}{'searched' if searched else 'full'}_"
        snes.setOptionsPrefix(prefix)
        snes.setType("newtonls")
        options = PETSc.Options(prefix)
        given = not options.hasName("snes_linesearch_type")
        if given:
            options.setValue("snes_linesearch_type", "bt" if searched else "basic")
        snes.setFromOptions()
        if given:
            options.delValue("snes_linesearch_type")
        snes.setFunction(weak_call(self._function), self._f)
        if searched and self.equations.potential:
            snes.setObjective(weak_call(self._objective))
        snes.setConvergenceTest(weak_call(self._converged))
        snes.setLineSearchPreCheck(weak_call(self._shortened))
        # The test counts the steps; SNES has a limit of its own, below that of a line search.
        snes.setTolerances(max_it=2 * MOST_SEARCHED)
        ksp = snes.getKSP()
        ksp.setType("python")
        ksp.setPythonContext(KSPContext(weak_call(self.solve_step)))
        ksp.getPC().setType("none")
        return snes


class KSPContext:
    """The Krylov solver of the two SNES: hands their linear systems on.

    Args:
        solve_step: solves for the step (second argument) of a residual; returns whether that went well.
    """

    def __init__(self, solve_step: Callable[[PETSc.Vec, PETSc.Vec], bool]) -> None:
        self.solve_step = solve_step

    def solve(self, ksp: PETSc.KSP, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Solve for the step x of the residual b."""
        good = self.solve_step(b, x)
        ksp.setConvergedReason(
            PETSc.KSP.ConvergedReason.CONVERGED_ITS if good else PETSc.KSP.ConvergedReason.DIVERGED_BREAKDOWN
        )
