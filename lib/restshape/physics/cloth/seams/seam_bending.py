"""Bending across seams that are sewn flat: hinges between the triangles on both sides, or ties of Morley's slopes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from restshape.fem.elements import SEAM_FLAT, SEAM_SLOPE
from restshape.fem.integral import Integral
from restshape.mesh.hinges import border_cells, normals
from restshape.mesh.mesh import Mesh
from restshape.mesh.morley import SIDES, MorleySpace
from restshape.physics.cloth.seams.seam_lines import STIFFER
from restshape.physics.cloth.seams.seams import SeamForces, Seams
from restshape.physics.cloth.sheet.fabric import Fabric


class SeamBending:
    """What bends across seams, piece by piece between the nodes of both sides.

    Args:
        seams: whose pairs are `flat` where they bend.
        mesh: of the cloth; morley: the space of Morley's triangles, None: hinges bend.

    Attributes:
        nodes: (m, k) nodes of the mesh of each piece: ends of the edge and third corner, of both sides, or, of Morley's
            triangles, the mesh's edge on each side.
    """

    def __init__(self, seams: Seams, mesh: Mesh, morley: MorleySpace | None) -> None:
        self.seams, self.mesh, self.morley = seams, mesh, morley
        self.element = SEAM_SLOPE["point2"] if morley else SEAM_FLAT["flap6"]
        self.nodes, self.changes = np.zeros((0, 2 if morley else 6), np.int32), 0
        self._sides = [[_borders(mesh, line.nodes, line.along) for line in lines] for lines in seams.flat_lines]
        if morley:
            self._outward = np.empty(len(mesh.edge_nodes))
            # Of the triangle that is last where there are two; edges of seams have one.
            self._outward[mesh.cell_edges[:, SIDES]] = morley.signs

    def place(self, fabric: Fabric) -> None:
        """Take in where the nodes are in the material, and stiffness."""
        pieces = self.seams.flat_pieces()
        corners = [
            np.hstack([own[edges] for own, edges in zip(sides, at)]) for sides, (at, _) in zip(self._corners, pieces)
        ]
        self._at = [at for at, _ in pieces]
        self.lengths = np.concatenate([length for _, length in pieces])
        self.corners = np.vstack(corners)
        nodes = self.corners if self.morley is None else self._by_piece(0)
        if not np.array_equal(nodes, self.nodes):
            self.nodes, self.changes = nodes, self.changes + 1
        self.stiffness = self.stiffness_of(fabric.bending, fabric)

    def stiffness_of(self, bending: np.ndarray, fabric: Fabric) -> np.ndarray:
        """The pieces' stiffness (m,), linear in that of bending (3, 3) or (ne, 3, 3) [N m], or in its rates."""
        D = np.broadcast_to(bending, (len(self.mesh.cells), 3, 3))
        cells = self._by_piece(2)
        across = np.zeros(len(cells))
        for side in range(2):
            n = normals(self.mesh.X, self.corners[:, 3 * side : 3 * side + 2])
            curvature = np.column_stack([n[:, 0] ** 2, n[:, 1] ** 2, 2.0 * n[:, 0] * n[:, 1]])
            across += 0.5 * np.einsum("ia,iab,ib->i", curvature, D[cells[:, side]], curvature)
        # A tie that is stiff beside the triangles, which have the bending themselves.
        return STIFFER * across / self._sizes if self.morley else fabric.hinge_factor * across

    @property
    def _corners(self) -> list[list[np.ndarray]]:
        return [[side[1] for side in sides] for sides in self._sides]

    @property
    def _sizes(self) -> np.ndarray:
        """Of the mesh (m,) [m], at the seam of each piece."""
        sizes = [pair.size for pair in self.seams.pairs if pair.flat]
        return np.repeat(sizes, [len(at[0]) for at in self._at])

    def _by_piece(self, part: int) -> np.ndarray:
        """Edges (0) or cells (2) of both sides of each piece (m, 2)."""
        found = [
            np.column_stack([side[part][edges] for side, edges in zip(sides, at)])
            for sides, at in zip(self._sides, self._at)
        ]
        return np.vstack(found)

    @property
    def own_nodes(self) -> np.ndarray:
        """Numbers (m, k) int32 of what each piece has at its nodes, which no other one has."""
        return np.arange(self.nodes.size, dtype=np.int32).reshape(self.nodes.shape)

    @property
    def dofs(self) -> np.ndarray:
        """Nodes (m, k) int32 whose unknowns the pieces have."""
        numbers = self.morley.side_number if self.morley else self.seams.corner_number
        return np.ascontiguousarray(numbers[self.nodes].astype(np.int32))

    def integral(self, block: int, stiffness: np.ndarray | None = None) -> SeamForces:
        """The pieces, a block of the operator, with their stiffness or another (m,)."""
        values = np.ascontiguousarray((self.stiffness if stiffness is None else stiffness)[:, None])
        places = np.zeros((self.nodes.size, 2))
        if not self.morley:
            places = np.ascontiguousarray(self.mesh.X[self.nodes].reshape(-1, 2))
        table = self._table(self.lengths, *self._scales())
        own = Integral(self.element, places, self.own_nodes, values, block=block, coefficients=table, dofs=self.dofs)
        return SeamForces(self, self.seams.corner_number, own)

    def moved(self, dX: np.ndarray) -> np.ndarray:
        """Rates of places (k m, 2) of the pieces' nodes as the mesh's nodes move with dX (n, 2)."""
        return np.zeros((self.nodes.size, 2)) if self.morley else np.ascontiguousarray(dX[self.nodes].reshape(-1, 2))

    def coefficient_rates(self, dX: np.ndarray) -> np.ndarray:
        """Rates (k m, c) of lengths, and of slopes over unknowns, when the mesh's nodes move with dX (n, 2)."""
        lengths = np.concatenate(self.seams.flat_length_rates(dX))
        if not self.morley:
            return self._table(lengths)
        (scale,) = self._scales()
        ends = self.mesh.edge_nodes[self.nodes]
        d, dd = (values[ends[:, :, 1]] - values[ends[:, :, 0]] for values in (self.mesh.X, dX))
        return self._table(lengths, -scale * np.einsum("msa,msa->ms", d, dd) / np.einsum("msa,msa->ms", d, d))

    def _scales(self) -> Sequence[np.ndarray]:
        """Slopes out of the cloth over unknowns (m, 2) [1/m], of Morley's triangles."""
        if not self.morley:
            return ()
        ends = self.mesh.edge_nodes[self.nodes]
        return (
            self._outward[self.nodes] / np.linalg.norm(self.mesh.X[ends[:, :, 1]] - self.mesh.X[ends[:, :, 0]], axis=2),
        )

    def _table(self, lengths: np.ndarray, *scales: np.ndarray) -> np.ndarray:
        out = np.zeros((*self.nodes.shape, 1 + len(scales)))
        for column, values in enumerate(scales):
            out[:, :, column] = values
        out[:, 0, -1] = lengths
        return np.ascontiguousarray(out.reshape(-1, out.shape[2]))


def _borders(mesh: Mesh, nodes: np.ndarray, along: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mesh edges (p - 1,), ends and third corners (p - 1, 3), and cells (p - 1,) along a line; -1 between its edges."""
    on = along > 0.0
    ends = np.sort(np.column_stack([nodes[:-1], nodes[1:]]), axis=1)[on].astype(np.int64)
    n, all_ends = np.int64(len(mesh.X)), mesh.edge_nodes.astype(np.int64)
    edges = np.searchsorted(all_ends[:, 0] * n + all_ends[:, 1], ends[:, 0] * n + ends[:, 1])
    order = np.argsort(edges)
    cells, corners = border_cells(mesh.cells, mesh.cell_edges, edges[order])
    found = np.full(len(along), -1), np.full((len(along), 3), -1, np.int32), np.full(len(along), -1)
    for out, values in zip(found[1:], (corners, cells)):
        sorted_back = np.empty_like(values)
        sorted_back[order] = values
        out[on] = sorted_back
    found[0][on] = edges
    return found
