"""What makes a solid vibrate: Newmark's step, inertia, Rayleigh damping, shaking ground."""

from dataclasses import dataclass
from math import pi, sin
from typing import Any

import numpy as np

from restshape import _kernels
from restshape.errors import ReplayProblem, UserError
from restshape.physics.elasticity.plane_solid import SHAPES, PlaneSolid

MASSES = {"consistent": "mass", "lumped": "lumped_mass"}
CONVERGED = 1e-15
"""Residual of a solve with the mass matrix, relative to the right side."""


@dataclass(frozen=True)
class Newmark:
    """One step u, v, a -> u', v', a' of Newmark's method.

    a' = a0 (u' - u) - a2 v - a3 a and v' = a1 (u' - u) - a4 v - a5 a, with M a' + C v' + K u' = f'.

    Args:
        beta, gamma: 1/4 and 1/2 are the average acceleration: unconditionally stable, no damping of its own.
        dt: step [s].

    Source: docs/theory.md, section 2; N. M. Newmark, A method of computation for structural dynamics, 1959.
    """

    beta: float
    gamma: float
    dt: float

    @property
    def a0(self) -> float:
        """1 / (beta dt^2) [1/s^2]."""
        return 1.0 / (self.beta * self.dt**2)

    @property
    def a1(self) -> float:
        """gamma / (beta dt) [1/s]."""
        return self.gamma / (self.beta * self.dt)

    @property
    def a2(self) -> float:
        """1 / (beta dt) [1/s]."""
        return 1.0 / (self.beta * self.dt)

    @property
    def a3(self) -> float:
        """1 / (2 beta) - 1."""
        return 0.5 / self.beta - 1.0

    @property
    def a4(self) -> float:
        """gamma / beta - 1."""
        return self.gamma / self.beta - 1.0

    @property
    def a5(self) -> float:
        """dt (gamma / (2 beta) - 1) [s]: 0 for gamma = 2 beta, where the step needs M a alone, never a itself."""
        return self.dt * (0.5 * self.gamma - self.beta) / self.beta


@dataclass(frozen=True)
class Rayleigh:
    """Damping C = alpha M + beta K: a mode of angular frequency w has the ratio alpha / (2 w) + beta w / 2.

    Args:
        alpha: [1/s].
        beta: [s].
    """

    alpha: float = 0.0
    beta: float = 0.0

    @classmethod
    def of(cls, settings: Any) -> "Rayleigh":
        """The damping that ``[effects.damping]`` asks for; none when it is off (None)."""
        if settings is None:
            return cls()
        if settings.ratio is None:
            return cls(settings.alpha or 0.0, settings.beta or 0.0)
        first, second = (2 * pi * f for f in settings.frequencies)
        return cls(2 * settings.ratio * first * second / (first + second), 2 * settings.ratio / (first + second))


class Ground:
    """Harmonic motion of the ground: displacement -A / w^2 sin(w t), acceleration A sin(w t) along a direction.

    Args:
        settings: of ``[effects.ground]``.
        before, now: the motion until this time [s]; where the frequency changes, the phase goes on.
    """

    def __init__(self, settings: Any, before: "Ground | None" = None, now: float = 0.0) -> None:
        direction = np.array(settings.direction, dtype=float)
        self.omega = 2 * pi * settings.frequency
        size = settings.acceleration if settings.acceleration is not None else -settings.displacement * self.omega**2
        self.direction = direction / np.linalg.norm(direction)
        self.amplitude = size * self.direction
        self.phase = 0.0 if before is None else before.phase + (before.omega - self.omega) * now

    def acceleration(self, t: float) -> np.ndarray:
        """The ground's acceleration (2,) [m/s^2] at the time t [s]."""
        return self.amplitude * sin(self.omega * t + self.phase)


class Inertia:
    """The mass matrix of a solid, applied element by element on all nodes.

    Args:
        solid: on a mesh whose nodes may move.
        mass: "consistent" or "lumped" onto the diagonal (by the sums of rows; of second order, where those of corners
            are 0, by the diagonal scaled to the mass).

    Raises:
        UserError: a material has no density.
    """

    def __init__(self, solid: PlaneSolid, mass: str) -> None:
        self.solid, self.mesh, self.lumped = solid, solid.mesh, mass == "lumped"
        shape, _ = SHAPES[self.mesh.cells.shape[1]]
        elements = {name: _kernels.Element(f"{start}_{shape}") for name, start in MASSES.items()}
        self.element = elements[mass]
        self._consistent, self._lumped = elements.values()
        region = self.mesh.cell_region
        thickness, density = solid.materials[:, 2], solid.materials[:, 3]
        # Regions that fill the shape leave no cell to row 0, whose material may not exist.
        if not np.all(density[np.unique(region)] > 0):
            raise UserError(
                "a body without density cannot vibrate",
                f"{solid.scene.path}: material",
                'give each material its rho, e.g. rho = "2400 kg/m^3"',
            )
        table = (density * thickness)[:, None]
        self.params = np.ascontiguousarray(table[region] if np.any(region) else table[0])

    def apply(self, v: np.ndarray) -> np.ndarray:
        """M v (n, 2) of nodal values v (n, 2)."""
        return self._product(self.element, v)

    def energies(self, v: np.ndarray) -> np.ndarray:
        """Kinetic energies (ne,) [J] of the cells at the velocities v (n, 2) [m/s]; they sum to half of v . M v."""
        return self.element.energy(self.mesh.X, v, self.mesh.cells, self.params)

    def momentum(self, v: np.ndarray) -> np.ndarray:
        """Linear momentum (2,) [kg m/s] of the velocities v (n, 2) [m/s]."""
        return self.apply(v).sum(axis=0)

    def solve(self, rhs: np.ndarray, consistent: bool = False) -> np.ndarray:
        """The w (n, 2), 0 where the solid is held, for which M w = rhs elsewhere.

        Conjugate gradients with the lumped mass as preconditioner (its condition number is 4 at most: Wathen 1987).

        Args:
            rhs: (n, 2).
            consistent: with the consistent mass even where the analysis uses the lumped one.

        Raises:
            ReplayProblem: no convergence.
        """
        free = self.solid.mask == 0
        inverse = free / self._product(self._lumped, np.ones_like(self.mesh.X))
        if self.lumped and not consistent:
            return inverse * rhs
        r = rhs * free
        goal = CONVERGED * np.linalg.norm(r)
        w, z = np.zeros_like(r), inverse * r
        p, rz = z.copy(), np.vdot(r, z)
        for _ in range(200):
            if np.linalg.norm(r) <= goal:
                return w
            q = self._product(self._consistent, p) * free
            step = rz / np.vdot(p, q)
            w += step * p
            r -= step * q
            z = inverse * r
            rz, last = np.vdot(r, z), rz
            p = z + (rz / last) * p
        raise ReplayProblem("the solve with the mass matrix did not converge")

    def _product(self, element: Any, v: np.ndarray) -> np.ndarray:
        out = np.zeros_like(v)
        element.residual(self.mesh.X, v, self.mesh.cells, self.params, out)
        return out
