"""Time steps by other formulas than those that frames are solved by: with the highest rate as the unknown."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol

import numpy as np

from restshape.errors import ReplayProblem

if TYPE_CHECKING:
    import scipy.sparse as sp
    from scipy.sparse.linalg import SuperLU

CONVERGED = 1e-11
"""Change of the highest rates in a step of Newton's method, over the largest, at which a time step has converged."""
MOST = 60
"""Steps of Newton's method in a time step."""
LEAST = 1e-3
"""Part of a step of Newton's method that is taken at least."""


class PlainSystem(Protocol):
    """M y'' + C y' + r(y) = -M a_base of free unknowns (k,), or M y' + r(y) = 0, assembled from nothing.

    Attributes:
        mass, damping: (k, k); linear: the stiffness is constant.
    """

    mass: sp.csr_matrix
    damping: sp.csr_matrix
    linear: bool

    def residual(self, y: np.ndarray) -> np.ndarray:
        """Internal less applied forces (k,) at y (k,)."""

    def stiffness(self, y: np.ndarray) -> sp.csr_matrix:
        """The tangent (k, k) of these forces."""

    def base_force(self, time: float) -> np.ndarray:
        """M a_base (k,) at a time [s]."""


class PlainNewton:
    """Newton's method on complete factors, the step halved while it makes the residual larger.

    Args:
        linear: one factor serves all.
    """

    def __init__(self, linear: bool) -> None:
        self.linear = linear
        self._factor: SuperLU | None = None

    def __call__(
        self,
        x: np.ndarray,
        residual: Callable[[np.ndarray], np.ndarray],
        tangent: Callable[[np.ndarray], sp.csr_matrix],
    ) -> np.ndarray:
        """The root of the residual that is found from x (k,).

        Raises:
            ReplayProblem: none is found.
        """
        from scipy.sparse.linalg import splu

        force = residual(x)
        for _ in range(MOST):
            if self._factor is None or not self.linear:
                self._factor = splu(tangent(x).tocsc())
            change, part = self._factor.solve(force), 1.0
            while True:
                moved = x - part * change
                after = residual(moved)
                if part < LEAST or np.linalg.norm(after) < np.linalg.norm(force) or self._small(change, moved):
                    break
                part *= 0.5
            x, force = moved, after
            if self._small(part * change, x):
                return x
        raise ReplayProblem("the repeated step has no solution that is found")

    @staticmethod
    def _small(change: np.ndarray, x: np.ndarray) -> bool:
        return bool(np.abs(change).max(initial=0.0) <= CONVERGED * np.abs(x).max(initial=0.0))


def newmark_steps(
    system: PlainSystem, y: np.ndarray, v: np.ndarray, time: float, steps: int, dt: float, beta: float, gamma: float
) -> tuple[np.ndarray, np.ndarray]:
    """Unknowns and rates (k,) after steps of Newmark's method from y, v (k,) at a time [s].

    a' solves M a' + C v' + r(y') = -M a_base' with y' = y + dt v + dt^2 ((1/2 - beta) a + beta a') and
    v' = v + dt ((1 - gamma) a + gamma a'), which begins with the a of equilibrium.

    Source: T. J. R. Hughes, The Finite Element Method, 1987, section 9.1.
    """
    from scipy.sparse.linalg import splu

    a = splu(system.mass.tocsc()).solve(-system.residual(y) - system.damping @ v - system.base_force(time))
    solve = PlainNewton(system.linear)
    for k in range(1, steps + 1):
        base, last = system.base_force(time + k * dt), y
        y, v = y + dt * v + dt**2 * (0.5 - beta) * a, v + dt * (1 - gamma) * a

        def residual(a: np.ndarray, y: np.ndarray = y, v: np.ndarray = v, base: np.ndarray = base) -> np.ndarray:
            rest = system.residual(y + beta * dt**2 * a) + base
            return system.mass @ a + system.damping @ (v + gamma * dt * a) + rest

        def tangent(a: np.ndarray, y: np.ndarray = y) -> sp.csr_matrix:
            stiffness = system.stiffness(y + beta * dt**2 * a)
            return system.mass + gamma * dt * system.damping + beta * dt**2 * stiffness

        # From the last place: an acceleration that a new shape asks for may lead anywhere.
        a = solve((last - y) / (beta * dt**2), residual, tangent)
        y, v = y + beta * dt**2 * a, v + gamma * dt * a
    return y, v


def theta_steps(
    system: PlainSystem, y: np.ndarray, v: np.ndarray, steps: int, dt: float, theta: float
) -> tuple[np.ndarray, np.ndarray]:
    """Unknowns and rates (k,) after steps of the theta method from y, v (k,).

    v' solves M v' + theta r(y + dt v') + (1 - theta) r(y) = 0.
    """
    solve = PlainNewton(system.linear)
    for _ in range(steps):
        before = (1.0 - theta) * system.residual(y)

        def residual(v: np.ndarray, y: np.ndarray = y, before: np.ndarray = before) -> np.ndarray:
            return system.mass @ v + theta * system.residual(y + dt * v) + before

        def tangent(v: np.ndarray, y: np.ndarray = y) -> sp.csr_matrix:
            return system.mass + theta * dt * system.stiffness(y + dt * v)

        v = solve(np.zeros_like(v), residual, tangent)
        y = y + dt * v
    return y, v
