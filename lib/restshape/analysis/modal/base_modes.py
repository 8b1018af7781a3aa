"""Modes of a structure as its moving base excites them: participation, and combinations of their peaks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from restshape.analysis.modal.frequencies import lowest_modes
from restshape.fem.time_integration import Rayleigh


@dataclass(frozen=True, eq=False)
class BaseModes:
    """The lowest modes on a base that moves along one direction.

    Args:
        omega: (k,) angular frequencies, ascending [rad/s].
        shapes: (n, k) of the free unknowns, with phi^T M phi = 1 [kg^-1/2].
        participation: (k,) phi . M 1 [kg^1/2], so that q'' + 2 z w q' + w^2 q = -participation a(t).
        mass: of the body [kg].
    """

    omega: np.ndarray
    shapes: np.ndarray
    participation: np.ndarray
    mass: float

    @property
    def frequencies(self) -> np.ndarray:
        """Eigenfrequencies (k,) [Hz]."""
        return self.omega / (2.0 * np.pi)

    @property
    def effective_mass(self) -> np.ndarray:
        """Shares (k,) of the body's mass that move with each mode: of all modes they add up to what is not fixed."""
        return self.participation**2 / self.mass

    def damping(self, rayleigh: Rayleigh) -> np.ndarray:
        """Shares (k,) of critical damping under Rayleigh's damping."""
        return 0.5 * (rayleigh.alpha / self.omega + rayleigh.beta * self.omega)


def base_modes(
    stiffness: sp.spmatrix, mass: sp.spmatrix, inertia: np.ndarray, body_mass: float, count: int
) -> BaseModes:
    """The lowest modes, each with the sign of which the participation is positive.

    Args:
        stiffness, mass: (n, n) of the free unknowns.
        inertia: (n,) M 1 at the free unknowns [kg]: minus the load of a unit acceleration of the base.
        body_mass: [kg].
        count: how many modes; fewer where there are not so many unknowns.
    """
    omega, shapes = lowest_modes(stiffness, mass, min(count, stiffness.shape[0] - 1))
    participation = shapes.T @ inertia
    signs = np.where(participation < 0.0, -1.0, 1.0)
    return BaseModes(omega, shapes * signs, participation * signs, body_mass)


def srss(peaks: np.ndarray) -> np.ndarray:
    """The root of the sum of squares (...) of the peaks (k, ...) of modes: for frequencies that are far apart."""
    return np.sqrt((np.asarray(peaks) ** 2).sum(axis=0))


def cqc(peaks: np.ndarray, omega: np.ndarray, damping: np.ndarray) -> np.ndarray:
    """The complete quadratic combination (...) of signed peaks (k, ...) of modes, as under white noise.

    Args:
        peaks: with the signs of the modes where they are looked at.
        omega: (k,) angular frequencies [rad/s].
        damping: (k,) shares of critical damping.

    Source: E. L. Wilson, A. Der Kiureghian and E. P. Bayo, Earthquake Engng Struct. Dyn. 9 (1981) 187.
    """
    peaks = np.asarray(peaks)
    squares = np.einsum("i...,ij,j...->...", peaks, correlation(omega, damping), peaks)
    return np.sqrt(np.maximum(squares, 0.0))


def correlation(omega: np.ndarray, damping: np.ndarray) -> np.ndarray:
    """Correlation coefficients (k, k) of modes under white noise; arguments as of `cqc`."""
    r = omega[None, :] / omega[:, None]
    own, other = damping[:, None], damping[None, :]
    above = 8.0 * np.sqrt(own * other) * (own + r * other) * r**1.5
    below = (1.0 - r**2) ** 2 + 4.0 * own * other * r * (1.0 + r**2) + 4.0 * (own**2 + other**2) * r**2
    # Undamped modes of one frequency are one.
    return np.divide(above, below, out=np.eye(len(omega)), where=below > 0.0)
