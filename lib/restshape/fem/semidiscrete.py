"""A problem that is discrete in space and not yet in time: its forces, inertia, damping and energy."""

import numpy as np

from restshape.fem.assembled import Assembled
from restshape.fem.mass import MassMatrix
from restshape.fem.problem import INTERNAL, REFERENCE, STIFFNESS, TransientProblem
from restshape.fem.residuals import dead_loads, energy, unconstrained_residual
from restshape.fem.time_integration import Rayleigh


class SemiDiscrete:
    """M y'' + C y' + K y = `static` - M 1 a_base for y, the unknowns less the prescribed ones; or M y' + K y.

    Args:
        problem: its nodes may move and its edges may flip.
        damping: C, of the stiffness where all unknowns are 0.

    Attributes:
        static: (n, f) loads less internal forces of the prescribed unknowns; linear problems alone use it.
        constrained: (n, f) whether an unknown is prescribed.

    Raises:
        UserError: the problem refuses its mass.
    """

    def __init__(self, problem: TransientProblem, damping: Rayleigh) -> None:
        self.problem, self.damping_of, self.mass = problem, damping, MassMatrix(problem)
        self.constrained = problem.boundary.mask.astype(bool)
        shifted = problem.boundary.nonzero or problem.varies
        self._loaded = problem.loaded or shifted
        self._residual_counts = problem.loaded_inside or shifted or not problem.linear
        self.static = np.zeros(problem.boundary.mask.shape)
        self.update()

    def update(self) -> None:
        """Evaluate again what depends on the place of the nodes."""
        if self._loaded:
            problem = self.problem
            problem.update()
            dead_loads(problem, self.static)
            if self._residual_counts:
                self.static -= Assembled(problem.integrals(INTERNAL)).residual(problem.boundary.values)
            self.static[self.constrained] = 0.0

    def unknowns(self, y: np.ndarray) -> np.ndarray:
        """The unknowns (n, f), prescribed ones included: not to be changed, for y may be all of them."""
        boundary = self.problem.boundary
        return y + boundary.values if boundary.nonzero else y

    def acceleration(self, y: np.ndarray, v: np.ndarray, base: np.ndarray) -> np.ndarray:
        """The acceleration (n, f) relative to the base that equilibrium asks for.

        Args:
            y, v: (n, f) as in a `TimeState`.
            base: (f,) its acceleration.
        """
        force = self.force(y) - self.damping(v)
        if base.any():
            force -= self.mass.apply(np.zeros_like(y) + base)
        return self.mass.solve(force)

    def force(self, y: np.ndarray) -> np.ndarray:
        """Applied less internal forces (n, f) at y (n, f); without meaning where unknowns are prescribed."""
        if self.problem.linear:
            return self.static - Assembled(self.problem.integrals(STIFFNESS)).residual(y)
        return -unconstrained_residual(self.problem, self.unknowns(y))

    def change_of_force(
        self, before: tuple[np.ndarray, np.ndarray], now: tuple[np.ndarray, np.ndarray], base: np.ndarray
    ) -> np.ndarray:
        """What applied less internal and damping forces (n, f), less the inertia of the base, change by.

        Args:
            before, now: y and v (n, f) each.
            base: (f,) change of its acceleration.
        """
        (y, v), (new_y, new_v) = before, now
        alpha, beta = self.damping_of.alpha, self.damping_of.beta
        if self.problem.linear:
            strain = new_y - y + beta * (new_v - v) if beta else new_y - y
            out = -Assembled(self.problem.integrals(STIFFNESS)).residual(strain)
        else:
            out = self.force(new_y) - self.force(y)
            if beta:
                out -= Assembled(self.problem.integrals(REFERENCE)).residual(beta * (new_v - v))
        if alpha or base.any():
            out -= self.mass.apply(alpha * (new_v - v) + base)
        return out

    def damping(self, v: np.ndarray) -> np.ndarray:
        """C v (n, f) at the rates v (n, f)."""
        alpha, beta = self.damping_of.alpha, self.damping_of.beta
        out = self.mass.apply(alpha * v) if alpha else np.zeros_like(v)
        return Assembled(self.problem.integrals(REFERENCE)).residual(beta * v, out) if beta else out

    def inertia_and_damping(self, y: np.ndarray, v: np.ndarray, base: np.ndarray) -> np.ndarray:
        """M (a + a_base) + C v (n, f) at all nodes, prescribed ones too: with internal forces less loads, reactions.

        Args:
            y, v: (n, f) as in a `TimeState`; a is the acceleration that equilibrium asks for.
            base: (f,) acceleration of the base.

        Source: docs/theory/solids.md, "Reactions and strain energy".
        """
        return self.mass.apply(self.acceleration(y, v, base) + base) + self.damping(v)

    def energy(self, y: np.ndarray, v: np.ndarray) -> float:
        """Internal energy and kinetic energy relative to the base; y, v (n, f)."""
        return float(energy(self.problem, self.unknowns(y)) + self.mass.energies(v).sum())
