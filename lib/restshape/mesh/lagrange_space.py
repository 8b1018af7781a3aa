"""Second-order nodes over a triangle mesh: its corners, and one node in the middle of each side."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from restshape import _kernels
from restshape.mesh.mesh import Mesh
from restshape.mesh.over_mesh import OverMesh
from restshape.mesh.quality import areas
from restshape.mesh.reconnect import edges_between
from restshape.shape.outline import Outline

MIN_JACOBIAN = 0.1
"""A curved triangle whose Jacobian may fall below this share of that of its straight triangle counts as invalid."""

FRESH_MIN_JACOBIAN = 0.2
"""In a new mesh curved sides of triangles below this share are straightened, so that the next frames need none."""

SIDES = [2, 0, 1]
"""Corner opposite to each side (0, 1), (1, 2), (2, 0)."""


class EdgeInterpolation(NamedTuple):
    """New places of nodes in the middle of flipped edges, as seen from the field before the flips.

    Args:
        nodes: (m,) that have moved.
        stencil: (m, 6) nodes of the triangle that each now lies in; weights: (m, 6) values of its basis there.
    """

    nodes: np.ndarray
    stencil: np.ndarray
    weights: np.ndarray


# More than 15 attributes: a space is its index arrays, which the kernels take one by one.
class LagrangeSpace(OverMesh):
    """Nodes and cells of second order, with the attributes that analyses use of a `Mesh`.

    Straight sides have their node in the middle of their ends; sides on arcs and splines have it on the curve, at the
    middle of their ends' parameters. A flipped edge keeps its number, and its node with it. Behind each corner stand
    the middles of the edges of which it is the smaller end, so that each rank's nodes are contiguous.

    Args:
        mesh: of the corners, whose nodes may move and whose edges may flip.
        numbered: a space over as many nodes and edges, and the same facets, that has numbered them; None: they are
            numbered again, which after flips gives others.

    Attributes:
        X: (n, d) rest positions [m]; cells: (ne, 6) corners, then the middles of the sides (0, 1), (1, 2), (2, 0).
        corners: (ne, 3) first columns of `cells`, contiguous.
        facets: (nf, 3) ends and middle of each facet of the mesh.
        corner_number: (corners,) node of each of the mesh's; side_number: (edges,) node of each mesh edge.
        node_offsets: (ranks + 1,) nodes of rank r are node_offsets[r]:node_offsets[r + 1].
        places: (n,) those of the mesh's nodes; of nodes in the middle of sides it is not used.
        interpolations: what the flips did to nodes since they were last taken in, by setting this to ().
    """

    dim = 2
    cell_type = "tri6"

    def __init__(self, mesh: Mesh, numbered: LagrangeSpace | None = None) -> None:
        super().__init__(mesh)
        self.mesh = mesh
        if numbered is None:
            self.corner_number, self.side_number, self.node_offsets = _numbers(mesh)
            edges = edges_between(mesh.edge_nodes, mesh.facets)
            middles = self.side_number[edges]
            self.facets = np.column_stack([self.corner_number[mesh.facets], middles]).astype(np.int32)
            self.curved, self._groups = self._find_curved(edges)
        else:
            known = numbered.corner_number, numbered.side_number, numbered.node_offsets
            self.corner_number, self.side_number, self.node_offsets = known
            self.facets, self.curved, self._groups = numbered.facets, numbered.curved, numbered._groups
        self.X = np.empty((len(self.corner_number) + len(self.side_number), self.dim))
        self.places = np.zeros(len(self.X), dtype=np.int32)
        self.places[self.corner_number] = mesh.places
        self.corners = np.empty_like(mesh.cells)
        self.cells = np.empty((len(mesh.cells), 6), dtype=np.int32)
        self.offset = np.zeros((len(self.curved), self.dim))
        self._straight = np.zeros(len(self.curved), dtype=bool)
        self.interpolations: tuple[EdgeInterpolation, ...] = ()
        self.set_gesture(None)
        self.bend(mesh.outline)
        self.rebuild()
        self._straighten()

    # --- as a mesh ------------------------------------------------------------------------------------------------

    @property
    def geometry(self) -> int:
        """Version of the positions."""
        return self.mesh.geometry

    @property
    def facet_edge(self) -> np.ndarray:
        """Outline edge (nf,) of each facet."""
        return self.mesh.facet_edge

    @property
    def facet_cell(self) -> np.ndarray:
        """The cell (nf,) on the left of each facet."""
        return self.mesh.facet_cell

    def nodes_of(self, name: str) -> np.ndarray:
        """Sorted nodes of an entity, those in the middle of its sides too; see `Mesh.nodes_of`.

        Raises:
            UserError: there is no such entity.
        """
        own = self.corner_number[self.mesh.nodes_of(name)]
        parts = [own, self.facets[self.facets_of(name)].ravel(), self.cells[self.mesh.filled_by(name)].ravel()]
        return np.unique(np.concatenate(parts)).astype(np.int32)

    def facets_of(self, name: str) -> np.ndarray:
        """Rows of ``facets`` on an entity's edges; see `Mesh.facets_of`."""
        return self.mesh.facets_of(name)

    def on_corners(self, gradient: np.ndarray) -> np.ndarray:
        """The gradient (corners, d) of one (n, d) by all nodes, where middles of sides follow their ends."""
        corners = gradient[self.corner_number].copy()
        half = 0.5 * gradient[self.side_number]
        for end in self.mesh.edge_nodes.T:
            np.add.at(corners, end, half)
        return corners

    def follow(self, changed: np.ndarray) -> np.ndarray:
        """The triangles (k,) int32 that flips have changed: those that are given, for `reconnect` has taken them in."""
        return changed

    def interpolate(self, field: np.ndarray, interpolations: tuple[EdgeInterpolation, ...]) -> np.ndarray:
        """A field (n, f) after flips; see `interpolated`."""
        return interpolated(field, interpolations)

    # --- a frame --------------------------------------------------------------------------------------------------

    def begin(self) -> None:
        """Note where curved sides lie, and which flips are known, for `restore_positions` and `rollback`."""
        self._before, self._known = self.offset.copy(), self.interpolations

    def refer(self) -> None:
        """Take the present places as those at the coefficients (0, 0)."""
        self._reference = self.offset.copy()

    def set_gesture(self, basis: np.ndarray | None) -> None:
        """Take up a gesture by its basis (2, k, d) of the outline's control points; None where it has no basis."""
        self._basis = self._bent(basis)

    def _bent(self, basis: np.ndarray | None) -> np.ndarray:
        """By how much (2, nc, d) the nodes of curved sides go beyond the middle of their ends."""
        if basis is None:
            return np.zeros((2, len(self.curved), self.dim))
        return np.stack([self._offsets(self.mesh.outline, points) for points in basis])

    def bend(self, outline: Outline) -> None:
        """Take the curves of an outline as the places at the coefficients (0, 0)."""
        self._reference = self._offsets(outline)

    def place(self, c: tuple[float, float] = (0.0, 0.0)) -> int:
        """Go where the corners are; returns how many curved triangles are invalid there.

        Args:
            c: coefficients of the gesture beyond those that the reference was taken at.
        """
        mesh = self.mesh
        return _kernels.follow_sides(
            mesh.X,
            self.corner_number,
            mesh.edge_nodes,
            self.side_number,
            self.curved,
            self._reference,
            self._basis,
            *c,
            self.offset,
            self.X,
            self.cells,
            self._curved_cells,
            MIN_JACOBIAN,
        )

    def restore_positions(self) -> None:
        """Go back with the corners to where `begin` found them."""
        kept, self._reference = self._reference, self._before
        self.place()
        self._reference = kept

    def rollback(self) -> None:
        """The same, where the mesh has its connectivity of then again."""
        self.restore_positions()
        self.interpolations = self._known

    def reconnect(self, changed: np.ndarray) -> None:
        """Take in flips: nodes of flipped edges go to their new middles, and `interpolations` shows what lies there.

        Args:
            changed: (k,) cells that the flips changed; corners and curved sides lie as they did at the flips.
        """
        mesh = self.mesh
        edges = np.unique(mesh.cell_edges[changed])
        flipped = edges[(mesh.edge_nodes[edges] != self._ends[edges]).any(axis=1)]
        corners, cells = self.corners[changed], self.cells[changed]
        middles = mesh.X[mesh.edge_nodes[flipped]].mean(axis=1)
        found, weights = _kernels.locate_quadratic(self.X, corners, cells, middles)
        self.interpolations += (EdgeInterpolation(self.side_number[flipped], cells[found], weights),)
        self._connect(changed)
        self._ends[flipped] = mesh.edge_nodes[flipped]

    def rebuild(self) -> None:
        """Take the connectivity of the mesh as it is, and those of `place` at (0, 0)."""
        self._connect(slice(None))
        self._ends = self.mesh.edge_nodes.copy()
        self.place()

    def motion(self, Psi: np.ndarray, basis: np.ndarray | None = None) -> np.ndarray:
        """Displacements (2, n, d) of all nodes a unit of the gesture's coefficients, from those of the corners.

        Args:
            Psi: (2, n2, d) those of the corners.
            basis: of another gesture than the one that was taken up, as of `set_gesture`.
        """
        result = np.empty((2, *self.X.shape))
        for psi, bent, out in zip(Psi, self._basis if basis is None else self._bent(basis), result):
            out[self.corner_number] = psi
            out[self.side_number] = psi[self.mesh.edge_nodes].mean(axis=1)
            out[self.side_number[self.curved]] += bent
        return result

    # --- parts ----------------------------------------------------------------------------------------------------

    def _find_curved(self, edges: np.ndarray) -> tuple[np.ndarray, list[tuple[int, np.ndarray, np.ndarray]]]:
        """The mesh edges (nc,) int32 on arcs and splines, and by outline edge the parameters of middles and ends."""
        mesh = self.mesh
        bends = np.array([edge.kind in ("arc", "spline") for edge in mesh.outline.edges])
        chosen = np.flatnonzero(bends[mesh.facet_edge])
        chosen = chosen[np.argsort(mesh.facet_edge[chosen], kind="stable")]
        own = mesh.facet_edge[chosen]
        nodes = mesh.facets[chosen]
        starts = mesh.vertex_node[[mesh.outline.edges[e].start for e in own]] if len(own) else own
        # A vertex knows its parameter on one of its edges only.
        elsewhere = np.where(nodes == starts[:, None], 0.0, 1.0)
        ends = np.where(mesh.node_edge[nodes] == own[:, None], mesh.node_param[nodes], elsewhere)
        kinds, first = np.unique(own, return_index=True)
        return edges[chosen].astype(np.int32), [
            (int(edge), rows, np.concatenate([part.mean(axis=1), part[:, 0], part[:, 1]]))
            for edge, rows in zip(kinds, np.split(np.arange(len(own)), first[1:]))
            for part in (ends[rows],)
        ]

    def _offsets(self, outline: Outline, points: np.ndarray | None = None) -> np.ndarray:
        """From the middles of curved sides' ends to the curves (nc, d) [m], or their displacements; see `point`."""
        result = np.empty((len(self.curved), self.dim))
        for edge, rows, s in self._groups:
            middle, start, end = outline.point(edge, s, points).reshape(3, -1, self.dim)
            result[rows] = middle - 0.5 * (start + end)
        result[self._straight] = 0.0
        return result

    def _connect(self, cells: np.ndarray | slice) -> None:
        """Number the corners and sides of cells, and find the curved cells."""
        mesh = self.mesh
        self.corners[cells] = self.corner_number[mesh.cells[cells]]
        self.cells[cells, :3] = self.corners[cells]
        self.cells[cells, 3:] = self.side_number[mesh.cell_edges[cells][:, SIDES]]
        bent = np.zeros(len(self.side_number), dtype=bool)
        bent[self.curved[~self._straight]] = True
        self._curved_cells = np.flatnonzero(bent[mesh.cell_edges].any(axis=1)).astype(np.int32)

    def _straighten(self) -> None:
        """Straighten the curved sides of a new mesh whose triangles they would make invalid."""
        bounds = _kernels.curved_jacobian_bound(self.X, self.cells, self._curved_cells)
        low_jacobian_cells = self._curved_cells[
            bounds < 2.0 * FRESH_MIN_JACOBIAN * areas(self.X, self.corners[self._curved_cells])
        ]
        if len(low_jacobian_cells):
            self._straight |= np.isin(self.curved, self.mesh.cell_edges[low_jacobian_cells])
            self.bend(self.mesh.outline)
            self.rebuild()


def _numbers(mesh: Mesh) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The nodes of corners and of edges, and the first ones of ranks, by the edges as they are."""
    n, ends = len(mesh.X), mesh.edge_nodes[:, 0]
    order = np.argsort(ends, kind="stable")
    first = np.searchsorted(ends[order], np.arange(n + 1))
    sides = np.empty(len(ends), dtype=np.int32)
    sides[order] = ends[order] + 1 + np.arange(len(ends))
    corners = (np.arange(n) + first[:-1]).astype(np.int32)
    return corners, sides, (mesh.node_offsets + first[mesh.node_offsets]).astype(np.int32)


def interpolated(field: np.ndarray, interpolations: tuple[EdgeInterpolation, ...]) -> np.ndarray:
    """A field (n, f) after flips: the values of the old field where nodes of flipped edges are now.

    Args:
        field: (n, f) before; it stays as it is.
        interpolations: of the flips, in their order.
    """
    if not interpolations:
        return field
    result = field.copy()
    for nodes, stencil, weights in interpolations:
        result[nodes] = np.einsum("ij,ijk->ik", weights, result[stencil])
    return result
