"""The way of a sheet to rest: motion with kinetic damping, descent, and Newton's method at the end."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from petsc4py import PETSc

from restshape.algebra.descent import MEMORY, Descent
from restshape.algebra.gather import whole_matrix
from restshape.algebra.kinetic_damping import KineticDamping, Steps
from restshape.algebra.linear import LinearSolver
from restshape.algebra.newton import Newton
from restshape.algebra.stages import Stages
from restshape.analysis.relaxation.equations import ClothEquations
from restshape.errors import ReplayProblem
from restshape.physics.cloth.sheet import Sheet

NEAR = 1e-3
"""Residual over load at which Newton's method takes over."""
ROUGH = 0.05
"""Residual over load at which the next softness, or mesh, takes over."""
DRAGGED = 1e-2
"""Way that anchors of friction may still be dragged at rest, over the way of slipping."""
STIFFER = 10.0
"""Factor of the inertia where a descent does not get on."""
MOST_INERTIA = 1e12
"""Inertia [1/s^2] above which there is no use in more."""
INVERSE_STEPS, LEAP = 4, 1e-3
"""Steps of the inverse iteration for the lowest mode of an unstable equilibrium; how far that is left along it [m]."""
FALLS = "nothing catches the cloth: it falls without end"
LEAST = 1e-9
"""Strain whose forces are the least that residuals of cloth without weight are measured against."""
ROUND_OFF = 4e-16
"""Rounding of a force, over the membrane's stiffness times the place of its node."""
FAINT = 1e-4
"""Inertia over that of descents below which an unstable motion is too slow to be one."""
TRIES = 4
"""Descents in a row that may fail before the cloth is said not to come to rest."""


@dataclass
class Arrival:
    """How a way to rest ended.

    Args:
        residual: norm of the forces out of balance over the load.
        at_rest: it is small enough, and no anchor of friction is dragged.
        stable: the true tangent there is positive definite; None: not looked at.
        steps: of all methods; newton: of Newton's; iterations: of linear solvers; factors: made.
        dragged: farthest way of an anchor at the end [m].
        falls: nothing catches the cloth.
        why: it is not at rest, for people.
    """

    residual: float = np.inf
    at_rest: bool = False
    stable: bool | None = None
    steps: int = 0
    newton: int = 0
    iterations: int = 0
    factors: int = 0
    dragged: float = 0.0
    falls: bool = False
    why: str = ""


