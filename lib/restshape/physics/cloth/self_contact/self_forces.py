"""Contact of cloth with itself as two integrals: over its nodes, and over pairs of nodes that it couples."""

from dataclasses import dataclass

import numpy as np

from restshape.algebra.operator import MatrixTerm
from restshape.fem import elements
from restshape.fem.integral import Integral
from restshape.physics.cloth.contact.contact import POTENTIAL
from restshape.physics.cloth.self_contact.self_contact import SelfContact

NODES, PAIRS = elements.POTENTIAL["point1"], elements.COUPLING["point2"]
"""A quadratic function of a node's position, and one of two that has mixed derivatives alone."""


@dataclass(frozen=True, eq=False)
class SelfForces:
    """Like `fem.integral.Integral`: forces, energy and the second derivatives of single nodes.

    Args:
        X: (n, 2) material coordinates [m].
        entities: (corners, 1) int32 the node of each corner.
        contact: of the corners.
        curved: with all second derivatives; without it those of each pair of parts are positive semidefinite.
        block: of the operator.
    """

    X: np.ndarray
    entities: np.ndarray
    contact: SelfContact
    curved: bool = True
    block: int = 1

    def _corners(self, values: np.ndarray) -> np.ndarray:
        return values[self.entities[:, 0]]

    def add_residual(self, x: np.ndarray, out: np.ndarray, subset: np.ndarray | None = None) -> None:
        """Add the forces [N] at x (n, 3) to `out` (n, 3)."""
        out[self.entities[:, 0]] += self.contact.forces(self._corners(x))

    def energies(self, x: np.ndarray) -> np.ndarray:
        """The energy (1,) [J] at x (n, 3)."""
        return np.array([self.contact.energy(self._corners(x))])

    def term(self, x: np.ndarray, coefficient: float = 1.0, residual_factor: float | None = None) -> MatrixTerm:
        """The nodes at x (n, 3) as a term of `algebra.operator.Operator.assemble`."""
        return self._at(x).term(x, coefficient, residual_factor)

    def add_tangent_product(self, x: np.ndarray, d: np.ndarray, out: np.ndarray) -> None:
        """Add the part of (dr/dx) d of single nodes, at x (n, 3) along d (n, 3), to `out` (n, 3)."""
        self._at(x).add_tangent_product(x, d, out)

    def add_design_product(self, x: np.ndarray, dX: np.ndarray, out: np.ndarray, dx: np.ndarray | None = None) -> None:
        """Add (dr/dX) dX + the nodes' part of (dr/dx) dx to `out` (n, 3); arguments as of `Integral`'s."""
        if dx is not None:
            self.add_tangent_product(x, dx, out)
        out[self.entities[:, 0]] += self.contact.force_rates(self._corners(x), self._corners(dX))

    def _at(self, x: np.ndarray) -> Integral:
        corners = self._corners(x)
        single, _ = self.contact.second_derivatives(corners, self.curved)
        table = np.empty((len(corners), POTENTIAL))
        table[:, :3], table[:, 3:6], table[:, 6:] = corners, self.contact.forces(corners), single
        return Integral(NODES, self.X, self.entities, table, block=self.block)


@dataclass(frozen=True, eq=False)
class SelfCoupling:
    """Like `fem.integral.Integral`: the mixed second derivatives of pairs of nodes, without forces and energy.

    Args:
        forces: whose contact it is; block: of the operator.
    """

    forces: SelfForces
    block: int

    @property
    def entities(self) -> np.ndarray:
        """The nodes (m, 2) int32 of each pair."""
        return coupled_nodes(self.forces.contact, self.forces.entities[:, 0])

    def add_residual(self, x: np.ndarray, out: np.ndarray, subset: np.ndarray | None = None) -> None:
        """Add nothing: forces are those of the nodes."""

    def energies(self, x: np.ndarray) -> np.ndarray:
        """No energies (0,)."""
        return np.zeros(0)

    def term(self, x: np.ndarray, coefficient: float = 1.0, residual_factor: float | None = None) -> MatrixTerm:
        """The pairs at x (n, 3) as a term of `algebra.operator.Operator.assemble`."""
        return self._at(x).term(x, coefficient, residual_factor)

    def add_tangent_product(self, x: np.ndarray, d: np.ndarray, out: np.ndarray) -> None:
        """Add the pairs' part of (dr/dx) d, at x (n, 3) along d (n, 3), to `out` (n, 3)."""
        self.forces.contact.cover(x[self.forces.entities[:, 0]])
        self._at(x).add_tangent_product(x, d, out)

    def add_design_product(self, x: np.ndarray, dX: np.ndarray, out: np.ndarray, dx: np.ndarray | None = None) -> None:
        """Add the pairs' part of (dr/dx) dx to `out` (n, 3); arguments as of `Integral`'s."""
        if dx is not None:
            self.add_tangent_product(x, dx, out)

    def _at(self, x: np.ndarray) -> Integral:
        forces, nodes = self.forces, self.entities
        _, coupled = forces.contact.second_derivatives(x[forces.entities[:, 0]], forces.curved)
        table = np.hstack([x[nodes].reshape(-1, 6), coupled])
        return Integral(PAIRS, forces.X, nodes, table, block=self.block)


def coupled_nodes(contact: SelfContact, numbers: np.ndarray) -> np.ndarray:
    """The nodes (m, 2) int32 of pairs of corners, from the numbers (corners,) of their nodes."""
    return np.ascontiguousarray(numbers[contact.pairs].astype(np.int32))
