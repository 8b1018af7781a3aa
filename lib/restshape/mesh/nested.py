"""Nested meshes: each triangle in four, from the moving mesh to the one that fields live on."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from restshape.mesh.lagrange_space import FRESH_MIN_JACOBIAN, MIN_JACOBIAN
from restshape.mesh.mesh import Mesh
from restshape.mesh.quality import areas
from restshape.mesh.reconnect import edges_between
from restshape.shape.outline import Outline

BENT = ("arc", "spline", "polyline")
"""Kinds of outline edges on which the middle between two nodes may lie off the edge."""


@dataclass(eq=False, slots=True)
class Refined:
    """A mesh, and how it comes from one with a quarter of its triangles.

    Behind each node of the coarse mesh stand the middles of the edges of which it is the smaller end, so that
    neighbours stay close and each rank's nodes are contiguous. The coarse cell c becomes the cells 4 c to 4 c + 3: the
    first three hold its corners, each at its old place among three, the last one has the middles opposite to them.

    Args:
        mesh: the fine one.
        parents: (n, 2) int32 coarse nodes between which each node lies; equal for a node that both meshes have.
        corner_number: (n_coarse,) int32 fine node of each coarse one; side_number: (coarse edges,) of each middle.
        straight: (coarse facets,) bool of those on bent outline edges whose middle stays between their ends.
        curved: (m,) other new nodes on bent outline edges, which lie on these.
        curved_cells: (k,) coarse cells that have such a side.
    """

    mesh: Mesh
    parents: np.ndarray
    corner_number: np.ndarray
    side_number: np.ndarray
    straight: np.ndarray
    curved: np.ndarray
    curved_cells: np.ndarray

    @property
    def children(self) -> np.ndarray:
        """Fine cells (ne_coarse, 4) int32 of each coarse one."""
        return np.arange(len(self.mesh.cells), dtype=np.int32).reshape(-1, 4)

    def prolonged(self, field: np.ndarray) -> np.ndarray:
        """Values (n, f) at the nodes, from those (n_coarse, f) at the coarse ones: the means of their parents."""
        return 0.5 * (field[self.parents[:, 0]] + field[self.parents[:, 1]])

    def low_jacobian_cells(self, share: float) -> np.ndarray:
        """Those (k,) of `curved_cells` of which a part has less than a share of a quarter of the area."""
        X, cells = self.mesh.X, self.mesh.cells.reshape(-1, 4, 3)[self.curved_cells]
        whole = areas(X, np.ascontiguousarray(cells[:, [0, 1, 2], [0, 1, 2]]))
        parts = areas(X, cells.reshape(-1, 3)).reshape(-1, 4)
        return self.curved_cells[parts.min(axis=1) <= 0.25 * share * whole]


class NestedMesh:
    """A mesh that may move, and refinements of it, each nested in the one before.

    Fields live on the finest one; its attribute `hierarchy` is this object. A cell of it is of low quality as the
    coarse cell is in which it lies, save along bent edges. After flips another hierarchy is made, by `reconnected`.

    Args:
        mesh: the coarsest; its nodes may move, in its own array.
        levels: number of meshes.
        straight: of each level but the finest, which facets on bent edges stay straight; by default those whose
            triangles a bent side would make invalid.

    Attributes:
        meshes: the coarsest first; steps: from each to the next.
    """

    def __init__(self, mesh: Mesh, levels: int, straight: list[np.ndarray] | None = None) -> None:
        self.meshes: list[Mesh] = [mesh]
        self.steps: list[Refined] = []
        inherited = np.zeros(len(mesh.facets), dtype=bool)
        for level in range(levels - 1):
            kept = inherited if straight is None else straight[level]
            step = refine(self.meshes[-1], kept, mend=straight is None)
            self.steps.append(step)
            self.meshes.append(step.mesh)
            inherited = np.repeat(step.straight, 2)
        self._find_curves()
        self.finest.hierarchy = self
        self.stamp()

    @property
    def finest(self) -> Mesh:
        """The mesh that fields live on."""
        return self.meshes[-1]

    def prolong(self, level: int, field: np.ndarray) -> np.ndarray:
        """Values (n, f) on the mesh of level + 1, from those (n_coarse, f) on that of a level, 0 being the coarsest."""
        return self.steps[level].prolonged(field)

    def follow(self) -> int:
        """Go where the coarsest mesh is, with its versions; returns how many of its triangles bent sides make
        invalid."""
        invalid = self.place(self.meshes[0].outline)
        self.stamp()
        return invalid

    def place(self, outline: Outline, X: np.ndarray | None = None) -> int:
        """Lay the nodes of all but the coarsest mesh; returns how many triangles bent sides make invalid.

        Args:
            outline: of which the bent edges are.
            X: (n_coarse, d) where the coarsest mesh's nodes are [m]; default: where they are now.
        """
        X = self.meshes[0].X if X is None else X
        on_curves, invalid = self._on_curves(outline), 0
        for step, rows in zip(self.steps, self._rows):
            fine = step.mesh
            np.add(X[step.parents[:, 0]], X[step.parents[:, 1]], out=fine.X)
            fine.X *= 0.5
            fine.X[step.curved] = on_curves[rows]
            X, invalid = fine.X, invalid + len(step.low_jacobian_cells(MIN_JACOBIAN))
        return invalid

    def stamp(self) -> None:
        """Take the outline, and the version of the positions, from the coarsest mesh."""
        for mesh in self.meshes[1:]:
            mesh.outline, mesh.geometry = self.meshes[0].outline, self.meshes[0].geometry

    def motion(self, Psi: np.ndarray, basis: np.ndarray | None) -> np.ndarray:
        """Displacements (2, n, d) of the finest nodes a unit of a gesture's coefficients, from those of the coarsest.

        Args:
            Psi: (2, n_coarse, d); basis: (2, k, d) of the outline's control points, None where the gesture has none.
        """
        result = []
        for psi, points in zip(Psi, basis if basis is not None else (None, None)):
            for step, rows in zip(self.steps, self._rows):
                psi = step.prolonged(psi)
                if points is not None:
                    psi[step.curved] = self._on_curves(self.meshes[0].outline, points)[rows]
            result.append(psi)
        return np.stack(result)

    def reconnected(self) -> NestedMesh:
        """The hierarchy over the coarsest mesh after flips, with the same sides straight."""
        return NestedMesh(self.meshes[0], len(self.meshes), [step.straight for step in self.steps])

    def cells_in(self, cells: np.ndarray) -> np.ndarray:
        """Cells (k,) int32 of the finest mesh inside some of the coarsest."""
        parts = 4 ** len(self.steps)
        return (parts * cells[:, None] + np.arange(parts)).ravel().astype(np.int32)

    def _find_curves(self) -> None:
        """Set which bent edge, and which parameters on it, the curved nodes of all levels have."""
        ends = np.cumsum([0, *(len(step.curved) for step in self.steps)])
        self._rows = [slice(a, b) for a, b in itertools.pairwise(ends)]
        edge, param = np.empty(ends[-1], dtype=np.int32), np.empty(ends[-1])
        for step, rows in zip(self.steps, self._rows):
            edge[rows], param[rows] = step.mesh.node_edge[step.curved], step.mesh.node_param[step.curved]
        self._curves = [(int(e), np.flatnonzero(edge == e), param[edge == e]) for e in np.unique(edge)]
        self._count = int(ends[-1])

    def _on_curves(self, outline: Outline, points: np.ndarray | None = None) -> np.ndarray:
        """Places (m, d) of the curved nodes of all levels, or their displacements; see `Outline.point`."""
        result = np.empty((self._count, self.meshes[0].dim))
        for edge, rows, s in self._curves:
            result[rows] = outline.point(edge, s, points)
        return result


def refine(mesh: Mesh, straight: np.ndarray | None = None, *, mend: bool = True) -> Refined:
    """The mesh with each triangle in four, its new boundary nodes on the outline.

    Args:
        mesh: whose nodes on the outline lie there.
        straight: (nf,) bool of facets whose middle stays between their ends; default: none.
        mend: others stay straight, too, where a bent side would make invalid a triangle.
    """
    n, outline = len(mesh.X), mesh.outline
    facet_sides = edges_between(mesh.edge_nodes, mesh.facets)
    corner_number, side_number, offsets = _numbers(mesh)
    total = n + len(side_number)
    parents = np.empty((total, 2), dtype=np.int32)
    parents[corner_number] = np.arange(n, dtype=np.int32)[:, None]
    parents[side_number] = mesh.edge_nodes
    middles = side_number[facet_sides]
    node_edge, node_param = np.full(total, -1, dtype=np.int32), np.zeros(total)
    node_edge[corner_number], node_param[corner_number] = mesh.node_edge, mesh.node_param
    node_edge[middles], node_param[middles] = mesh.facet_edge, _middle_params(mesh)
    start, end = corner_number[mesh.facets].T
    fine = Mesh.build(
        0.5 * (mesh.X[parents[:, 0]] + mesh.X[parents[:, 1]]),
        _quartered(corner_number[mesh.cells], side_number[mesh.cell_edges]),
        outline,
        facets=np.column_stack([start, middles, middles, end]).reshape(-1, 2),
        facet_edge=np.repeat(mesh.facet_edge, 2),
        node_edge=node_edge,
        node_param=node_param,
        vertex_node=np.where(mesh.vertex_node < 0, -1, corner_number[mesh.vertex_node]),
        cell_region=np.repeat(mesh.cell_region, 4),
        node_offsets=offsets,
        places=_places(mesh.places[parents]),
    )
    bent = np.array([edge.kind in BENT for edge in outline.edges])[mesh.facet_edge]
    straight = np.zeros(len(bent), dtype=bool) if straight is None else straight.copy()
    nothing = np.empty(0, dtype=np.int32)
    step = Refined(fine, parents, corner_number, side_number, straight, nothing, nothing)
    while True:
        _bend(step, mesh, facet_sides, bent & ~straight)
        low_jacobian_cells = step.low_jacobian_cells(FRESH_MIN_JACOBIAN) if mend else nothing
        if not len(low_jacobian_cells):
            return step
        straight |= bent & np.isin(facet_sides, mesh.cell_edges[low_jacobian_cells])


def _bend(step: Refined, mesh: Mesh, facet_sides: np.ndarray, curved: np.ndarray) -> None:
    """Lay the middles of the curved facets (nf,) on the outline, those of others between their ends."""
    X, outline = step.mesh.X, mesh.outline
    X[step.curved] = mesh.X[step.parents[step.curved]].mean(axis=1)
    nodes = step.side_number[facet_sides[curved]]
    for edge in np.unique(mesh.facet_edge[curved]).tolist():
        own = nodes[step.mesh.node_edge[nodes] == edge]
        X[own] = outline.point(edge, step.mesh.node_param[own])
    step.curved = nodes
    touched = np.isin(mesh.cell_edges, facet_sides[curved]).any(axis=1)
    step.curved_cells = np.flatnonzero(touched).astype(np.int32)


def _numbers(mesh: Mesh) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Fine nodes of the corners (n,) and of the middles (edges,), and the ranks' offsets."""
    n, edges = len(mesh.X), np.sort(mesh.edge_nodes, axis=1)
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    first = np.searchsorted(edges[order, 0], np.arange(n + 1))
    corner_number = (np.arange(n) + first[:-1]).astype(np.int32)
    side_number = np.empty(len(edges), dtype=np.int32)
    side_number[order] = edges[order, 0] + 1 + np.arange(len(edges))
    return corner_number, side_number, (mesh.node_offsets + first[mesh.node_offsets]).astype(np.int32)


