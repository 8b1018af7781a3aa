"""Contact and inertia at the nodes of cloth, as an integral over points, and contact at points of triangles."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from restshape import _kernels
from restshape.algebra.operator import CellSubset, MatrixTerm
from restshape.fem import elements
from restshape.fem.integral import Integral
from restshape.physics.cloth.contact.contact import POTENTIAL, Contact
from restshape.physics.cloth.contact.contact_points import ContactPoints

ELEMENT, IN_TRIANGLE = elements.POTENTIAL["point1"], elements.POTENTIAL["tri3"]
"""Quadratic functions of a node's position, and of that of a point of a triangle."""


@dataclass(frozen=True, eq=False)
class PointForces:
    """Like `fem.integral.Integral`, with parameters that are taken at each x.

    Args:
        X: (n, 2) material coordinates [m].
        entities: (corners, 1) int32 the node of each corner.
        contact: of the corners, and of the points of triangles; None: nothing touches.
        mass: (corners,) [kg] of them; inertia: [1/s^2] that it is multiplied with on the diagonal.
        area_rates: gives the rates (corners + points,) of the areas of contact when nodes move with rates (n, 2).
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
            out[nodes] += self.contact.forces(self.contact.place(x[nodes]))[: len(nodes)]

    def energies(self, x: np.ndarray) -> np.ndarray:
        """The energy (1,) [J] of contact at x (n, 3), that of the points of triangles included."""
        contact = self.contact
        return np.array([contact.energy(contact.place(x[self.entities[:, 0]])) if contact else 0.0])

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
            out[nodes] += self.contact.force_rates(self.contact.place(x[nodes]), self.area_rates(dX))[: len(nodes)]

    def _at(self, x: np.ndarray) -> Integral:
        """The quadratic functions that agree with contact and inertia at x (n, 3) in value, slope and curvature."""
        corners = x[self.entities[:, 0]]
        if self.contact:
            table = self.contact.potential(self.contact.place(corners), self.curved)[1][: len(corners)].copy()
        else:
            table = np.zeros((len(corners), POTENTIAL))
            table[:, :3] = corners
        if self.inertia:
            table[:, 6:9] += (self.inertia * self.mass)[:, None]
        return Integral(ELEMENT, self.X, self.entities, table, block=self.block)


@dataclass(frozen=True, eq=False)
class TriangleForces:
    """The same at the points of triangles; their energy is counted at the nodes.

    Args:
        X: (n, 2) material coordinates [m].
        entities: (corners, 1) int32 the node of each corner.
        contact: of both.
        area_rates: as of `PointForces`.
        curved: with the force times the curvature of the surface.
        block: of the triangles in the operator.
    """

    X: np.ndarray
    entities: np.ndarray
    contact: Contact
    area_rates: Callable[[np.ndarray], np.ndarray]
    curved: bool = True
    # Not the block that a subset of cells is chosen from by residuals.
    block: None = None
    matrix_block: int = 0

    @property
    def points(self) -> ContactPoints:
        """The points."""
        assert self.contact.points is not None, "without triangles there are no points of them"
        return self.contact.points

    @cached_property
    def nodes(self) -> np.ndarray:
        """The nodes (m, 3) int32 around each point."""
        return np.ascontiguousarray(self.entities[self.points.nodes, 0])

    def add_residual(self, x: np.ndarray, out: np.ndarray, subset: np.ndarray | None = None) -> None:
        """Add the forces [N] of contact at x (n, 3) to `out` (n, 3)."""
        place = self.contact.place(x[self.entities[:, 0]])
        self.spread(self.contact.forces(place)[len(self.entities) :], out)

    def energies(self, x: np.ndarray) -> np.ndarray:
        """None (0,): `PointForces` has them."""
        return np.empty(0)

    def term(self, x: np.ndarray, coefficient: float = 1.0, residual_factor: float | None = None) -> MatrixTerm:
        """The points at x (n, 3) as a term of `algebra.operator.Operator.assemble`."""
        active, integral = self._at(x)
        _, *rest = integral.term(x, coefficient, residual_factor)
        return (CellSubset(self.matrix_block, self.points.cell[active]), *rest)

    def add_tangent_product(self, x: np.ndarray, d: np.ndarray, out: np.ndarray) -> None:
        """Add (dr/dx) d, at x (n, 3) along d (n, 3), to `out` (n, 3)."""
        self._at(x)[1].add_tangent_product(x, d, out)

    def add_design_product(self, x: np.ndarray, dX: np.ndarray, out: np.ndarray, dx: np.ndarray | None = None) -> None:
        """Add (dr/dX) dX + (dr/dx) dx to `out` (n, 3); arguments as of `Integral.add_design_product`."""
        if dx is not None:
            self.add_tangent_product(x, dx, out)
        place = self.contact.place(x[self.entities[:, 0]])
        self.spread(self.contact.force_rates(place, self.area_rates(dX))[len(self.entities) :], out)

    def spread(self, forces: np.ndarray, out: np.ndarray) -> None:
        """Add forces (m, 3) at the points to those `out` (n, 3) of the nodes around them."""
        active = _kernels.nonzero_rows(forces)
        table = np.zeros((len(active), 3 + POTENTIAL))
        table[:, :3], table[:, 6:9] = self.points.weights[active], forces[active]
        Integral(IN_TRIANGLE, self.X, self.nodes[active], table, block=None).add_residual(np.zeros_like(out), out)

    def _at(self, x: np.ndarray) -> tuple[np.ndarray, Integral]:
        """The points (k,) that touch, and the quadratic functions that agree with contact there at x (n, 3)."""
        place = self.contact.place(x[self.entities[:, 0]])
        table = self.contact.potential(place, self.curved)[1][len(self.entities) :]
        active = _kernels.nonzero_rows(table[:, 3:])
        touching = np.column_stack([self.points.weights[active], table[active]])
        return active, Integral(IN_TRIANGLE, self.X, self.nodes[active], touching, block=self.matrix_block)
