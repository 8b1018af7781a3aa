"""Small vibrating scenes for tests, and what a textbook says of them."""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from restshape_studies.stability import towers
from scipy.sparse.linalg import splu

from restshape.analysis.frame import Frame
from restshape.replay.loop import Replay

DAMPED = "\n[effects.damping]\nalpha = 0.8\nbeta = 2e-3\n"
NO_CELLS = np.empty(0, dtype=np.int32)
SHAKEN, dynamics, tower = towers.SHAKEN, towers.dynamics, partial(towers.tower, "moving")


def idle(replay: Replay) -> None:
    """One more frame in which nothing is edited."""
    analysis = replay.analysis
    analysis.solve(Frame(replay.moving.mesh, NO_CELLS, None, analysis.state.scene, (None, (0.0, 0.0))))


def textbook_newmark(
    matrices: Sequence[object], force: Callable[[float], np.ndarray], dt: float, beta: float, gamma: float, steps: int
) -> tuple[np.ndarray, np.ndarray]:
    """Displacements and velocities (n,) after so many steps from rest, by the form with the acceleration as unknown.

    Source: T. J. R. Hughes, The Finite Element Method, 1987, section 9.1.
    """
    stiffness, mass, damping = matrices
    u, v = np.zeros(mass.shape[0]), np.zeros(mass.shape[0])
    a = splu(mass.tocsc()).solve(force(0.0))
    factor = splu((mass + gamma * dt * damping + beta * dt**2 * stiffness).tocsc())
    for n in range(1, steps + 1):
        u = u + dt * v + dt**2 * (0.5 - beta) * a
        v = v + (1 - gamma) * dt * a
        a = factor.solve(force(n * dt) - damping @ v - stiffness @ u)
        u, v = u + beta * dt**2 * a, v + gamma * dt * a
    return u, v
