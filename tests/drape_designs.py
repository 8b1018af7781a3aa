"""Drapes whose pattern, bodies and numbers are changed a little: what the derivatives of drapes are compared with."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from small_scenes import block, head, make_replay, meshed, write_scene

from restshape.analysis.frame import Frame
from restshape.scene.load import revise
from restshape.scene.model import Scene

COTTON = """
[material.cotton]
E = "0.2 MPa"
nu = 0.3
rho = "500 kg/m^3"
thickness = "0.3 mm"
bending = "{bending} N m"
[effects.gravity]
[effects.drape]
tolerance = 1e-9
[effects.cloth]
bending = "{kind}"
"""
HELD = '[supports.pins]\non = ["a", "b"]\nfix = ["x", "y", "z"]\n'
HOLD = "[hold]\nat = [0.2, 0.2]\nto = [0.18, 0.17, 0.02]\n"
CLAMPED = '[supports.clamp]\non = "left"\nfix = { x = "0*x", y = "0.02*y*y", z = "0.1*y*x", slope = "0" }\n'
BALL = "[bodies.ball]\nsphere = {{ center = [0.1, 0.11, -0.062], radius = 0.06 }}\nfriction = {friction}\n"
CONTACT = '[effects.contact]\nthickness = "2 mm"\nself = false\n'
FOLDED = """
[supports.left]
on = "left"
fix = ["x", "y", "z"]
[supports.right]
on = "right"
fix = { x = -0.1, y = 0, z = 0.0008 }
[bodies.floor]
plane = { point = [0, 0, -0.0015], normal = [0, 0, 1] }
friction = 0.3
[effects.contact]
thickness = "2 mm"
self_friction = 0.3
self_thickness = "1 mm"
"""


def folded(kind: str) -> str:
    """The text of a scene with a strip of 0.2 m x 0.05 m on a floor, its right side back over its middle."""
    text = head("cloth") + block(0.2, 0.05) + COTTON.format(kind=kind, bending=1e-6)
    return text.replace('"0.2 MPa"', '"0.5 MPa"') + FOLDED + meshed(0.0125)


def sheet(kind: str, *tables: str, bending: float = 5e-6, size: float = 0.025) -> str:
    """The text of a scene with a sheet of 0.2 m x 0.2 m."""
    text = head("cloth") + block(0.2, 0.2) + COTTON.format(kind=kind, bending=bending)
    return text + "\n".join(tables) + meshed(size)


class DrapeDesign:
    """A drape at rest; `move` and `change` lead to others, from the same anchors each.

    Args:
        folder: for the scene's file.
        text: of the scene; overrides: of it.
    """

    def __init__(self, folder: Path, text: str, overrides: Sequence[str] = ()) -> None:
        self.replay = make_replay(write_scene(folder, text), overrides=overrides)
        next(self.replay.frames())
        self.analysis = self.replay.analysis
        assert self.analysis.state.report.converged, self.analysis.state.report.why
        self.scene: Scene = self.replay.session.scene
        self.X, self.x = self.analysis.space.X.copy(), self.analysis.x.copy()
        self._kept = self.analysis.kept_answer()

    @property
    def problem(self):
        """Of the drape."""
        return self.analysis.problem

    def direction(self, seed: int = 3) -> np.ndarray:
        """A smooth motion (n, 2) [m] of the material that leaves no side straight."""
        a, b, c, d = np.random.default_rng(seed).uniform(-1.0, 1.0, (4, 2))
        x, y = (self.X / np.ptp(self.X)).T[:, :, None]
        return np.ptp(self.X) * (a * np.sin(2 * x + y) + b * x * y + c * np.cos(3 * y) + d * x**2)

    def move(self, dX: np.ndarray, scene: Scene | None = None) -> np.ndarray:
        """The unknowns (n, 3) at rest with the nodes dX (corners, 2) [m] from where they were, and another scene."""
        mesh = self.analysis.space
        mesh.X[...] = self.X + dX
        mesh.geometry += 1
        self.analysis.solve(self._frame(scene or self.scene))
        assert self.analysis.state.report.converged, self.analysis.state.report.why
        found = self.analysis.x.copy()
        mesh.X[...] = self.X
        mesh.geometry += 1
        self.analysis.restore(self._kept, self._frame(self.scene))
        return found

    def change(self, key: str, value: object) -> np.ndarray:
        """The unknowns (n, 3) at rest with another value of the scene."""
        return self.move(np.zeros_like(self.X), revise(self.scene, key, value))

    def scene_with(self, key: str, value: object) -> Scene:
        """The scene with another value."""
        return revise(self.scene, key, value)

    def take(self, scene: Scene) -> None:
        """Go on from the rest of another scene, and what friction remembers of the way there."""
        self.analysis.solve(self._frame(scene))
        assert self.analysis.state.report.converged, self.analysis.state.report.why
        self.scene, self.x, self._kept = scene, self.analysis.x.copy(), self.analysis.kept_answer()

    def hand(self, dX: np.ndarray, tolerance: float = 1e-10) -> np.ndarray:
        """The derivative (n, 3) along one motion dX (corners, 2) of the material."""
        return self.analysis.derivative(np.stack([dX]), tolerance).s[0]

    def remainders(self, dX: np.ndarray, step: float) -> list[float]:
        """Norms of what a step along a motion, and half of it, lead to beside the derivative."""
        s, steps = self.hand(dX), (step, 0.5 * step)
        return [float(np.linalg.norm(self.move(h * dX) - self.x - h * s)) for h in steps]

    def _frame(self, scene: Scene) -> Frame:
        return Frame(self.analysis.space, np.empty(0, dtype=np.int32), None, scene, (None, (0.0, 0.0)))
