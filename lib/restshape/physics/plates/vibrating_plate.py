"""Plates with shear that vibrate freely out of their plane."""

import numpy as np

from restshape.fem.elements import MASS_PLATE, PLATE
from restshape.mesh.mesh import Mesh
from restshape.mesh.plate import PlateMesh
from restshape.physics.elasticity.stiffness import FREE_SIDES, plate_params, stiffness_of
from restshape.physics.elasticity.vibrating_body import VibratingBody
from restshape.physics.elasticity.vibrating_materials import common_thickness
from restshape.physics.plates.plate_mode_estimate import PlateModeEstimate
from restshape.scene.model import Scene


class VibratingPlate(VibratingBody):
    """A plate with shear over the plane mesh of first order: deflection and two rotations of the normal a node.

    Its motion in the plane is left out; it has frequencies of its own, which bending does not know.

    Args:
        scene, plane: as in `VibratingBody`.
    """

    axes = ("z", "rx", "ry")
    space: PlateMesh

    def __init__(self, scene: Scene, plane: Mesh) -> None:
        super().__init__(scene, plane)
        self.space = PlateMesh(plane, common_thickness(scene), scene.parameters)
        table = np.stack([plate_params(stiffness_of(m), m.rho) for m in self.materials])
        parameters = np.ascontiguousarray(table[plane.cell_region])
        self.stiffness, self.mass = self.integral(PLATE, parameters), self.integral(MASS_PLATE, parameters)
        self.boundary = self.supports()
        self._topology: int | None = None
        self.update()

    def update(self) -> None:
        """Give the elements which sides may twist: those of the boundary along which no support holds the rotation."""
        mask, topology = self.boundary.mask, self.space.topology
        if topology == self._topology and not mask[:, 1:].any():
            return
        self._topology = topology
        cells = self.space.cells
        along = self.space.X[np.roll(cells, -1, axis=1), :2] - self.space.X[cells, :2]
        straight = np.abs(along) <= 1e-9 * np.linalg.norm(along, axis=2, keepdims=True)
        # The rotation along a side is made of ry where it runs in x, and of rx where it runs in y.
        kept = mask[:, [2, 1]] != 0
        fixed = [(kept[nodes] | straight).all(axis=2) for nodes in (cells, np.roll(cells, -1, axis=1))]
        self.stiffness.parameters[:, FREE_SIDES[0]] = self.space.rim() & ~(fixed[0] & fixed[1])

    def motion(self, plane_motion: np.ndarray) -> np.ndarray:
        """Velocities (k, n, 3) of places and thickness from those (k, n, 2) of the plane nodes."""
        return self.space.motion(plane_motion)

    def thickness_motion(self, rates: np.ndarray) -> np.ndarray:
        """Velocities (n, 3) of places and thickness where the thickness over the plane nodes grows with rates (n2,)."""
        return self.space.thickness_motion(rates)

    def take_off(self, depth: np.ndarray) -> None:
        """Take depths (n2,) [m] off underneath.

        Raises:
            ReplayProblem: nothing is left somewhere; all is as before.
        """
        self.space.take_off(depth)

    def all_rigid_motions(self) -> np.ndarray:
        """A translation along z and two turns (3, n f)."""
        x, y = (self.space.X[:, :2] - self.space.X[:, :2].mean(axis=0)).T
        basis = np.zeros((3, len(x), 3))
        basis[0, :, 0] = 1.0
        basis[1, :, 0], basis[1, :, 1] = y, 1.0
        basis[2, :, 0], basis[2, :, 2] = -x, 1.0
        return basis.reshape(3, -1)

    def shapes(self, modes: np.ndarray) -> np.ndarray:
        """Displacements (k, n, 3) of the plane nodes in modes (k, n f): deflections alone."""
        shapes = np.zeros((len(modes), len(self.space.X), 3))
        shapes[:, :, 2] = modes.reshape(len(modes), -1, 3)[:, :, 0]
        return shapes

    def normal_participation(self, modes: np.ndarray, mass_products: np.ndarray) -> np.ndarray:
        """Ones (k,): what a plate does is out of its plane."""
        return np.ones(len(modes))

    def error_estimate(self) -> PlateModeEstimate:
        """What estimates the errors of its modes."""
        return PlateModeEstimate(self)
