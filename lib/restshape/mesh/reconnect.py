"""Level 2: Delaunay flips in the arrays of a mesh."""

import numpy as np

from restshape import _kernels
from restshape.mesh.mesh import Mesh

PASSES = 10
"""Bound on flips per edge in one call; without rounding far fewer end it."""


class Reconnection:
    """Flips the edges of one mesh where that makes it Delaunay.

    Edges on the outline, on holes and between regions never flip. Cells, cell_edges, edge_nodes and facet_cell of the
    mesh are updated in place; an edge keeps its number, so that a node at its middle follows it.

    Args:
        mesh: the mesh; nothing else may change its connectivity.
        others: (n_edges,) uint8, 1 for further edges that never flip; None: there are none.
    """

    def __init__(self, mesh: Mesh, others: np.ndarray | None = None) -> None:
        self.mesh = mesh
        self._facet_edges = edges_between(mesh.edge_nodes, mesh.facets)
        fixed = np.zeros(len(mesh.edge_nodes), dtype=np.uint8) if others is None else others.copy()
        fixed[self._facet_edges] = 1
        self._triangulation = _kernels.Triangulation(mesh.cells, mesh.cell_edges, mesh.edge_nodes, fixed)
        sides = self._triangulation.edge_cells[self._facet_edges]
        # A flip replaces a triangle in its place, so that each side of a facet stays in its column.
        self._facet_sides = (sides[:, 0] != mesh.facet_cell).astype(np.intp)

    def flip(self, X: np.ndarray, quality_floor: float = 1.0) -> tuple[int, np.ndarray]:
        """Number of flips, and the changed cells (int32, ascending).

        Args:
            X: (n, 2) node positions with no inverted triangle [m].
            quality_floor: begin at triangles of less quality, and go on from there only; 1 begins everywhere.
        """
        flips, changed = self._triangulation.flip_delaunay(X, PASSES, quality_floor)
        if flips:
            self.mesh.facet_cell[:] = self._triangulation.edge_cells[self._facet_edges, self._facet_sides]
        return flips, changed


def edges_between(edge_nodes: np.ndarray, pairs: np.ndarray) -> np.ndarray:
    """Index (m,) of the mesh edge between each pair of nodes.

    Args:
        edge_nodes: (n_edges, 2) nodes of the edges, in any order.
        pairs: (m, 2) nodes, each pair an edge of the mesh.
    """
    nodes = int(edge_nodes.max()) + 1 if len(edge_nodes) else 0
    low, high = np.sort(edge_nodes, axis=1).T.astype(np.int64)
    keys = low * nodes + high
    order = np.argsort(keys)
    low, high = np.sort(pairs, axis=1).T.astype(np.int64)
    return order[np.searchsorted(keys, low * nodes + high, sorter=order)]
