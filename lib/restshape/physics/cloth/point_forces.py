"""Contact and inertia at the nodes of cloth, as an integral over points."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from restshape.algebra.operator import MatrixTerm
from restshape.fem import elements
from restshape.fem.integral import Integral
from restshape.physics.cloth.contact import POTENTIAL, Contact

ELEMENT = elements.POTENTIAL["point1"]
"""A quadratic function of a node's position."""


@dataclass(frozen=True, eq=False)
class PointForces:
    """Like `fem.integral.Integral`, with parameters that are taken at each x.

    Args:
        X: (n, 2) material coordinates [m].
        entities: (corners, 1) int32 the node of each corner.
        contact: of the corners; None: nothing touches.
        mass: (corners,) [kg] of them; inertia: [1/s^2] that it is multiplied with on the diagonal.
        area_rates: gives the rates (corners,) of the areas of contact when nodes move with rates (n, 2).
        curved: with the force times the curvature of the surface; without it the tangent is semidefinite.
        block: of the operator.
    """

    X: np.ndarray
    entities: np.ndarray
    contact: Contact | None
    mass: np.ndarray
    area_rates: Callable[[np.ndarray], np.ndarray]
    inertia: float = 0.0
    curved: bool = True
    block: int = 1

    def add_residual(self, x: np.ndarray, out: np.ndarray, subset: np.ndarray | None = None) -> None:
        """Add the forces [N] of contact at x (n, 3) to `out` (n, 3)."""
        if self.contact:
            nodes = self.entities[:, 0]
            out[nodes] += self.contact.forces(x[nodes])

    def energies(self, x: np.ndarray) -> np.ndarray:
        """The energy (1,) [J] of contact at x (n, 3)."""
        return np.array([self.contact.energy(x[self.entities[:, 0]]) if self.contact else 0.0])

    def term(self, x: np.ndarray, coefficient: float = 1.0, residual_factor: float | None = None) -> MatrixTerm:
        """The points at x (n, 3) as a term of `algebra.operator.Operator.assemble`."""
        return self._at(x).term(x, coefficient, residual_factor)

    def add_tangent_product(self, x: np.ndarray, d: np.ndarray, out: np.ndarray) -> None:
        """Add (dr/dx) d, at x (n, 3) along d (n, 3), to `out` (n, 3)."""
        self._at(x).add_tangent_product(x, d, out)

    def add_design_product(self, x: np.ndarray, dX: np.ndarray, out: np.ndarray, dx: np.ndarray | None = None) -> None:
        """Add (dr/dX) dX + (dr/dx) dx to `out` (n, 3); arguments as of `Integral.add_design_product`."""
        if dx is not None:
            self.add_tangent_product(x, dx, out)
        if self.contact:
            nodes = self.entities[:, 0]
            out[nodes] += self.contact.force_rates(x[nodes], self.area_rates(dX))

    def _at(self, x: np.ndarray) -> Integral:
        """The quadratic functions that agree with contact and inertia at x (n, 3) in value, slope and curvature."""
        corners = x[self.entities[:, 0]]
        if self.contact:
            table = self.contact.potential(corners, self.curved)[1].copy()
        else:
            table = np.zeros((len(corners), POTENTIAL))
            table[:, :3] = corners
        if self.inertia:
            table[:, 6:9] += (self.inertia * self.mass)[:, None]
        return Integral(ELEMENT, self.X, self.entities, table, block=self.block)
