"""A linear solid that may move: its stiffness, inertia, damping, static loads and the ground under it."""

import numpy as np

from restshape.mesh.mesh import Mesh
from restshape.physics.dynamics import Inertia, Rayleigh
from restshape.physics.solid import PlaneSolid
from restshape.scene.model import Scene
from restshape.scene.plan import Plan


class VibratingSolid:
    """M y'' + C y' + K y = `static` - M 1 a_ground for y, the displacement less what supports prescribe.

    Args:
        scene: materials, loads and supports.
        plan: which effects are on.
        mesh: kept by reference; its nodes may move and its edges may flip.

    Raises:
        UserError: the supports leave the body free to move, or a material has no density.
    """

    def __init__(self, scene: Scene, plan: Plan, mesh: Mesh) -> None:
        self.mesh = mesh
        self.solid = PlaneSolid(scene, plan, mesh)
        self.inertia = Inertia(self.solid, plan.settings("dynamics").mass)
        self.rayleigh = Rayleigh.of(plan.settings("damping"))
        self.held = self.solid.mask.astype(bool)
        self.loaded = bool(scene.loads) or bool(np.any(self.solid.prescribed)) or self.solid.moving
        self.static = np.zeros_like(mesh.X)
        self.move()

    def move(self) -> None:
        """Evaluate anew what depends on the place of the nodes."""
        if self.loaded:
            self.solid.move()
            self.solid.loads(self.static)
            self.static -= self.solid.residual(self.solid.prescribed)
            self.static[self.held] = 0.0

    def stiffness(self, y: np.ndarray) -> np.ndarray:
        """K y (n, 2) of nodal values y (n, 2)."""
        solid, mesh = self.solid, self.mesh
        out = np.zeros_like(y)
        solid.element.residual(mesh.X, y, mesh.cells, solid.stiffness_params, out)
        return out

    def acceleration(self, y: np.ndarray, v: np.ndarray, ground: np.ndarray) -> np.ndarray:
        """The acceleration (n, 2) [m/s^2] relative to the ground that equilibrium asks for.

        Args:
            y, v: (n, 2) displacement less the prescribed one [m], velocity [m/s].
            ground: (2,) its acceleration [m/s^2].
        """
        damping = self.rayleigh
        force = self.static - self.stiffness(y + damping.beta * v) - self.inertia.apply(damping.alpha * v + ground)
        return self.inertia.solve(force)

    def energy(self, y: np.ndarray, v: np.ndarray) -> float:
        """Strain energy and kinetic energy relative to the ground [J]; arguments as in `acceleration`."""
        strain = self.solid.energies(y + self.solid.prescribed).sum()
        return float(strain + self.inertia.energies(v).sum())
