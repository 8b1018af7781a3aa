"""Solids between a bottom and a top over a plane mesh that vibrate freely in space."""

import numpy as np

from restshape.fem.eigenproblem import Eigenproblem
from restshape.fem.elements import ANISOTROPIC, LUMPED_MASS, MASS
from restshape.fem.region_materials import by_cell
from restshape.mesh.extrude import Extrusion
from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.mesh.mesh import Mesh
from restshape.physics.elasticity.mode_estimate import SolidModeEstimate
from restshape.physics.elasticity.stiffness import lame, solid_params, stiffness_of
from restshape.physics.elasticity.vibrating_body import VibratingBody
from restshape.physics.elasticity.vibrating_materials import common_thickness, law
from restshape.scene.model import Scene


class VibratingSolid(VibratingBody):
    """A body between a bottom and a top over the plane mesh, of tetrahedra of the plane mesh's order.

    Args:
        scene, plane: as in `VibratingBody`.
        layers: of tetrahedra.
        lumped: with the mass on the diagonal.
    """

    axes = ("x", "y", "z")
    space: Extrusion

    def __init__(self, scene: Scene, plane: Mesh | LagrangeSpace, layers: int, lumped: bool = False) -> None:
        super().__init__(scene, plane)
        self.space = Extrusion(plane, layers, common_thickness(scene), scene.parameters)
        region = self.space.cell_region
        if law(self.materials) is ANISOTROPIC:
            rows = [solid_params(stiffness_of(m)) for m in self.materials]
        else:
            rows = [(*lame(m, False), 0.0, 0.0, 0.0) for m in self.materials]
        masses = np.array([[m.rho] for m in self.materials])
        self.stiffness = self.integral(law(self.materials), by_cell(np.array(rows), region))
        self.mass = self.integral(LUMPED_MASS if lumped else MASS, by_cell(masses, region))
        self.boundary = self.supports()

    def motion(self, plane_motion: np.ndarray) -> np.ndarray:
        """Velocities (k, n, 3) of the nodes from those (k, n2, 2) of the plane nodes."""
        return self.space.motion(plane_motion)

    def thickness_motion(self, rates: np.ndarray) -> np.ndarray:
        """Velocities (n, 3) of the nodes where the thickness over the plane nodes grows with rates (n2,)."""
        return self.space.thickness_motion(rates)

    def take_off(self, depth: np.ndarray) -> None:
        """Take depths (n2,) [m] off underneath.

        Raises:
            ReplayProblem: nothing is left somewhere; all is as before.
        """
        self.space.take_off(depth)

    def by_plane_nodes(self, field: np.ndarray) -> np.ndarray:
        """A field (n, ...) by plane nodes: (n2, levels...)."""
        return field.reshape(len(self.plane.X), -1)

    def taken_over(self, modes: np.ndarray, before: Eigenproblem) -> np.ndarray:
        """Modes (k, n f) of a body before on the same nodes, which may have had another thickness.

        Where each column's displacements are quadratic in z, they are the same polynomial as before: normals turn as
        they did, and lateral contraction is the same. The same numbers at the new nodes would shear the body.
        """
        heights, old = (np.ptp(body.by_plane_nodes(body.space.X[:, 2]), axis=1) for body in (self, before))
        if np.array_equal(heights, old):
            return modes
        levels, ratio = self.space.levels, (heights / old)[:, None, None]
        columns = modes.reshape(len(modes), len(heights), levels, 3)
        turned = columns[:, :, ::-1]
        odd, even = 0.5 * (columns - turned), 0.5 * (columns + turned)
        middle = even[:, :, levels // 2, None]
        return (middle + ratio * odd + ratio**2 * (even - middle)).reshape(modes.shape)

    def all_rigid_motions(self) -> np.ndarray:
        """Three translations and three turns (6, n f)."""
        X = self.space.X
        basis = np.zeros((6, *X.shape))
        centre = X - X.mean(axis=0)
        for a in range(3):
            b, c = (a + 1) % 3, (a + 2) % 3
            basis[a, :, a] = 1.0
            basis[3 + a, :, b], basis[3 + a, :, c] = -centre[:, c], centre[:, b]
        return basis.reshape(6, -1)

    def shapes(self, modes: np.ndarray) -> np.ndarray:
        """Displacements (k, n2, 3) of the columns, averaged over bottom, top and what is between, in modes (k, n f)."""
        return modes.reshape(len(modes), len(self.plane.X), self.space.levels, 3).mean(axis=2)

    def error_estimate(self) -> SolidModeEstimate:
        """What estimates the errors of its modes."""
        return SolidModeEstimate(self)
