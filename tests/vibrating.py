"""Small vibrating scenes for tests, and what a textbook says of them."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from scipy.sparse.linalg import splu
from small_scenes import block, head, meshed, write_scene

from restshape.analysis.frame import Frame
from restshape.replay.loop import Replay

HEAD = head("moving")
DAMPED = "\n[effects.damping]\nalpha = 0.8\nbeta = 2e-3\n"
NO_CELLS = np.empty(0, dtype=np.int32)


RUBBER = '\n[material.rubber]\nE = "2 MPa"\nnu = 0.3\nrho = 1000\nthickness = 0.1\n'
HELD = '\n[supports.foot]\non = "bottom"\nfix = ["x", "y"]\n'
SHAKEN = "\n[effects.ground]\ndirection = [2, 1]\nacceleration = 3.0\nfrequency = 4.0\n"
WINDOW = "\n[shape.holes]\nwindow = { circle = { center = [0.5, 1.4], radius = 0.18 } }\n"
QUANTITIES = """
[quantities]
sway = { displacement = "x", at = "c" }
amplitude = { displacement = "x", at = "c", reduce = "peak" }
energy = { energy = "total" }
edit = { energy = "edit" }
remesh = { energy = "remesh" }
"""


def dynamics(dt: float = 0.01, steps: int = 10, **more: object) -> str:
    """The [effects.dynamics] and [solve] with a tight tolerance."""
    rest = "".join(f"{key} = {value!r}\n" for key, value in more.items())
    return f"\n[effects.dynamics]\ntime_step = {dt!r}\nsteps = {steps}\n{rest}\n[solve]\ntolerance = 1e-12\n"


def tower(folder: Path, *parts: str, size: float = 0.2, window: bool = False) -> Path:
    """The scene file of a 1 m x 2 m rubber tower on its foot, with a round window near its top if wanted."""
    shape = block(1.0, 2.0) + (WINDOW if window else "")
    return write_scene(folder, HEAD + shape + RUBBER + HELD + meshed(size) + "".join(parts) + QUANTITIES)


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
