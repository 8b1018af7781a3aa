"""A triangle mesh that knows which part of its outline each node and facet lies on."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np

from restshape import _kernels
from restshape.mesh.over_mesh import NodesAndCells
from restshape.mesh.regions import cell_patches
from restshape.shape.outline import Entity, Outline

_topologies = itertools.count(1)


class Hierarchy(Protocol):
    """Meshes, each nested in the one before.

    Attributes:
        meshes: the coarsest first.
    """

    meshes: list[Mesh]

    def prolong(self, level: int, field: np.ndarray) -> np.ndarray:
        """Values (n, f) on the mesh of level + 1, from those (n_coarse, f) on that of a level, 0 being the coarsest."""


# More than 15 attributes: a mesh is its index arrays, which the kernels take one by one.
@dataclass(eq=False)
class Mesh(NodesAndCells):
    """First-order triangles, and their ties to an outline.

    Args:
        X: (n, 2) rest positions [m].
        cells: (ne, 3) nodes of each triangle, counter-clockwise.
        cell_edges: (ne, 3) mesh edge opposite to corner i.
        edge_nodes: (n_edges, 2) ends of each mesh edge, the smaller first; edges are sorted by them.
        facets: (nf, 2) mesh edges on outline edges; the material (a region's own inside) is on their left.
        facet_edge: (nf,) outline edge; facet_cell: (nf,) the cell on the left.
        node_edge: (n,) outline edge that a node lies on, or -1; node_param: (n,) parameter on it.
        vertex_node: (nv,) node of each outline vertex, or -1.
        cell_region: (ne,) 0 or i + 1 for the innermost, i-th region loop.
        node_offsets: (ranks + 1,) nodes of rank r are node_offsets[r]:node_offsets[r + 1].
        outline: the outline whose entities the mesh resolves.
        places: (n,) of the nodes in an order that does not hang on the number of ranks; default: their numbers.
        topology, geometry: versions; equal versions mean the same connectivity, the same positions.
        hierarchy: the meshes that this one is the finest of, if it is nested in a coarser one.

    Attributes:
        dim: of the cells; cell_type: their shape and order, as elements are named.
    """

    X: np.ndarray
    cells: np.ndarray
    cell_edges: np.ndarray
    edge_nodes: np.ndarray
    facets: np.ndarray
    facet_edge: np.ndarray
    facet_cell: np.ndarray
    node_edge: np.ndarray
    node_param: np.ndarray
    vertex_node: np.ndarray
    cell_region: np.ndarray
    node_offsets: np.ndarray
    outline: Outline
    places: np.ndarray
    topology: int
    geometry: int = 0
    hierarchy: Hierarchy | None = None
    _node_piece: tuple[np.ndarray, int] = (np.empty(0, dtype=np.int32), -1)

    dim: ClassVar[int] = 2
    cell_type: ClassVar[str] = "tri3"

    interpolations: ClassVar[tuple] = ()
    """What flips did to nodes of edges, of which there are none; see `restshape.mesh.lagrange_space`."""

    @classmethod
    def build(
        cls,
        X: np.ndarray,
        cells: np.ndarray,
        outline: Outline,
        *,
        facets: np.ndarray,
        facet_edge: np.ndarray,
        node_edge: np.ndarray,
        node_param: np.ndarray,
        vertex_node: np.ndarray,
        cell_region: np.ndarray | None = None,
        node_offsets: np.ndarray | None = None,
        places: np.ndarray | None = None,
    ) -> Mesh:
        """A mesh from its primary arrays; see the class for their shapes."""
        cells = np.ascontiguousarray(cells, dtype=np.int32)
        facets = np.ascontiguousarray(facets, dtype=np.int32)
        edge_nodes, cell_edges = edges_of_cells(cells, len(X))
        regions = np.zeros(len(cells), dtype=np.int32) if cell_region is None else cell_region
        offsets = np.array([0, len(X)], dtype=np.int32) if node_offsets is None else node_offsets
        return cls(
            X=np.ascontiguousarray(X, dtype=float),
            cells=cells,
            cell_edges=cell_edges,
            edge_nodes=edge_nodes,
            facets=facets,
            facet_edge=np.ascontiguousarray(facet_edge, dtype=np.int32),
            facet_cell=cells_left_of(facets, cells, len(X)),
            node_edge=np.ascontiguousarray(node_edge, dtype=np.int32),
            node_param=np.ascontiguousarray(node_param, dtype=float),
            vertex_node=np.ascontiguousarray(vertex_node, dtype=np.int32),
            cell_region=np.ascontiguousarray(regions, dtype=np.int32),
            node_offsets=np.ascontiguousarray(offsets, dtype=np.int32),
            outline=outline,
            places=np.arange(len(X), dtype=np.int32) if places is None else places,
            topology=next(_topologies),
        )

    @property
    def corners(self) -> np.ndarray:
        """Corners (ne, 3) of the triangles: all their nodes."""
        return self.cells

    @property
    def mesh(self) -> Mesh:
        """The mesh itself, as of any space over one."""
        return self

    def motion(self, Psi: np.ndarray, _: np.ndarray | None = None) -> np.ndarray:
        """Displacements (2, n, d) of all nodes from those of the corners: the same, for there are no other nodes."""
        return Psi

    def on_corners(self, gradient: np.ndarray) -> np.ndarray:
        """A gradient (n, d) by the places of the corners: the same, for there are no other nodes."""
        return gradient

    def follow(self, changed: np.ndarray) -> np.ndarray:
        """The triangles (k,) int32 that flips have changed: those that are given, for the arrays are the mesh's own."""
        return changed

    def interpolate(self, field: np.ndarray, interpolations: tuple) -> np.ndarray:
        """A field (n, f) after flips, of which corners know nothing."""
        return field

    def nodes_of(self, name: str) -> np.ndarray:
        """Sorted nodes of an entity: of a vertex, on edges and holes, in and around regions; of all cells for "all".

        Raises:
            UserError: there is no such entity.
        """
        entity = self.outline.entity(name)
        own = self.vertex_node[list(entity.vertices)]
        # Marked, which takes a third of the time that sorting takes.
        on = np.zeros(len(self.X), dtype=bool)
        on[own[own >= 0]] = True
        on[self.facets[self.facets_of(name)]] = True
        if len(filled := self.filled_by(name)):
            on[self.cells[filled]] = True
        return on.nonzero()[0].astype(np.int32)

    def filled_by(self, name: str) -> np.ndarray:
        """Triangles all of whose nodes are an entity's: those of `cells_of` for regions and "all", else none.

        Raises:
            UserError: there is no such entity.
        """
        filled = name == "all" or name in self._panels() or self._regions(self.outline.entity(name))
        return self.cells_of(name) if filled else np.empty(0, dtype=np.int32)

    def facets_of(self, name: str) -> np.ndarray:
        """Rows of ``facets`` on an entity's edges, pieces of a split edge included.

        Raises:
            UserError: there is no such entity.
        """
        chosen = np.zeros(len(self.outline.edges), dtype=bool)
        chosen[list(self.outline.entity(name).edges)] = True
        return chosen[self.facet_edge].nonzero()[0].astype(np.int32)

    def cells_of(self, name: str) -> np.ndarray:
        """Triangles inside an entity: a region less the regions in it, or all for "all" and "outline"; else none.

        Raises:
            UserError: there is no such entity.
        """
        entity = self.outline.entity(name)
        loops = self.outline.loops
        if name in (panels := self._panels()):
            return np.flatnonzero(self.cell_piece == panels.index(name)).astype(np.int32)
        if any(loops[i].kind == "outline" for i in entity.loops):
            return np.arange(len(self.cells), dtype=np.int32)
        wanted = self._regions(entity)
        chosen = np.flatnonzero(np.isin(self.cell_region, wanted)) if wanted else np.empty(0)
        return chosen.astype(np.int32)

    def _panels(self) -> tuple[str, ...]:
        """Names of the pieces where there are several, or where one has a name of its own."""
        pieces = self.outline.piece_names
        return () if pieces == ("outline",) else pieces

    @property
    def cell_piece(self) -> np.ndarray:
        """Number (ne,) of the piece of the outline that each triangle lies in."""
        return self.node_piece[self.cells[:, 0]]

    @property
    def node_piece(self) -> np.ndarray:
        """Number (n,) of the piece of the outline that each node lies in, which flips do not change."""
        known, of = self._node_piece
        if of != len(self.X):
            known = self._find_pieces()
            self._node_piece = known, len(self.X)
        return known

    def _find_pieces(self) -> np.ndarray:
        found = np.zeros(len(self.X), dtype=np.int32)
        if len(self.outline.piece_names) < 2:
            return found
        patch = cell_patches(self.cell_edges, np.zeros(len(self.edge_nodes), dtype=bool))
        own = np.zeros(patch.max() + 1, dtype=np.int32)
        own[patch[self.facet_cell]] = self.outline.layout.edge_piece[self.facet_edge]
        found[self.cells] = own[patch][:, None]
        return found

    def _regions(self, entity: Entity) -> list[int]:
        """Numbers, from 1, of the region loops of an entity."""
        loops = self.outline.loops
        numbers = itertools.accumulate(loop.kind == "region" for loop in loops)
        number = dict(enumerate(numbers))
        return [number[i] for i in entity.loops if loops[i].kind == "region"]


def edges_of_cells(cells: np.ndarray, n_nodes: int) -> tuple[np.ndarray, np.ndarray]:
    """Edges (n_edges, 2) of triangles, sorted, and the edge (ne, 3) opposite to each corner.

    Args:
        cells: (ne, 3) nodes.
        n_nodes: number of nodes.
    """
    return _kernels.edges_of_cells(np.ascontiguousarray(cells, dtype=np.int32), n_nodes)


def cells_left_of(facets: np.ndarray, cells: np.ndarray, n_nodes: int) -> np.ndarray:
    """The cell (nf,) to the left of each directed facet, -1 where there is none.

    Args:
        facets: (nf, 2) directed node pairs; cells: (ne, 3) counter-clockwise; n_nodes: number of nodes.
    """
    facets, cells = (np.ascontiguousarray(pairs, dtype=np.int32) for pairs in (facets, cells))
    return _kernels.cells_left_of(facets, cells, n_nodes)
