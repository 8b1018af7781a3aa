"""Plane solids that vibrate freely in their plane."""

import numpy as np

from restshape.fem.elements import ANISOTROPIC, LUMPED_MASS, MASS
from restshape.fem.region_materials import by_cell
from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.mesh.mesh import Mesh
from restshape.physics.elasticity.mode_estimate import PlaneModeEstimate
from restshape.physics.elasticity.stiffness import lame, plane_params, plane_strain, plane_stress, stiffness_of
from restshape.physics.elasticity.vibrating_body import VibratingBody
from restshape.physics.elasticity.vibrating_materials import constant_thickness, law
from restshape.scene.model import Scene


class VibratingPlane(VibratingBody):
    """A solid in the plane, in plane stress or plane strain.

    Args:
        scene, plane: as in `VibratingBody`.
        stress: plane stress, else plane strain.
        lumped: with the mass on the diagonal.
    """

    axes = ("x", "y")

    def __init__(self, scene: Scene, plane: Mesh | LagrangeSpace, stress: bool = True, lumped: bool = False) -> None:
        super().__init__(scene, plane)
        self.space, self.stress = plane, stress
        thickness = [constant_thickness(m) for m in self.materials]
        if law(self.materials) is ANISOTROPIC:
            plane_law = plane_stress if stress else plane_strain
            rows = [plane_params(plane_law(stiffness_of(m)), h) for m, h in zip(self.materials, thickness)]
        else:
            rows = [(*lame(m, stress), h, 0.0, 0.0) for m, h in zip(self.materials, thickness)]
        masses = [[m.rho * h] for m, h in zip(self.materials, thickness)]
        region = plane.cell_region
        self.stiffness = self.integral(law(self.materials), by_cell(np.array(rows), region))
        self.mass = self.integral(LUMPED_MASS if lumped else MASS, by_cell(np.array(masses), region))
        self.boundary = self.supports()

    def all_rigid_motions(self) -> np.ndarray:
        """Two translations and a turn (3, n f)."""
        X = self.space.X
        basis = np.zeros((3, *X.shape))
        basis[0, :, 0] = basis[1, :, 1] = 1.0
        centre = X - X.mean(axis=0)
        basis[2, :, 0], basis[2, :, 1] = -centre[:, 1], centre[:, 0]
        return basis.reshape(3, -1)

    def shapes(self, modes: np.ndarray) -> np.ndarray:
        """Displacements (k, n2, 3) of the plane nodes in modes (k, n f)."""
        shapes = np.zeros((len(modes), len(self.space.X), 3))
        shapes[:, :, :2] = modes.reshape(len(modes), -1, 2)
        return shapes

    def error_estimate(self) -> PlaneModeEstimate:
        """What estimates the errors of its modes."""
        return PlaneModeEstimate(self, self.stress)
