"""The membrane of cloth: its stiffness in its own plane, and its weight."""

import numpy as np

from restshape.fem.elements import MEMBRANE, MEMBRANE_COROTATED, MEMBRANE_STABILISED
from restshape.fem.integral import Integral
from restshape.physics.cloth.fabric import Fabric
from restshape.physics.cloth.parameters import UPPER

ELEMENTS = {"stvk": (MEMBRANE, MEMBRANE_STABILISED), "corotated": (MEMBRANE_COROTATED,) * 2}
"""Elements with the true and the stabilised tangent, by law."""
LOAD = slice(6, 9)
"""Parameters that are the weight by area."""


class Membrane:
    """Stretching and weight of triangles.

    Args:
        law: of the fabric.
        corners: (ne, 3) int32 nodes of the triangles, by reference.
    """

    block = 0

    def __init__(self, law: str, corners: np.ndarray) -> None:
        self.element, self.stabilised = (family["tri3"] for family in ELEMENTS[law])
        self.corners = corners
        self.parameters = np.empty(0)

    def update(self, fabric: Fabric, density: np.ndarray, g: np.ndarray, softness: float) -> None:
        """Take in stiffness, density (ne,) [kg/m^2], acceleration g (3,) [m/s^2], and the part of the stiffness."""
        load = density[:, None] * g
        moduli = np.broadcast_to(fabric.membrane, (len(load), 3, 3))[:, UPPER[0], UPPER[1]]
        params = np.ascontiguousarray(np.hstack([softness * moduli, load]))
        self.parameters = params[0] if (params == params[0]).all() else params

    def integral(self, X: np.ndarray, stabilised: bool = False, weighs: bool = True) -> Integral:
        """Over triangles at X (n, 2), with or without the compressed part of the tangent, and the weight."""
        parameters = self.parameters
        if not weighs:
            parameters = parameters.copy()
            parameters[..., LOAD] = 0.0
        element = self.stabilised if stabilised else self.element
        return Integral(element, X, self.corners, parameters, block=self.block)

    def rate_integral(self, X: np.ndarray, moduli: np.ndarray, loads: np.ndarray) -> Integral:
        """What forces at X (n, 2) do as moduli (ne, 3, 3) [N/m] and weights by area (ne, 3) [Pa] have these rates.

        They are linear in both: the residual of the integral is the rate.
        """
        params = np.ascontiguousarray(np.hstack([moduli[:, UPPER[0], UPPER[1]], loads]))
        return Integral(self.element, X, self.corners, params, block=self.block)

    def tensions(self, X: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Second Piola-Kirchhoff tensions (ne, 3) xx, yy, xy [N/m] at positions x (n, 3)."""
        out = np.empty((len(self.corners), 3))
        self.element.stress(X, x, self.corners, self.parameters, out)
        return out
