"""A linear solid that may move: its stiffness, inertia, damping, static loads and the ground under it."""

import numpy as np

from restshape.mesh.mesh import Mesh
from restshape.physics.elasticity.dynamics import Inertia, Rayleigh
from restshape.physics.elasticity.plane_solid import PlaneSolid
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
        heavy = self.solid.gravity is not None
        self.loaded = heavy or bool(scene.loads) or bool(np.any(self.solid.prescribed)) or self.solid.moving
        # Loads inside cells are in the residual of a body at rest; those of edges and points are not.
        inside = heavy or bool(self.solid.bodies)
        self.weighed = inside or bool(np.any(self.solid.prescribed)) or self.solid.moving or self.solid.law == "stvk"
        self.static = np.zeros_like(mesh.X)
        self.move()

    def move(self) -> None:
        """Evaluate anew what depends on the place of the nodes."""
        if self.loaded:
            self.solid.move()
            self.solid.loads(self.static)
            if self.weighed:
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
        force = self.force(y) - self.damping(v)
        if ground.any():
            force -= self.inertia.apply(np.zeros_like(y) + ground)
        return self.inertia.solve(force)

    def force(self, y: np.ndarray) -> np.ndarray:
        """Applied less internal forces (n, 2) [N] at y (n, 2) [m]; without meaning where the body is held."""
        if self.solid.law == "linear_elastic":
            return self.static - self.stiffness(y)
        return -self.solid.imbalance(y + self.solid.prescribed)

    def damping(self, v: np.ndarray) -> np.ndarray:
        """C v (n, 2) [N] at the velocities v (n, 2) [m/s], with the stiffness of the body at rest."""
        alpha, beta = self.rayleigh.alpha, self.rayleigh.beta
        out = self.inertia.apply(alpha * v) if alpha else np.zeros_like(v)
        if beta:
            solid = self.solid
            solid.small.residual(self.mesh.X, beta * v, self.mesh.cells, solid.stiffness_params, out)
        return out

    def energy(self, y: np.ndarray, v: np.ndarray) -> float:
        """Strain energy and kinetic energy relative to the ground [J]; arguments as in `acceleration`."""
        strain = self.solid.energies(y + self.solid.prescribed).sum()
        return float(strain + self.inertia.energies(v).sum())
