"""The membrane of cloth: its stiffness in its own plane, and its weight."""

import numpy as np

from restshape.fem.elements import (
    MEMBRANE,
    MEMBRANE_COROTATED,
    MEMBRANE_COROTATED_STABILISED,
    MEMBRANE_STABILISED,
    MEMBRANE_TENSION,
)
from restshape.fem.integral import Integral
from restshape.physics.cloth.sheet.fabric import Fabric
from restshape.physics.cloth.sheet.parameters import UPPER

ELEMENTS = {
    "stvk": (MEMBRANE, MEMBRANE_STABILISED),
    "corotated": (MEMBRANE_COROTATED, MEMBRANE_COROTATED_STABILISED),
}
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

    def tension_integral(self, X: np.ndarray, tensions: np.ndarray) -> Integral:
        """Over triangles at X (n, 2), of tensions (ne, 3) xx, yy, xy [N/m] that strains do not change."""
        return Integral(MEMBRANE_TENSION["tri3"], X, self.corners, np.ascontiguousarray(tensions), block=self.block)

    def tensions(self, X: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Second Piola-Kirchhoff tensions (ne, 3) xx, yy, xy [N/m] at positions x (n, 3)."""
        out = np.empty((len(self.corners), 3))
        self.element.stress(X, x, self.corners, self.parameters, out)
        return out


def stretching(tensions: np.ndarray) -> np.ndarray:
    """Tensions (ne, 3) xx, yy, xy without their negative principal values, as in the stabilised tangent."""
    xx, yy, xy = tensions.T
    mean, half = 0.5 * (xx + yy), 0.5 * (xx - yy)
    radius = np.hypot(half, xy)
    top, twice = np.maximum(mean + radius, 0.0), np.where(radius > 0.0, 2.0 * radius, 1.0)
    share = top / twice
    parts = np.column_stack([share * (radius + half), share * (radius - half), share * xy])
    return np.where((mean >= radius)[:, None], tensions, parts)