class Rest:
    """Brings one sheet to rest, again and again, with patterns, factors and solvers that are kept.

    Args:
        sheet: the cloth.
        comm: PETSc communicator.
        stages: takes the time of values, factors and Krylov iterations.
        linear: solves for Newton's steps; None: Newton's method is not used.
        goal: residual over load at rest.
        motion: how kinetic damping steps.
        backend: of the operator.
        prefix: of options in PETSc's database.

    Attributes:
        on_iterate: called with positions (n, 3) and residual over load at each iterate of any method.

    Source: docs/theory.md, section "Cloth".
    """

    def __init__(
        self,
        sheet: Sheet,
        comm: PETSc.Comm,
        stages: Stages,
        linear: LinearSolver | None,
        goal: float = 1e-4,
        motion: Steps | None = None,
        backend: str | None = None,
        prefix: str = "drape_",
    ) -> None:
        self.sheet, self.comm, self.stages, self.linear, self.goal = sheet, comm, stages, linear, goal
        self.motion = motion or Steps()
        self.equations = ClothEquations(sheet, comm, stages, backend)
        rows, shape = self.equations.rows, (sheet.n_nodes, 3)
        self.moving = KineticDamping(comm, f"{prefix}kinetic_", self.equations, sheet.mass, shape, rows, self.motion)
        reach = self.motion.reach
        self.descent = Descent(comm, f"{prefix}descent_", self.equations, shape, rows, reach=reach)
        self.newton = Newton(comm, f"{prefix}newton_", linear, shape, rows) if linear else None
        if self.newton:
            self.newton.take(self.equations)
        self.rows, self.new_system, self.noted = rows, True, 0
        self.on_iterate: Callable[[np.ndarray, float], None] = lambda *_: None
        self.moving.on_step = self.descent.on_step = self._note
        # Friction that followed at peaks alone would be none for what slides ever faster and has no peak.
        self.moving.on_move = sheet.follow

    def destroy(self) -> None:
        """Free PETSc's objects."""
        # SNES calls `destroy` of its python context, whose name this must not be.
        self.moving.free()
        for part in (self.descent, self.newton):
            if part:
                part.destroy()
        # Matrices go with the operator, which must not wait until Python looks for cycles.
        del self.equations, self.moving, self.descent, self.newton

    def begin(self) -> None:
        """Take in that nodes, stiffness, supports or bodies have changed."""
        self.equations.begin()
        self.moving.weigh(self.sheet.mass)
        if self.newton:
            self.newton.take(self.equations)
            self.newton.begin(self.new_system, False, self._places())
            self.new_system = False

    def keep_short(self, reach: float) -> None:
        """Let no node go farther in one step than so much [m]."""
        self.motion = replace(self.motion, reach=reach)
        self.moving.steps, self.descent.reach = self.motion, reach

    def scale(self, x: np.ndarray) -> float:
        """What residuals are measured against [N]: the weight, or without any the forces at supports."""
        sheet = self.sheet
        if sheet.load > 0.0:
            return sheet.load
        forces = np.empty_like(x)
        sheet.inner(x, forces)
        least = LEAST * sheet.fabric.membrane.max() * sheet.area.sum() ** 0.5
        return max(float(np.linalg.norm(forces[sheet.mask.astype(bool)])), least)

    def lag(self, x: np.ndarray) -> float:
        """Let friction follow to x (n, 3); returns the farthest way of an anchor [m]."""
        return self.sheet.lag(x)

    def fall(self, x: np.ndarray, goal: float, arrival: Arrival) -> None:
        """Kinetic damping from x (n, 3), which is changed, until the residual over the load is at `goal`."""
        self.lag(x)
        try:
            with self.stages("krylov"):
                self.moving.run(x, goal * self.scale(x))
        except ReplayProblem as problem:
            # From where it has come to, other methods may get on.
            arrival.why = str(problem)
        arrival.residual = self.residual(x)
        arrival.steps += self.moving.snes.getIterationNumber()
        arrival.iterations += self.moving.iterations

    def descend(self, x: np.ndarray, goal: float, most: int, arrival: Arrival) -> bool:
        """Quasi-Newton steps from x (n, 3), which is changed, on a fresh tangent every few steps; tells of success."""
        equations, failed, taken = self.equations, 0, 0
        least = equations.inertia = equations.held_up
        arrival.why = ""
        while taken < most:
            arrival.dragged = self.lag(x)
            before = x.copy()
            with self.stages("krylov"):
                norm = self.descent.run(x, goal * self.scale(x), min(MEMORY, most - taken))
            steps = self.descent.steps
            arrival.factors, arrival.iterations = arrival.factors + 1, arrival.iterations + steps
            arrival.steps, taken = arrival.steps + steps, taken + max(steps, 1)
            arrival.residual = norm / self.scale(x)
            if not self.sound(x):
                x[:] = before
            if arrival.residual <= goal:
                return True
            if self.sheet.falls(x):
                arrival.falls, arrival.why = True, FALLS
                # Nothing is left of friction then.
                self.lag(x)
                return False
            # A descent that ends at once has a tangent that does not fit: more inertia makes steps shorter.
            failed = failed + 1 if steps < 2 else 0
            if failed >= TRIES:
                arrival.why = "no step makes the energy smaller"
                return False
            equations.inertia = equations.inertia * STIFFER if steps < 2 else max(equations.inertia / STIFFER, least)
        return False

    def polish(self, x: np.ndarray, arrival: Arrival) -> bool:
        """Newton's method from x (n, 3) near rest, which is changed where it finds one; tells whether it does."""
        scale, start = self.scale(x), x.copy()
        try:
            outcome = self.newton.solve(x, self.goal * scale, scale, searched=True, rounding=self.rounding)
        except ReplayProblem:
            x[:] = start
            return False
        arrival.newton += outcome.newton
        arrival.steps += outcome.newton
        arrival.iterations += outcome.iterations
        if not outcome.converged or not np.isfinite(x).all():
            x[:] = start
            return False
        arrival.residual = outcome.norm / scale
        self._note(x, outcome.norm)
        return True

    def settle(self, x: np.ndarray, most: int, arrival: Arrival) -> Arrival:
        """Descent and Newton's method from x (n, 3), which is changed, until nothing moves, friction included."""
        near, begun = max(NEAR, self.goal), arrival.steps
        while True:
            left = most - (arrival.steps - begun)
            if left <= 0:
                arrival.why = arrival.why or f"{most} steps are over"
                break
            if not self.descend(x, near, left, arrival):
                arrival.why = arrival.why or f"{most} steps are over"
                break
            if self.newton and not self.polish(x, arrival):
                # Where the true tangent is of no use yet, descent goes on alone.
                near = max(0.1 * near, self.goal)
                if near > self.goal or arrival.residual > self.goal:
                    continue
            arrival.dragged = self.lag(x)
            arrival.residual = self.residual(x)
            if arrival.residual <= self.goal and arrival.dragged <= DRAGGED * self.slip:
                arrival.at_rest, arrival.why = True, ""
                break
            if arrival.residual > self.goal and arrival.residual * self.scale(x) <= self.rounding * np.abs(x).max():
                arrival.why = "rounding leaves no smaller residual"
                break
            near = max(near, self.goal)
        return arrival

    def escape(self, x: np.ndarray) -> bool:
        """Leave an unstable equilibrium x (n, 3), which is changed, along its lowest mode; False where it is stable."""
        sheet, linear = self.sheet, self.linear
        least, places = FAINT * self.equations.held_up, self._places()
        inertia = least
        while not linear.definite(matrix := self.equations.true_tangent(x, inertia), places, False):
            inertia *= STIFFER
            if inertia > MOST_INERTIA:
                # What has no mass is not held up by any.
                return False
        if inertia == least:
            return False
        mode = self._lowest_mode(matrix)
        sides = x + mode, x - mode
        best = min(sides, key=sheet.energy)
        if not mode.any() or not self.sound(best):
            return False
        x[:] = best
        return True

    def _lowest_mode(self, matrix: PETSc.Mat) -> np.ndarray:
        """The lowest mode (n, 3) of a definite tangent, as long as the way off a saddle [m]; 0 where none is found."""
        sheet, nodal = self.sheet, self.moving.nodal
        rows = nodal.vector(), nodal.vector()
        mode = np.random.default_rng(0).uniform(-1.0, 1.0, (sheet.n_nodes, 3)) * sheet.free
        try:
            for _ in range(INVERSE_STEPS):
                nodal.put(sheet.mass[:, None] * mode, rows[0])
                rows[1].set(0.0)
                self.linear.solve(matrix, *rows, False, same_matrix=True, places=self._places(), aside=True)
                mode = nodal.values(rows[1]).copy()
                if not (size := np.abs(sheet.corners(mode)).max()):
                    break
                mode *= LEAP / size
        except ReplayProblem:
            mode = np.zeros_like(mode)
        finally:
            for row in rows:
                row.destroy()
        return mode

    @property
    def rounding(self) -> float:
        """Forces [N] a metre of the places below which a residual that steps do not lower any more is rounding."""
        return ROUND_OFF * float(self.sheet.fabric.membrane.max()) * len(self.sheet.mesh.X) ** 0.5

    def _places(self) -> np.ndarray:
        return self.sheet.X[self.rows.start // 3 : self.rows.stop // 3]

    def certify(self, x: np.ndarray) -> bool:
        """Tell whether the true tangent at x (n, 3) is positive definite, by a factor of all of it on each rank."""
        if self.comm.size == 1:
            return self.newton.definite(x)
        whole = whole_matrix(self.newton.tangent(x), self.comm)
        matrix = PETSc.Mat().createAIJ(whole.shape, csr=(whole.indptr, whole.indices, whole.data), comm=PETSc.COMM_SELF)
        pc = PETSc.PC().create(PETSc.COMM_SELF)
        pc.setType("cholesky")
        pc.setFactorOrdering("amd")
        pc.setOperators(matrix)
        pc.setUp()
        negative, zero, _ = pc.getFactorMatrix().getInertia()
        for part in (pc, matrix):
            part.destroy()
        return negative == 0 and zero == 0

    def residual(self, x: np.ndarray) -> float:
        """The forces out of balance over the load, at x (n, 3)."""
        out = np.empty_like(x)
        self.sheet.residual(x, out)
        return float(np.linalg.norm(out)) / self.scale(x)

    def sound(self, x: np.ndarray) -> bool:
        """Tell whether positions x (n, 3), their energy and their residual are numbers."""
        return bool(np.isfinite([np.abs(x).max(), self.sheet.energy(x), self.residual(x)]).all())

    @property
    def slip(self) -> float:
        """Way at which friction is all there [m]; infinite without contact."""
        return self.sheet.contact.slip if self.sheet.contact else np.inf

    def _note(self, x: np.ndarray, norm: float) -> bool:
        self.on_iterate(x, norm / self.scale(x))
        self.noted += 1
        # Looked at in every step it would cost a twentieth of it.
        return self.noted % MEMORY == 0 and self.sheet.falls(x)
