"""Newton's method by PETSc's SNES, on the one linear solver whose preconditioner outlives matrices and frames."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from petsc4py import PETSc

from restshape.algebra.gather import whole_vector
from restshape.algebra.linear import LinearSolver
from restshape.algebra.forcing_terms import Remainder
from restshape.errors import ReplayProblem

Reason = PETSc.SNES.ConvergedReason
INFINITE = PETSc.NormType.INFINITY
MOST_STEPS = 15
"""Steps at full length after which the equations are better approached in steps of load."""
MOST_SEARCHED = 60
"""Steps with a line search."""
SEARCHED = 1e-3
"""Residual over load at which a line search ends."""
STALLED = 0.5
"""A step near rounding that leaves more than this part of the residual has met it."""
GROWTH = 1e4
"""A residual that grows by more, from the first one or from the load, will not come back. (The first step of a slender
body stretches it, for rotations are linear in it: its residual grows by the square of length over thickness.)"""
COARSE = 0.1
"""Least reduction of the residual that a linear solve is asked for."""
SHARE = 0.5
"""Part of what is left over by the linear model that the linear solve leaves over at most."""


LEAST_SHIFT, SHIFT_GROWTH, MOST_SHIFT = 1e-8, 4.0, 1.0
"""What is added to the diagonal of an indefinite tangent, over the mean of its entries: grown until there is enough."""


class Equations(Protocol):
    """What Newton's method solves: r(x) = 0 for nodal values x (n, f); rows of other ranks need not be set."""

    potential: bool
    """Whether r is the gradient of an energy."""
    held: np.ndarray
    """Unknowns, of all n f, that never change."""

    def residual(self, x: np.ndarray, out: np.ndarray) -> None:
        """Set `out` (n, f) to r; 0 at held unknowns."""

    def assemble(self, x: np.ndarray, out: np.ndarray | None) -> PETSc.Mat:
        """The tangent dr/dx; sets `out` (n, f) to r in the same pass."""

    def energy(self, x: np.ndarray) -> float:
        """The energy whose gradient is r, over all ranks."""


@dataclass
class Outcome:
    """How a run of Newton's method ended.

    Args:
        converged: the residual is small enough.
        newton: steps taken.
        iterations: of the linear solver.
        refreshed: a preconditioner was made.
        monotone: no step has made the residual larger.
        why: it did not converge, for people.
        norm: of the last residual.
    """

    converged: bool
    newton: int
    iterations: int
    refreshed: bool
    monotone: bool
    why: str = ""
    norm: float = 0.0

    def after(self, other: "Outcome") -> "Outcome":
        """This run as the last one after another."""
        return Outcome(
            self.converged,
            self.newton + other.newton,
            self.iterations + other.iterations,
            self.refreshed or other.refreshed,
            self.monotone,
            self.why,
            self.norm,
        )


