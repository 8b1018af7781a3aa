"""Bending of cloth: Morley's triangles, or hinges at the edges between flat triangles."""

import numpy as np

from restshape.fem.elements import HINGE, HINGE_MIRRORED, HINGE_NONLINEAR, HINGE_NONLINEAR_MIRRORED, MORLEY
from restshape.fem.integral import Integral
from restshape.mesh.hinges import border_cells, hinges, inner_sides, normal_rates, normals
from restshape.mesh.mesh import Mesh
from restshape.mesh.morley import MorleySpace
from restshape.physics.cloth.sheet.cloth_boundary import ClothSupports
from restshape.physics.cloth.sheet.fabric import Fabric
from restshape.physics.cloth.sheet.parameters import UPPER

HINGES = {
    "hinge": (HINGE["flap4"], HINGE_MIRRORED["flap3"]),
    "nonlinear": (HINGE_NONLINEAR["flap4"], HINGE_NONLINEAR_MIRRORED["flap3"]),
}
"""Elements of inner edges, and of edges whose other triangle is a mirror image."""
ALIKE = 1e-12
"""Share of a stiffness below which differences are rounding."""
QUADRATIC = ("morley", "hinge")
"""Kinds whose stiffness is the same at all positions."""


class MorleyBending:
    """Plates whose unknowns are positions of corners and slopes across edges.

    Args:
        mesh: whose nodes may move; space: over it.
        block: of the operator.
    """

    def __init__(self, mesh: Mesh, space: MorleySpace, block: int) -> None:
        self.mesh, self.space, self.block = mesh, space, block
        self.element = MORLEY["tri6"]
        self.parameters = np.empty(0)

    def blocks(self) -> list[np.ndarray]:
        """Nodes of what bends, one array a block."""
        return [self.space.cells]

    def update(self, fabric: Fabric, supports: ClothSupports) -> None:
        """Take in stiffness."""
        D = np.broadcast_to(fabric.bending, (len(self.mesh.cells), 3, 3))
        self.parameters = np.ascontiguousarray(np.hstack([D[:, UPPER[0], UPPER[1]], self.space.signs]))

    def integrals(self, X: np.ndarray) -> list[Integral]:
        """Over triangles at X (n, 2)."""
        return [Integral(self.element, X, self.space.cells, self.parameters, block=self.block)]

    def rates(self, X: np.ndarray, x: np.ndarray, dX: np.ndarray, turn: np.ndarray) -> np.ndarray:
        """Zero (n, 3): the triangles' parameters do not depend on places; arguments as of `HingeBending.rates`."""
        return np.zeros_like(x)

    def rate_integrals(self, X: np.ndarray, D: np.ndarray) -> list[Integral]:
        """Those whose residual is the rate of forces at X (n, 2) where the stiffness has rates D (ne, 3, 3) [N m]."""
        params = np.ascontiguousarray(np.hstack([D[:, UPPER[0], UPPER[1]], self.space.signs]))
        return [Integral(self.element, X, self.space.cells, params, block=self.block)]

    def turned_clamps(self, X: np.ndarray, x: np.ndarray, turn: np.ndarray) -> np.ndarray:
        """Zero (n, 3): slopes across clamped edges are prescribed unknowns."""
        return np.zeros_like(x)

    def cell_energies(self, X: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Energies (ne,) [J] of the triangles at x (n, 3)."""
        found = np.zeros(len(self.mesh.cells))
        for integral in self.integrals(X):
            found += integral.energies(x)
        return found


class HingeBending:
    """Hinges at inner edges, and mirrored ones at clamps and on planes of symmetry.

    Args:
        mesh: whose nodes may move.
        kind: of `HINGES`.
        supports: name the edges that are mirrored.
        block: of the operator; mirrored hinges have the next one.
    """

    def __init__(self, mesh: Mesh, kind: str, supports: ClothSupports, block: int) -> None:
        self.mesh, self.block = mesh, block
        self.element = HINGES[kind][0]
        self.nodes = hinges(mesh.cells, mesh.cell_edges)
        self.parameters, self.fabric, self.clamps = np.empty(0), None, len(supports.clamped)
        edges = np.concatenate([supports.clamped, supports.mirrored])
        self.mirror = HINGES[kind][1] if len(edges) else None
        if self.mirror:
            # Of each clamped edge, then of each on a plane of symmetry, with its triangle on the left.
            self.mirrored_in, self.mirrored_nodes = border_cells(mesh.cells, mesh.cell_edges, edges)
            self.mirrored_parameters = np.empty(0)

    def blocks(self) -> list[np.ndarray]:
        """Nodes of what bends, one array a block."""
        return [self.nodes, self.mirrored_nodes] if self.mirror else [self.nodes]

    def update(self, fabric: Fabric, supports: ClothSupports) -> None:
        """Take in stiffness: a hinge knows one, that of bending about its edge, from both sides."""
        self.fabric = fabric
        D = np.broadcast_to(fabric.bending, (len(self.mesh.cells), 3, 3))
        between = D[:1]
        if np.ndim(fabric.bending) > 2:
            sides = self._cells_of_hinges()
            between = 0.5 * (D[sides[:, 0]] + D[sides[:, 1]])
        self.parameters = self._across(self.nodes, between, fabric)
        if self.mirror:
            slopes = supports.slopes / np.linalg.norm(supports.slopes, axis=1)[:, None]
            directions = np.vstack([slopes, np.eye(3)[supports.axes]])
            stiffness = self._across(self.mirrored_nodes, D[self.mirrored_in], fabric)
            self.mirrored_parameters = np.hstack([stiffness, directions])

    def integrals(self, X: np.ndarray) -> list[Integral]:
        """Over edges of triangles at X (n, 2)."""
        found = [Integral(self.element, X, self.nodes, self.parameters, block=self.block)]
        if self.mirror:
            nodes, parameters = self.mirrored_nodes, self.mirrored_parameters
            found.append(Integral(self.mirror, X, nodes, parameters, block=self.block + 1))
        return found

    def rates(self, X: np.ndarray, x: np.ndarray, dX: np.ndarray, turn: np.ndarray) -> np.ndarray:
        """Rates (n, 3) [N] of the forces at constant x (n, 3), from the parameters alone, when nodes move.

        Across a grain a hinge's stiffness follows its direction. The direction of a clamp follows its edge: forces turn
        with positions and direction together, which gives what they do when the direction alone turns.

        Args:
            X: (n, 2) material coordinates [m]; x: (n, 3) positions [m].
            dX: (n, 2) rates of the material coordinates [m].
            turn: (3, 2) that takes directions in the flat pattern to those of clamps in space.
        """
        out = np.zeros_like(x)
        if not alike_everywhere(self.fabric.bending):
            self._add_across(X, x, dX, out)
        if self.mirror:
            parameters, clamped = self.mirrored_parameters, self.mirrored_nodes[: self.clamps]
            axes = np.cross(parameters[: self.clamps, 1:], normal_rates(X, clamped, dX) @ turn.T)
            self._add_turned(X, x, axes, out)
        return out

    def _add_across(self, X: np.ndarray, x: np.ndarray, dX: np.ndarray, out: np.ndarray) -> None:
        """Add to `out` (n, 3) the rates of forces by the stiffness across a grain; arguments as of `rates`."""
        D = np.broadcast_to(self.fabric.bending, (len(self.mesh.cells), 3, 3))
        sides = self._cells_of_hinges()
        stiffness = self._across_rates(self.nodes, 0.5 * (D[sides[:, 0]] + D[sides[:, 1]]), dX)
        Integral(self.element, X, self.nodes, stiffness, block=self.block).add_residual(x, out)
        if self.mirror:
            nodes, parameters = self.mirrored_nodes, self.mirrored_parameters.copy()
            parameters[:, :1] = self._across_rates(nodes, D[self.mirrored_in], dX)
            Integral(self.mirror, X, nodes, parameters, block=self.block + 1).add_residual(x, out)

    def rate_integrals(self, X: np.ndarray, D: np.ndarray) -> list[Integral]:
        """Those whose residual is the rate of forces at X (n, 2) where the stiffness has rates D (ne, 3, 3) [N m]."""
        sides = self._cells_of_hinges()
        stiffness = self._across(self.nodes, 0.5 * (D[sides[:, 0]] + D[sides[:, 1]]), self.fabric)
        found = [Integral(self.element, X, self.nodes, stiffness, block=self.block)]
        if self.mirror:
            parameters = self.mirrored_parameters.copy()
            parameters[:, :1] = self._across(self.mirrored_nodes, D[self.mirrored_in], self.fabric)
            found.append(Integral(self.mirror, X, self.mirrored_nodes, parameters, block=self.block + 1))
        return found

    def turned_clamps(self, X: np.ndarray, x: np.ndarray, turn: np.ndarray) -> np.ndarray:
        """Rates (n, 3) of the forces at x (n, 3) as the directions of all clamps turn with a rate (3,) [rad]."""
        out = np.zeros_like(x)
        if self.mirror and turn.any():
            self._add_turned(X, x, np.tile(turn, (self.clamps, 1)), out)
        return out

    def _add_turned(self, X: np.ndarray, x: np.ndarray, axes: np.ndarray, out: np.ndarray) -> None:
        """Add to `out` (n, 3) the rates of forces at x (n, 3) as directions of clamps turn with rates (k, 3) [rad]."""
        nodes, parameters = self.mirrored_nodes[: self.clamps], self.mirrored_parameters[: self.clamps]
        if not len(nodes):
            return
        # Each hinge with nodes of its own, for each turns about another axis.
        own = np.arange(nodes.size, dtype=np.int32).reshape(nodes.shape)
        places = np.ascontiguousarray(x[nodes].reshape(-1, 3))
        hinge = Integral(self.mirror, np.ascontiguousarray(X[nodes].reshape(-1, 2)), own, parameters, block=None)
        forces, found, about = np.zeros_like(places), np.zeros_like(places), np.repeat(axes, nodes.shape[1], axis=0)
        hinge.add_residual(places, forces)
        hinge.add_tangent_product(places, np.cross(about, places), found)
        np.add.at(out, nodes.ravel(), np.cross(about, forces) - found)

    def _across_rates(self, cells: np.ndarray, D: np.ndarray, dX: np.ndarray) -> np.ndarray:
        """The rates (m, 1) of `_across` when nodes move with dX (n, 2)."""
        n, dn = normals(self.mesh.X, cells), normal_rates(self.mesh.X, cells, dX)
        curvature = np.column_stack([n[:, 0] ** 2, n[:, 1] ** 2, 2.0 * n[:, 0] * n[:, 1]])
        change = 2.0 * np.column_stack(
            [n[:, 0] * dn[:, 0], n[:, 1] * dn[:, 1], n[:, 0] * dn[:, 1] + n[:, 1] * dn[:, 0]]
        )
        return 2.0 * self.fabric.hinge_factor * np.einsum("ia,iab,ib->i", curvature, D, change)[:, None]

    def cell_energies(self, X: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Energies (ne,) [J] of the triangles at x (n, 3), of a hinge one half on each side."""
        found = np.zeros(len(self.mesh.cells))
        inner, *mirrored = (integral.energies(x) for integral in self.integrals(X))
        found += np.bincount(self._cells_of_hinges().ravel(), np.repeat(0.5 * inner, 2), len(found))
        for energy in mirrored:
            found += np.bincount(self.mirrored_in, energy, len(found))
        return found

    def _across(self, cells: np.ndarray, D: np.ndarray, fabric: Fabric) -> np.ndarray:
        """What hinges at the edges between the first two nodes of cells (m, .) have of bending stiffness (m, 3, 3).

        One matrix (1, 3, 3) is that of all.
        """
        n = normals(self.mesh.X, cells)
        curvature = np.column_stack([n[:, 0] ** 2, n[:, 1] ** 2, 2.0 * n[:, 0] * n[:, 1]])
        each = np.broadcast_to(D, (len(cells), 3, 3))
        stiffness = fabric.hinge_factor * np.einsum("ia,iab,ib->i", curvature, each, curvature)
        return np.ascontiguousarray(stiffness[:, None])

    def _cells_of_hinges(self) -> np.ndarray:
        """The two triangles (m, 2) of each hinge."""
        return inner_sides(self.mesh.cell_edges) // 3


def alike_everywhere(D: np.ndarray) -> bool:
    """Whether stiffness D (..., 3, 3) resists bending about all directions alike: there is no grain."""
    uneven = D[..., 0, 0] - D[..., 1, 1], D[..., 0, 2], D[..., 1, 2], D[..., 0, 1] + 2.0 * D[..., 2, 2] - D[..., 0, 0]
    return all(bool((np.abs(part) <= ALIKE * np.abs(D[..., 0, 0])).all()) for part in uneven)


def bending_of(
    fabric: Fabric, mesh: Mesh, morley: MorleySpace | None, supports: ClothSupports, block: int
) -> MorleyBending | HingeBending | None:
    """What bends of a fabric on a mesh, from a block of the operator on; None where nothing does."""
    if fabric.kind == "none":
        return None
    return MorleyBending(mesh, morley, block) if morley else HingeBending(mesh, fabric.kind, supports, block)