def _places(parents: np.ndarray) -> np.ndarray:
    """Places (n,) int32 of nodes from those (n, 2) of their parents: the numbers that one rank would give them."""
    low, high = np.sort(parents, axis=1).T
    result = np.empty(len(parents), dtype=np.int32)
    result[np.lexsort((high, low))] = np.arange(len(parents), dtype=np.int32)
    return result


def _middle_params(mesh: Mesh) -> np.ndarray:
    """Parameters (nf,) in the middle of the facets, on their outline edges."""
    own, nodes = mesh.facet_edge, mesh.facets
    starts = np.array([edge.start for edge in mesh.outline.edges])[own]
    # A vertex knows its parameter on one of its edges only.
    elsewhere = np.where(nodes == mesh.vertex_node[starts][:, None], 0.0, 1.0)
    return np.where(mesh.node_edge[nodes] == own[:, None], mesh.node_param[nodes], elsewhere).mean(axis=1)


def _quartered(corners: np.ndarray, middles: np.ndarray) -> np.ndarray:
    """Cells (4 ne, 3) from the corners (ne, 3) of cells, and from the middles of the sides opposite to them."""
    a, b, c = corners.T
    opposite_a, opposite_b, opposite_c = middles.T
    parts = [
        (a, opposite_c, opposite_b),
        (opposite_c, b, opposite_a),
        (opposite_b, opposite_a, c),
        (opposite_a, opposite_b, opposite_c),
    ]
    return np.stack([np.column_stack(part) for part in parts], axis=1).reshape(-1, 3)