class Newton:
    """Solves equations on the nodes of one mesh, again and again.

    Steps have full length, or one that a line search finds: on the energy where there is one, else on the residual. A
    linear solve is as exact as pays: its rest is kept below what the linear model leaves over, which is estimated from
    the steps before (it grows like the square of the residual), and below the goal in the step that is to be the last.
    Where preconditioners are kept, so is the tangent for a last small step that a new one would not make better.

    Args:
        comm: PETSc communicator.
        prefix: of the options of the two SNES in PETSc's database.
        linear: solves for the steps.
        shape: (n, f) of the unknowns.
        rows: this rank's, of n f.

    Source: docs/theory.md, section 2; Eisenstat and Walker, SIAM J. Sci. Comput. 17 (1996) 16.
    """

    def __init__(
        self,
        comm: PETSc.Comm,
        prefix: str,
        linear: LinearSolver,
        shape: tuple[int, int],
        rows: slice,
    ) -> None:
        self.comm, self.linear, self.shape, self.rows = comm, linear, shape, rows
        self.equations: Equations | None = None
        size = (rows.stop - rows.start, shape[0] * shape[1])
        self.whole = comm.size == 1
        self.full, self.work = np.zeros(size[1]), np.zeros(shape)
        self.x = PETSc.Vec().createWithArray(self.full[rows], size=size, comm=comm)
        self.f = self.x.duplicate()
        self.prefix = prefix
        self.snes: dict[bool, PETSc.SNES] = {}
        self.mat: PETSc.Mat | None = None
        self.carried: dict[bool, int] = {}
        self.offset: np.ndarray | None = None
        self.left_over = Remainder()
        self.new_system, self.places, self.patched = True, None, False
        self.current = False

    def destroy(self) -> None:
        """Free PETSc's objects."""
        for part in (*self.snes.values(), self.x, self.f):
            part.destroy()

    def take(self, equations: Equations) -> None:
        """Solve these equations from now on, whose matrix has the same size."""
        self.equations, self.current = equations, False
        start, stop = self.rows.start, self.rows.stop
        self.held = equations.held[(equations.held >= start) & (equations.held < stop)] - start

    def tangent(self, x: np.ndarray) -> PETSc.Mat:
        """The tangent at x (n, f), assembled unless it is that of the last residual, which was at x."""
        if not self.current:
            self.mat = self.equations.assemble(x, None)
            self.current = True
        return self.mat

    def definite(self, x: np.ndarray) -> bool:
        """Tell whether the tangent at x (n, f) is positive definite, as far as the preconditioner can tell."""
        new_system, self.new_system = self.new_system, False
        return self.linear.definite(self.tangent(x), self.places, new_system)

    def begin(self, new_system: bool, patched: bool, places: np.ndarray) -> None:
        """A new frame: whether the mesh is another one, or has flips; `places` are those of this rank's nodes."""
        # A mesh on which nothing had to be solved for is still to be met.
        self.new_system |= new_system
        self.patched, self.places = patched, places
        self.current = False

    def solve(
        self,
        x: np.ndarray,
        goal: float,
        scale: float,
        searched: bool = False,
        offset: np.ndarray | None = None,
        rounding: float = 0.0,
    ) -> Outcome:
        """Find r(x) = offset from the guess in x (n, f), which is set to the last iterate.

        Args:
            x: held unknowns have their prescribed values.
            goal: norm of the residual at which it ends.
            scale: norm of the load, against which residuals are small or large, however small the goal is.
            searched: with line search, until the residual is small; an energy cannot tell the last digits.
            offset: (n, f) added load; None: none.
            rounding: times the largest value, the norm below which a residual that steps do not lower any more is
                rounding, and the end.
        """
        self.scale, self.rounding = scale, rounding
        if not searched:
            return self._run(x, goal, False, offset)
        rough = max(goal, SEARCHED * scale)
        outcome = self._run(x, rough, True, offset)
        if outcome.converged and rough > goal:
            outcome = self._run(x, goal, False, offset).after(outcome)
        return outcome

    def _run(self, x: np.ndarray, goal: float, searched: bool, offset: np.ndarray | None) -> Outcome:
        """One SNES from the guess in x; arguments as in `solve`."""
        self.goal, self.offset, self.searched = goal, offset, searched
        self.iterations, self.refreshed, self.monotone, self.why = 0, False, True, ""
        self.last = self.first = 0.0
        self.remainder: float | None = None
        self.chord, self.tangent_size, self.shift = False, 0.0, 0.0
        self.chords = self.linear.keeps and not searched
        # The first residual is evaluated together with the tangent, for one step is all but certain.
        self.fused = True
        self.full[:] = x.ravel()
        self.x.stateIncrease()
        snes = self._snes(searched)
        snes.solve(None, self.x)
        if not self.whole:
            whole_vector(self.full, self.rows, self.comm)
        x.ravel()[:] = self.full
        reason = snes.getConvergedReason()
        if reason < 0 and not self.why:
            self.why = WORDS.get(reason, "Newton's method fails")
        return Outcome(
            reason > 0,
            snes.getIterationNumber(),
            self.iterations,
            self.refreshed,
            self.monotone,
            self.why,
            self.last,
        )

    # --- what SNES asks for ---------------------------------------------------------------------------------------

    def _function(self, snes: PETSc.SNES, X: PETSc.Vec, F: PETSc.Vec) -> None:
        x = self._values(X)
        out = F.getArray().reshape(self.shape) if self.whole else self.work
        if self.fused:
            self.mat = self.equations.assemble(x, out)
        else:
            self.equations.residual(x, out)
        self.current = self.fused
        if self.offset is not None:
            out -= self.offset
        if not self.whole:
            F.getArray()[:] = out.ravel()[self.rows]

    def _jacobian(self, snes: PETSc.SNES, X: PETSc.Vec, J: PETSc.Mat, P: PETSc.Mat) -> None:
        bend = self.left_over.factor(self.steps)
        self.chord = (
            not self.current
            and self.chords
            and bend is not None
            and 2.0 * bend * self.tangent_size * self.last <= SHARE * self.goal
        )
        if self.chord:
            return
        self.tangent_size = self.last
        if not self.current:
            self.mat = self.equations.assemble(self._values(X), None)
            self.current = True

    def _objective(self, snes: PETSc.SNES, X: PETSc.Vec) -> float:
        x = self._values(X)
        energy = self.equations.energy(x)
        return energy if self.offset is None else energy - float(np.vdot(self.offset, x))

    def solve_step(self, b: PETSc.Vec, y: PETSc.Vec) -> bool:
        """Solve for a step; tells whether that went well."""
        target = self._target(b.norm())
        good = self._solved(b, y, target) or (self.searched and self.equations.potential and self._stiffened(b, y))
        # A preconditioner of several grids moves held unknowns too, as far as its tolerance lets it.
        y.getArray()[self.held] = 0.0
        return good

    def _solved(self, b: PETSc.Vec, y: PETSc.Vec, target: float) -> bool:
        """Solve with the tangent as it is; tells whether it is found to be positive definite."""
        linear, new_system = self.linear, self.new_system
        # Whatever comes of it, the solver has met this mesh then.
        self.new_system = False
        y.set(0.0)
        try:
            report = linear.solve(
                self.mat,
                b,
                y,
                new_system,
                patched=self.patched,
                places=self.places,
                scale=target / linear.tolerance,
            )
        except ReplayProblem as problem:
            self.why = INDEFINITE if linear.symmetric else str(problem)
            return False
        self.iterations += report.iterations
        self.refreshed |= report.refreshed
        if report.refreshed and linear.negative_pivots():
            self.why = INDEFINITE
            return False
        return True

    def _stiffened(self, b: PETSc.Vec, y: PETSc.Vec) -> bool:
        """Solve with a tangent that a multiple of the unit matrix makes positive definite: a way down in energy."""
        diagonal = self.mat.getDiagonal()
        size = diagonal.norm(PETSc.NormType.NORM_1) / diagonal.getSize()
        diagonal.destroy()
        self.current, added = False, 0.0
        shift = max(LEAST_SHIFT, self.shift / SHIFT_GROWTH**2)
        while shift <= MOST_SHIFT:
            self.mat.shift((shift - added) * size)
            if self.linear.definite(self.mat, self.places) and self._solved(b, y, COARSE * b.norm()):
                self.why, self.shift = "", shift
                return True
            added, shift = shift, SHIFT_GROWTH * shift
        return False

    def _target(self, size: float) -> float:
        """The rest that a linear solve may leave of a residual of that size."""
        goal, bend = self.goal, self.left_over.factor(self.steps)
        if bend is None:
            self.remainder = None
            target = COARSE * size
        else:
            # With the tangent of the step before, the model leaves over what both steps together do.
            rest = self.remainder = bend * size * (2.0 * self.tangent_size if self.chord else size)
            target = goal - rest if rest <= SHARE * goal else max(SHARE * goal, SHARE * min(rest, COARSE * size))
        # A residual that needs no further tangent, or none but the present one, is evaluated without.
        self.fused = self.remainder is None or not (
            self.remainder <= SHARE * goal or (self.chords and 2.0 * bend * size * self.remainder <= SHARE * goal)
        )
        if self.searched:
            target = min(target, COARSE * COARSE * size)
        self.target = min(target, COARSE * size)
        return self.target

    def _test(self, snes: PETSc.SNES, steps: int, norms: tuple[float, float, float]) -> int:
        norm = norms[2]
        stalled = steps > 0 and norm > STALLED * self.last and norm <= self.rounding * self.x.norm(INFINITE)
        if steps == 0:
            self.first = norm
        elif self.searched or stalled:
            # Shorter steps tell nothing of what full ones leave over, nor does rounding.
            pass
        elif self.chord:
            # A kept tangent that does not serve is given up.
            self.chords = norm < COARSE * self.last
        else:
            self.left_over.learn(steps - 1, self.last, norm, self.target)
        self.steps = steps
        if steps and norm > self.last:
            self.monotone = False
        self.last = norm
        if norm <= self.goal or stalled:
            return Reason.CONVERGED_FNORM_ABS
        if not np.isfinite(norm):
            return Reason.DIVERGED_FNORM_NAN
        if self.searched:
            return Reason.ITERATING if steps < MOST_SEARCHED else Reason.DIVERGED_MAX_IT
        if norm > GROWTH * max(self.first, self.scale):
            return Reason.DIVERGED_DTOL
        return Reason.ITERATING if steps < MOST_STEPS else Reason.DIVERGED_MAX_IT

    def _values(self, X: PETSc.Vec) -> np.ndarray:
        """All nodal values (n, f) of a distributed vector."""
        own = X.getArray(readonly=True)
        if self.whole:
            return own.reshape(self.shape)
        gathered = np.empty(self.full.size)
        gathered[self.rows] = own
        return whole_vector(gathered, self.rows, self.comm).reshape(self.shape)

    # --- set-up ---------------------------------------------------------------------------------------------------

    def _snes(self, searched: bool) -> PETSc.SNES:
        if searched not in self.snes:
            self.snes[searched] = self._made(searched)
        snes = self.snes[searched]
        if self.mat is None:
            self.mat = self.equations.assemble(self.full.reshape(self.shape), None)
        # SNES only carries a matrix; the step's solver has the present one from the equations.
        if self.carried.get(searched) != self.mat.handle:
            snes.setJacobian(self._jacobian, self.mat)
            self.carried[searched] = self.mat.handle
        return snes

    def _made(self, searched: bool) -> PETSc.SNES:
        snes = PETSc.SNES().create(self.comm)
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
        snes.setFunction(self._function, self.f)
        if searched and self.equations.potential:
            snes.setObjective(self._objective)
        snes.setConvergenceTest(self._test)
        # The test counts the steps; SNES has a limit of its own, below that of a line search.
        snes.setTolerances(max_it=2 * MOST_SEARCHED)
        ksp = snes.getKSP()
        ksp.setType("python")
        ksp.setPythonContext(Step(self))
        ksp.getPC().setType("none")
        return snes


class Step:
    """The Krylov solver of the two SNES: hands their linear systems on.

    Args:
        newton: whose systems they are.
    """

    def __init__(self, newton: Newton) -> None:
        self.newton = newton

    def solve(self, ksp: PETSc.KSP, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Solve for the step x of the residual b."""
        good = self.newton.solve_step(b, x)
        ksp.setConvergedReason(
            PETSc.KSP.ConvergedReason.CONVERGED_ITS if good else PETSc.KSP.ConvergedReason.DIVERGED_BREAKDOWN
        )


INDEFINITE = "the tangent stiffness is not positive definite: such an equilibrium is unstable"
WORDS = {
    Reason.DIVERGED_FNORM_NAN: "the residual is no number",
    Reason.DIVERGED_DTOL: "the residual grows without bound",
    Reason.DIVERGED_MAX_IT: "Newton's method does not come to an end",
    Reason.DIVERGED_LINE_SEARCH: "no step makes the energy smaller",
    Reason.DIVERGED_LINEAR_SOLVE: "the linear solve fails",
}
