"""Nodes of Morley's triangle over a mesh: its corners, and one node an edge that holds a slope instead of a place."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

import numpy as np

from restshape.mesh.mesh import Mesh
from restshape.mesh.over_mesh import OverMesh

SIDES = [2, 0, 1]
"""Corner opposite to each side (0, 1), (1, 2), (2, 0)."""


class MorleySpace(OverMesh):
    """Corners first, then edges, rank by rank; on one rank corners keep their numbers, and cells their corners.

    The unknown of an edge with the ends a, b, in the order of the mesh's ``edge_nodes``, is the derivative of the
    positions along N = (d_y, -d_x), d = X_b - X_a: the slope along the normal on its right times its length. It is a
    length as positions are, and of their scale in the matrix. A flipped edge keeps its number, and takes the direction
    that the mesh gives it.

    Args:
        mesh: of the corners, whose nodes may move, to be followed by `place`, and by `follow` after flips.

    Attributes:
        X: (n, 2) rest positions [m], of edges their middles.
        cells: (ne, 6) corners, then the sides (0, 1), (1, 2), (2, 0); corners: (ne, 3) the first three, contiguous.
        signs: (ne, 3) 1 where a side runs as its edge does, -1 where against it.
        corner_number: (corners,) node of each of the mesh's; side_number: (edges,) node of each mesh edge.
        node_offsets: (ranks + 1,) nodes of rank r are node_offsets[r]:node_offsets[r + 1].
    """

    dim: ClassVar[int] = 2
    cell_type: ClassVar[str] = "tri6"

    def __init__(self, mesh: Mesh) -> None:
        super().__init__(mesh)
        self.mesh = mesh
        offsets, edges = mesh.node_offsets, len(mesh.edge_nodes)
        ranks = len(offsets) - 1
        owner = np.searchsorted(offsets, mesh.edge_nodes.min(axis=1), side="right") - 1
        first = np.searchsorted(np.sort(owner), np.arange(ranks + 1))
        self.node_offsets = (offsets + first).astype(np.int32)
        self.corner_number = (np.arange(len(mesh.X)) + np.repeat(first[:-1], np.diff(offsets))).astype(np.int32)
        self.side_number = np.empty(edges, dtype=np.int32)
        order = np.argsort(owner, kind="stable")
        self.side_number[order] = offsets[owner[order] + 1] + np.arange(edges)
        self.X = np.empty((len(mesh.X) + edges, mesh.dim))
        self.cells = np.empty((len(mesh.cells), 6), dtype=np.int32)
        self.corners = np.empty_like(mesh.cells)
        self.signs = np.empty((len(mesh.cells), 3))
        self._connect(slice(None))
        self.place()

    @property
    def interpolations(self) -> tuple[()]:
        """None: flips set no unknown elsewhere."""
        return ()

    @property
    def geometry(self) -> int:
        """Version of the positions, that of the mesh."""
        return self.mesh.geometry

    def nodes_of(self, name: str) -> np.ndarray:
        """Sorted nodes (k,) int32 of an entity of the outline: its corners, for edges have slopes of their own."""
        return np.sort(self.corner_number[self.mesh.nodes_of(name)])

    def follow(self, changed: np.ndarray) -> np.ndarray:
        """Take in the triangles (k,) that flips have changed, and go where the corners are; returns these triangles."""
        self._connect(changed)
        self.place()
        return changed

    def interpolate(self, field: np.ndarray, interpolations: tuple[object, ...]) -> np.ndarray:
        """A field (n, f) after flips: as it is, with the slopes of flipped edges left to the next solution."""
        return field.copy()

    def _connect(self, cells: np.ndarray | slice) -> None:
        mesh = self.mesh
        edges = mesh.cell_edges[cells][:, SIDES]
        self.corners[cells] = self.corner_number[mesh.cells[cells]]
        self.cells[cells, :3] = self.corners[cells]
        self.cells[cells, 3:] = self.side_number[edges]
        self.signs[cells] = np.where(mesh.cells[cells] == mesh.edge_nodes[edges, 0], 1.0, -1.0)

    def place(self) -> None:
        """Go where the corners are."""
        self.X[self.corner_number] = self.mesh.X
        self.X[self.side_number] = self.mesh.X[self.mesh.edge_nodes].mean(axis=1)

    def normals(self) -> np.ndarray:
        """Vectors N (edges, 2) [m] on the right of the edges and of their lengths."""
        start, end = self.mesh.X[self.mesh.edge_nodes].swapaxes(0, 1)
        d = end - start
        return np.column_stack([d[:, 1], -d[:, 0]])

    def curvatures(self, x: np.ndarray) -> np.ndarray:
        """Second derivatives (ne, f, 3) xx, yy and twice xy of unknowns x (n, f) in the triangles.

        By Gauss's theorem from the slopes of their sides, whose means are those in the middle.
        """
        corners, sides = self.corners, self.cells[:, 3:]
        start, end = corners, np.roll(corners, -1, axis=1)
        d = self.X[end] - self.X[start]
        length = np.linalg.norm(d, axis=2)
        t = d / length[..., None]
        n = np.stack([t[..., 1], -t[..., 0]], axis=-1)
        twice = d[:, 0, 0] * d[:, 1, 1] - d[:, 0, 1] * d[:, 1, 0]
        slope, rise = self.signs[..., None] * x[sides], x[end] - x[start]
        pairs = ((0, 0, 1.0), (1, 1, 1.0), (0, 1, 2.0))
        parts = [
            np.einsum("es,esa->ea", f * n[..., i] * n[..., j], slope)
            + np.einsum("es,esa->ea", 0.5 * f * (t[..., i] * n[..., j] + t[..., j] * n[..., i]), rise)
            for i, j, f in pairs
        ]
        return np.stack(parts, axis=-1) * (2.0 / twice)[:, None, None]

    def placed(
        self, place: Callable[[np.ndarray], np.ndarray], slope: Callable[[np.ndarray], np.ndarray]
    ) -> np.ndarray:
        """Unknowns (n, f) of a smooth surface.

        Args:
            place: of material coordinates (m, 2), the positions (m, f) [m].
            slope: of material coordinates (m, 2), the derivatives (m, f, 2) of the positions.
        """
        middles = slope(self.X[self.side_number])
        return self._joined(place(self.mesh.X), np.einsum("ifk,ik->if", middles, self.normals()))

    def spanned(self, corners: np.ndarray) -> np.ndarray:
        """Unknowns (n, f) of flat triangles between corners (corners, f): at edges the mean slope of both sides."""
        mesh = self.mesh
        a, b, c = mesh.X[mesh.cells].swapaxes(0, 1)
        legs = np.stack([b - a, c - a], axis=1)
        x = corners[mesh.cells]
        slopes = np.linalg.solve(legs, np.stack([x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]], axis=1))
        edges = mesh.cell_edges.ravel()
        N = self.normals()
        along = np.einsum("ik,ikf->if", N[edges], np.repeat(slopes, 3, axis=0))
        mean = np.zeros((len(N), corners.shape[1]))
        np.add.at(mean, edges, along)
        return self._joined(corners, mean / np.bincount(edges, minlength=len(N))[:, None])

    def _joined(self, corners: np.ndarray, sides: np.ndarray) -> np.ndarray:
        x = np.empty((self.n_nodes, corners.shape[1]))
        x[self.corner_number] = corners
        x[self.side_number] = sides
        return x
