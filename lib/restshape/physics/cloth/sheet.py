"""A piece of cloth on one mesh: its energy, forces and tangent stiffness, free of scenes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from restshape import _kernels
from restshape.mesh.hinges import border_cells, hinges, inner_sides, normals
from restshape.mesh.mesh import Mesh
from restshape.mesh.morley import SIDES, MorleySpace
from restshape.physics.cloth.parameters import UPPER, lumped
from restshape.physics.cloth.contact import POTENTIAL, Contact

BENDING = ("morley", "hinge", "nonlinear", "none")
MEMBRANES = {"stvk": ("membrane_tri3", "membrane_stabilised_tri3"), "corotated": ("membrane_corotated_tri3",) * 2}
"""Elements with the true and the stabilised tangent, by law."""
HINGES = {"hinge": ("hinge4", "hinge_mirrored3"), "nonlinear": ("hinge_nonlinear4", "hinge_nonlinear_mirrored3")}
"""Elements of inner edges, and of edges whose other triangle is a mirror image."""


@dataclass(frozen=True)
class Fabric:
    """What cloth is made of.

    Args:
        membrane: (3, 3) or (ne, 3, 3) tensions [N/m] by strains xx, yy and twice xy.
        bending: (3, 3) or (ne, 3, 3) moments [N] by curvatures xx, yy and twice xy [N m].
        density: mass by area [kg/m^2], one or (ne,).
        kind: "morley", "hinge", "nonlinear" (hinges) or "none".
        hinge_factor: of the stiffness of hinges, see `restshape.physics.cloth.parameters.HINGE_STIFFNESS`.
        law: of the membrane, "stvk" or "corotated".
    """

    membrane: np.ndarray
    bending: np.ndarray
    density: float | np.ndarray
    kind: str = "morley"
    hinge_factor: float = 1.0 / 3.0
    law: str = "stvk"


@dataclass(frozen=True)
class Held:
    """Where cloth is held.

    Args:
        mask: (corners, 3) true where a position is given.
        places: (corners, 3) the given positions [m].
        clamped: mesh edges (k,) across which the slope stays; slopes: (k, 3) the derivative of the positions along the
            outward normal of each.
        mirrored: mesh edges (m,) on planes of symmetry; axes: (m,) the coordinate 0, 1 or 2 along each plane's normal.
    """

    mask: np.ndarray
    places: np.ndarray
    clamped: np.ndarray = field(default_factory=lambda: np.empty(0, dtype=np.int32))
    slopes: np.ndarray = field(default_factory=lambda: np.empty((0, 3)))
    mirrored: np.ndarray = field(default_factory=lambda: np.empty(0, dtype=np.int32))
    axes: np.ndarray = field(default_factory=lambda: np.empty(0, dtype=np.int32))


class Sheet:
    """Cloth in space: membrane, bending, weight and contact, with three unknowns a node.

    Between two calls of `lag` all of it is the gradient of a potential.

    Args:
        mesh: kept by reference; its nodes may move.
        fabric: stiffness and mass.
        held: supports.
        g: (3,) acceleration [m/s^2].
        contact: with bodies, over the nodes of the mesh; None: nothing touches.

    Attributes:
        X: (n, 2) material coordinates [m], corners and, of Morley's triangles, edges, as `move` has seen them.
        mask: (n, 3) uint8, 1 where an unknown is given; prescribed: (n, 3) its value [m].
        mass: (n,) lumped onto corners [kg]; 0 for slopes.
        blocks: nodes of what has a tangent: membrane, points, bending.

    Source: docs/theory.md, section "Cloth".
    """

    fields = 3
    potential = True

    def __init__(self, mesh: Mesh, fabric: Fabric, held: Held, g: np.ndarray, contact: Contact | None = None) -> None:
        self.mesh, self.fabric, self.support, self.g, self.contact = mesh, fabric, held, np.asarray(g, float), contact
        self.space = MorleySpace(mesh) if fabric.kind == "morley" else None
        self.membrane, self.stabilised = (_kernels.Element(name) for name in MEMBRANES[fabric.law])
        self.point = _kernels.Element("potential_point1")
        self.number = self.space.corner_number if self.space else np.arange(len(mesh.X), dtype=np.int32)
        # A copy, as X is: flips change the mesh's own.
        corners = self.space.corners if self.space else mesh.cells.copy()
        self.blocks = [corners, np.ascontiguousarray(self.number[:, None])]
        self.bending = self._bending_element()
        if self.bending:
            self.blocks.append(self._bending_cells())
        self.mirror = self._mirrored_element()
        if self.mirror:
            self.blocks.append(self._mirrored_cells())
        self.node_offsets = self.space.node_offsets if self.space else mesh.node_offsets
        self.softness = 1.0
        self.move()

    @property
    def n_nodes(self) -> int:
        """Number of nodes, of corners and edges."""
        return len(self.X)

    @property
    def quadratic_bending(self) -> bool:
        """Tell whether the bending stiffness is the same at all positions."""
        return self.fabric.kind in ("morley", "hinge")

    def move(self) -> None:
        """Take in where the nodes of the mesh are now."""
        if self.space:
            self.space.follow()
        # A copy: the mesh moves its nodes in its own array, and `along` wants to know from where.
        self.X = self.space.X if self.space else self.mesh.X.copy()
        self.normals = self.space.normals() if self.space else None
        n = len(self.X)
        self.area = lumped(self.X, self.blocks[0])
        self.density = np.broadcast_to(self.fabric.density, len(self.mesh.cells))
        self.mass = lumped(self.X, self.blocks[0], self.density)
        self.membrane_params = self._membrane_params()
        self.bending_params = self._bending_params() if self.bending else None
        self.mirror_params = self._mirrored_params() if self.mirror else None
        self.mask, self.prescribed = np.zeros((n, 3), dtype=np.uint8), np.zeros((n, 3))
        self.mask[self.number] = self.support.mask
        self.prescribed[self.number] = np.where(self.support.mask, self.support.places, 0.0)
        if self.space:
            self._hold_slopes()
        self.held = np.flatnonzero(self.mask.ravel())
        self.free = np.where(self.mask, 0.0, 1.0)
        self.weight = self.mass[:, None] * self.g * self.free
        self.load = float(np.linalg.norm(self.weight))
        """Norm of the weight at free nodes [N]."""

    def soften(self, part: float) -> None:
        """Give the membrane a part of its stiffness, or 1 for all of it; weight and bending stay."""
        self.softness = part
        self.membrane_params = self._membrane_params()

    def flat(self, corners: np.ndarray) -> np.ndarray:
        """Unknowns (n, 3) of flat triangles between corners (corners, 3) [m], held ones as they are given."""
        x = self.space.spanned(corners) if self.space else corners.copy()
        return np.where(self.mask, self.prescribed, x)

    def corners(self, x: np.ndarray) -> np.ndarray:
        """Positions (corners, 3) [m] of the mesh's nodes."""
        return x[self.number]

    def curvatures(self, x: np.ndarray) -> np.ndarray:
        """Second derivatives (ne, 3, 3) xx, yy and twice xy of each coordinate, of Morley's triangles at x (n, 3).

        By Gauss's theorem from the slopes of their sides, whose means are those in the middle.
        """
        space = self.space
        corners, sides = space.corners, space.cells[:, 3:]
        start, end = corners, np.roll(corners, -1, axis=1)
        d = self.X[end] - self.X[start]
        length = np.linalg.norm(d, axis=2)
        t = d / length[..., None]
        n = np.stack([t[..., 1], -t[..., 0]], axis=-1)
        twice = d[:, 0, 0] * d[:, 1, 1] - d[:, 0, 1] * d[:, 1, 0]
        slope, rise = space.signs[..., None] * x[sides], x[end] - x[start]
        pairs = ((0, 0, 1.0), (1, 1, 1.0), (0, 1, 2.0))
        parts = [
            np.einsum("es,esa->ea", f * n[..., i] * n[..., j], slope)
            + np.einsum("es,esa->ea", 0.5 * f * (t[..., i] * n[..., j] + t[..., j] * n[..., i]), rise)
            for i, j, f in pairs
        ]
        return np.stack(parts, axis=-1) * (2.0 / twice)[:, None, None]

    def along(self, x: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
        """What takes unknowns x (n, 3), after `move`, along the cloth to where the material of their nodes is then.

        Nodes of the mesh may have moved already: what counts is where `move` has last seen them. Places are right to
        first order in the way of the material, slopes but for curvatures times it; all is where the cloth is flat.
        """
        X, normals, F = self.X.copy(), self.normals, self._gradients(x)

        def moved(x: np.ndarray) -> np.ndarray:
            way = self.X - X
            if self.space:
                # An edge's unknown is a derivative along its normal, which has changed.
                way[self.space.side_number] = self.normals - normals
            return x + np.einsum("iak,ik->ia", F, way) if way.any() else x.copy()

        return moved

    def corners_along(self, x: np.ndarray) -> np.ndarray:
        """Positions (corners, 3) of the cloth at x (n, 3) where the mesh's nodes are now, flips or not; see `along`."""
        way = self.mesh.X - self.X[self.number]
        return self.corners(x) + np.einsum("iak,ik->ia", self._gradients(x)[self.number], way)

    def _gradients(self, x: np.ndarray) -> np.ndarray:
        """Derivatives (n, 3, 2) of the positions at the nodes: means over their triangles, by area."""
        cells, X = self.blocks[0], self.X
        legs = np.stack([X[cells[:, 1]] - X[cells[:, 0]], X[cells[:, 2]] - X[cells[:, 0]]], axis=1)
        rises = np.stack([x[cells[:, 1]] - x[cells[:, 0]], x[cells[:, 2]] - x[cells[:, 0]]], axis=1)
        F = np.linalg.solve(legs, rises).swapaxes(1, 2)
        size = np.linalg.det(legs)
        nodes = self.blocks[2] if self.space else cells
        sums, weights = np.zeros((len(X), 3, 2)), np.zeros(len(X))
        for column in nodes.T:
            np.add.at(sums, column, F * size[:, None, None])
            np.add.at(weights, column, size)
        return sums / weights[:, None, None]

    def lag(self, x: np.ndarray) -> float:
        """Take friction's normal forces at x, and drag its anchors; returns the farthest way of one [m]."""
        return self.contact.lag(self.corners(x)) if self.contact else 0.0

    def follow(self, x: np.ndarray) -> bool:
        """Let friction follow to x (n, 3) as `lag` does; tells whether there is contact, whose energy it changes."""
        self.lag(x)
        return self.contact is not None

    def falls(self, x: np.ndarray) -> bool:
        """Tell whether cloth at x (n, 3) falls without end: nothing holds it, and it goes away from all bodies."""
        way = np.where(self.support.mask.any(axis=0), 0.0, self.g)
        return bool(way.any()) and (self.contact is None or self.contact.passed(self.corners(x), way))

    # --- what is solved -------------------------------------------------------------------------------------------

    def energy(self, x: np.ndarray) -> float:
        """Potential energy [J] at x (n, 3), of weight too."""
        total = float(self.membrane.energy(self.X, x, self.blocks[0], self.membrane_params).sum()) + self.bent(x)
        if self.contact:
            total += self.contact.potential(self.corners(x))[0]
        return total

    def bent(self, x: np.ndarray) -> float:
        """Energy [J] of bending at x (n, 3)."""
        return float(sum(e.energy(self.X, x, cells, params).sum() for e, cells, params in self._bent_parts()))

    def bent_cells(self, x: np.ndarray) -> np.ndarray:
        """Energy (ne,) [J] of bending of each triangle at x (n, 3), of a hinge one half on each side."""
        found = np.zeros(len(self.mesh.cells))
        for k, (element, cells, params) in enumerate(self._bent_parts()):
            energy = element.energy(self.X, x, cells, params)
            if k:
                found += np.bincount(self.mirrored_in, energy, len(found))
            elif self.space:
                found += energy
            else:
                found += np.bincount(self._cells_of_hinges().ravel(), np.repeat(0.5 * energy, 2), len(found))
        return found

    def stretching(self, x: np.ndarray) -> float:
        """Energy [J] of stretching at x (n, 3)."""
        params = self.membrane_params * np.r_[np.ones(6), np.zeros(3)]
        return float(self.membrane.energy(self.X, x, self.blocks[0], params).sum())

    def tensions(self, x: np.ndarray) -> np.ndarray:
        """Second Piola-Kirchhoff tensions (ne, 3) xx, yy, xy [N/m] of the triangles at x (n, 3)."""
        out = np.empty((len(self.blocks[0]), 3))
        self.membrane.stress(self.X, x, self.blocks[0], self.membrane_params, out)
        return out

    def residual(self, x: np.ndarray, out: np.ndarray) -> None:
        """Set `out` (n, 3) [N] to the forces out of balance at x (n, 3), 0 where held."""
        self.unheld(x, out)
        out *= self.free

    def unheld(self, x: np.ndarray, out: np.ndarray) -> None:
        """Set `out` (n, 3) [N] to the forces out of balance at x (n, 3), which supports take where they hold."""
        self.inner(x, out)
        if self.contact:
            out[self.number] += self.contact.potential(self.corners(x))[1][:, 3:6]

    def inner(self, x: np.ndarray, out: np.ndarray) -> None:
        """Set `out` (n, 3) [N] to the forces of membrane, bending and weight, also where held."""
        out[:] = 0.0
        self.membrane.residual(self.X, x, self.blocks[0], self.membrane_params, out)
        for element, cells, params in self._bent_parts():
            element.residual(self.X, x, cells, params, out)

    def points(self, x: np.ndarray, curved: bool, inertia: float = 0.0) -> np.ndarray:
        """Parameters (corners, 12) of contact and of masses times `inertia` [1/s^2] on the diagonal."""
        corners = self.corners(x)
        if self.contact:
            table = self.contact.potential(corners, curved)[1]
        else:
            table = np.zeros((len(corners), POTENTIAL))
            table[:, :3] = corners
        if inertia:
            table[:, 6:9] += (inertia * self.mass[self.number])[:, None]
        return table

    def constant_terms(self) -> list[tuple]:
        """What the operator need assemble only once on a mesh that stays: quadratic bending."""
        return self._bending_terms(np.zeros((self.n_nodes, 3))) if self.quadratic_bending else []

    def terms(self, x: np.ndarray, stabilised: bool, inertia: float = 0.0) -> list[tuple]:
        """What the operator assembles at x (n, 3) besides `constant_terms`."""
        membrane = self.stabilised if stabilised else self.membrane
        terms = [(0, membrane, self.X, x, self.membrane_params, 1.0)]
        if self.contact or inertia:
            terms.append((1, self.point, self.X, x, self.points(x, not stabilised, inertia), 1.0))
        return terms if self.quadratic_bending else terms + self._bending_terms(x)

    # --- parts ----------------------------------------------------------------------------------------------------

    def _bent_parts(self) -> list[tuple]:
        """Elements, cells and parameters of bending."""
        parts = [(self.bending, self.blocks[2], self.bending_params)] if self.bending else []
        return [*parts, (self.mirror, self.blocks[3], self.mirror_params)] if self.mirror else parts

    def _bending_terms(self, x: np.ndarray) -> list[tuple]:
        parts = enumerate(self._bent_parts(), 2)
        return [(block, element, self.X, x, params, 1.0) for block, (element, _, params) in parts]

    def _bending_element(self) -> _kernels.Element | None:
        kind = self.fabric.kind
        if kind == "none":
            return None
        return _kernels.Element("morley_tri6" if kind == "morley" else HINGES[kind][0])

    def _mirrored_element(self) -> _kernels.Element | None:
        """What bends at clamps and planes of symmetry where there are hinges; Morley's edges have slopes instead."""
        kind = self.fabric.kind
        there = len(self.support.clamped) + len(self.support.mirrored)
        return _kernels.Element(HINGES[kind][1]) if kind in HINGES and there else None

    def _mirrored_cells(self) -> np.ndarray:
        """Nodes (k, 3) of each clamped edge, then of each on a plane of symmetry, with its triangle on the left."""
        edges = np.concatenate([self.support.clamped, self.support.mirrored])
        self.mirrored_in, nodes = border_cells(self.mesh.cells, self.mesh.cell_edges, edges)
        return nodes

    def _mirrored_params(self) -> np.ndarray:
        """Stiffness and direction (k, 4) of each mirrored hinge."""
        D = np.broadcast_to(self.fabric.bending, (len(self.mesh.cells), 3, 3))[self.mirrored_in]
        slopes = self.support.slopes / np.linalg.norm(self.support.slopes, axis=1)[:, None]
        directions = np.vstack([slopes, np.eye(3)[self.support.axes]])
        return np.hstack([self._across(self.blocks[3], D), directions])

    def _bending_cells(self) -> np.ndarray:
        return self.space.cells if self.space else hinges(self.mesh.cells, self.mesh.cell_edges)

    def _membrane_params(self) -> np.ndarray:
        load = self.density[:, None] * self.g
        moduli = np.broadcast_to(self.fabric.membrane, (len(load), 3, 3))[:, UPPER[0], UPPER[1]]
        params = np.ascontiguousarray(np.hstack([self.softness * moduli, load]))
        return params[0] if (params == params[0]).all() else params

    def _bending_params(self) -> np.ndarray:
        D = np.broadcast_to(self.fabric.bending, (len(self.mesh.cells), 3, 3))
        if self.space:
            return np.ascontiguousarray(np.hstack([D[:, UPPER[0], UPPER[1]], self.space.signs]))
        # A hinge knows one stiffness: that of bending about its edge, from both sides.
        return self._hinge_stiffness(D)

    def _hinge_stiffness(self, D: np.ndarray) -> np.ndarray:
        """Stiffness (m, 1) [N m] of each hinge: that against curvature across its edge."""
        sides = self._cells_of_hinges()
        return self._across(self.blocks[2], 0.5 * (D[sides[:, 0]] + D[sides[:, 1]]))

    def _across(self, cells: np.ndarray, D: np.ndarray) -> np.ndarray:
        """What hinges at the edges between the first two nodes of cells (m, .) have of bending stiffness (m, 3, 3)."""
        n = normals(self.mesh.X, cells)
        curvature = np.column_stack([n[:, 0] ** 2, n[:, 1] ** 2, 2.0 * n[:, 0] * n[:, 1]])
        stiffness = self.fabric.hinge_factor * np.einsum("ia,iab,ib->i", curvature, D, curvature)
        return np.ascontiguousarray(stiffness[:, None])

    def _cells_of_hinges(self) -> np.ndarray:
        """The two triangles (m, 2) of each hinge."""
        return inner_sides(self.mesh.cell_edges) // 3

    def _hold_slopes(self) -> None:
        """Give the slopes of clamped edges, and those across the normal of planes of symmetry.

        On the border a side that runs as its edge does has the outside on the right, where the normal points.
        """
        space, support, edges = self.space, self.support, self.mesh.edge_nodes
        length = np.linalg.norm(np.diff(self.mesh.X[edges], axis=1)[:, 0], axis=1)
        outward = np.empty(len(edges))
        outward[self.mesh.cell_edges[:, SIDES]] = space.signs
        for edge, slope in zip(support.clamped, support.slopes):
            node = space.side_number[edge]
            self.mask[node] = 1
            self.prescribed[node] = outward[edge] * length[edge] * slope
        for edge, axis in zip(support.mirrored, support.axes):
            node = space.side_number[edge]
            self.mask[node] = np.arange(3) != axis
