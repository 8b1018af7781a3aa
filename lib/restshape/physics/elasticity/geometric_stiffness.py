"""What the stress of a small displacement does to the stiffness of a plane solid."""

import numpy as np

from restshape import _kernels
from restshape.physics.elasticity.plane_solid import PlaneSolid


class GeometricStiffness:
    """G of a displacement u: phi . G phi = int sigma(u) : grad(phi)^T grad(phi), linear in u.

    Args:
        physics: the solid, whose mesh is kept by reference.

    Source: docs/theory.md, section 8.
    """

    def __init__(self, physics: PlaneSolid) -> None:
        self.physics = physics
        self.element = _kernels.Element(physics.small.name.replace("linear_elastic", "geometric"))

    def params(self, u: np.ndarray) -> np.ndarray:
        """Parameters (ne, 3 + 2 nodes) of the element: moduli, thickness, u (n, 2) [m] at the nodes of each cell."""
        cells, moduli = self.physics.mesh.cells, self.physics.stiffness_params
        nodes = cells.shape[1]
        out = np.empty((len(cells), 3 + 2 * nodes))
        out[:, :3] = moduli[..., :3]
        out[:, 3:] = u[cells].reshape(len(cells), 2 * nodes)
        return out

    def product(self, params: np.ndarray, phi: np.ndarray) -> np.ndarray:
        """G phi (n, 2) [N] for phi (n, 2) [m], with the parameters of u."""
        mesh, out = self.physics.mesh, np.zeros_like(phi)
        self.element.residual(mesh.X, phi, mesh.cells, params, out)
        return out

    def design_product(self, params: np.ndarray, phi: np.ndarray, dX: np.ndarray) -> np.ndarray:
        """The rate (n, 2) of G phi when nodes move with dX (n, 2), and u and phi with them."""
        mesh, out = self.physics.mesh, np.zeros_like(phi)
        self.element.design(mesh.X, dX, phi, mesh.cells, params, out)
        return out
