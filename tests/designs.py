"""Solved scenes whose nodes are moved by hand: what the derivatives of these answers are compared with."""

from pathlib import Path

import numpy as np
from small_scenes import HEAD, HOLE, block, make_replay, write_scene

from restshape.analysis.frame import Frame

RUBBER = """
[material.rubber]
E = 1e6
nu = {nu}
rho = 1000
thickness = 0.05

[effects.solid]
model = "plane_strain"
"""
CLAMPED = '[supports.wall]\non = "left"\nfix = ["x", "y"]\n'
LOADS = {
    "gravity": "[effects.gravity]\ng = [3, -9.81]\n",
    "traction": '[loads.a]\non = "right"\ntraction = [0, "-20e3"]\n',
    "varying traction": '[loads.a]\non = "right"\ntraction = ["4e4*y^2", "-2e4*sin(3*x*y)"]\n',
    "pressure": '[loads.a]\non = "top"\npressure = 8e3\n',
    "varying pressure": '[loads.a]\non = ["top", "window"]\npressure = "5e3*(1 + x^2*y)"\n',
    "force": '[loads.a]\non = ["right", "top"]\nforce = [0, -700]\n',
    "varying force": '[loads.a]\non = "right"\nforce = ["300*x*y", "-800*sqrt(y)"]\n',
    "force at a point": '[loads.a]\non = "c"\nforce = ["100*x*y", "-300*exp(-y)"]\n',
    "body force": '[loads.a]\non = "all"\nbody = [0, "-9e3*x*(1 + y)"]\n',
    "moving support": '[supports.end]\non = "right"\nfix = { y = "-0.04*x*(1 + 0.5*cos(2*y))" }\n',
}


class Design:
    """A block with a hole, solved as its nodes lie; `move` lays them somewhere else.

    Args:
        folder: for the scene's file.
        loads: tables of the scene.
        nonlinear: large deformation.
        order: of the elements.
        tables: other tables.
        nu: Poisson's ratio.
    """

    def __init__(
        self, folder: Path, loads: str, nonlinear: bool = False, order: int = 1, tables: str = "", nu: float = 0.3
    ) -> None:
        law = "[effects.large_deformation]\n" if nonlinear else ""
        text = HEAD + block(1.5, 1.0) + HOLE + RUBBER.format(nu=nu) + law + CLAMPED + loads + tables
        text += f"[mesh]\nsize = 0.2\norder = {order}\n[solve]\ntolerance = 1e-12\n"
        self.replay = make_replay(write_scene(folder, text))
        next(self.replay.frames())
        self.analysis = self.replay.analysis
        self.X = self.analysis.space.X.copy()
        self.x = self.analysis.x.copy()

    def direction(self, seed: int = 3) -> np.ndarray:
        """A smooth motion (n, 2) [m] of all nodes that leaves no side straight."""
        a, b, c, d = np.random.default_rng(seed).uniform(-1.0, 1.0, (4, 2))
        x, y = self.X.T[:, :, None]
        return a * np.sin(2 * x + y) + b * x * y + c * np.cos(3 * y) + d * x**2

    def move(self, dX: np.ndarray) -> np.ndarray:
        """The displacement (n, 2) [m] of the design whose nodes are dX (n, 2) [m] from where they were."""
        mesh = self.analysis.space
        mesh.X[...] = self.X + dX
        self.replay.moving.mesh.geometry += 1
        none = np.empty(0, dtype=np.int32)
        self.analysis.solve(Frame(mesh, none, None, self.replay.session.scene, (None, (0.0, 0.0))))
        return self.analysis.x.copy()
