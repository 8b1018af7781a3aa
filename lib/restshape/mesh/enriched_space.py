"""The next richer space over a mesh, and how fields of a space come to it: what a discretisation leaves out."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.mesh.mesh import Mesh
from restshape.mesh.nested import NestedMesh
from restshape.mesh.quadratic_basis import quadratic_basis

if TYPE_CHECKING:
    import scipy.sparse as sp

# Reference coordinates of the corners of the four parts of a triangle, in the order of `NestedMesh`.
PARTS = 0.5 * np.array(
    [[[0, 0], [1, 0], [0, 1]], [[1, 0], [2, 0], [1, 1]], [[0, 1], [1, 1], [0, 2]], [[1, 1], [0, 1], [1, 0]]]
)


class EnrichedSpace:
    """Second-order nodes over a first-order mesh, or, over a space of second order, over its triangles in four.

    Curved sides of first order become curves; those of second order are met closer. Over these, nodes within the body
    are where the triangles of the space have them, which curved sides bend: fields come over as they are.

    Args:
        space: whose nodes may move; edges may not flip.

    Attributes:
        space: the richer one.
        prolongation: (m, n) sparse, from values at the nodes of the one to those of the other.
    """

    def __init__(self, space: Mesh | LagrangeSpace) -> None:
        self._nested: NestedMesh | None = None
        self._coarse = space
        if space is not space.mesh:
            self._nested = NestedMesh(space.mesh, 2)
            self.space = LagrangeSpace(self._nested.finest)
            self.prolongation = _from_second_order(space, self.space)
            self._inner = np.setdiff1d(self.space.side_number, self.space.facets[:, 2])
            self._own_places = self.prolongation[self._inner]
            self._bend_within()
        else:
            self.space = LagrangeSpace(space.mesh)
            self.prolongation = _from_first_order(space.mesh, self.space)

    def follow(self) -> None:
        """Go where the nodes of the space are, which have moved."""
        if self._nested is not None:
            self._nested.follow()
        self.space.bend(self.space.mesh.outline)
        self.space.place()
        self._bend_within()

    def _bend_within(self) -> None:
        """Put the middles of sides within the body where the triangles of a space of second order have them."""
        if self._nested is not None:
            self.space.X[self._inner] = self._own_places @ self._coarse.X

    def cells_in(self, cells: np.ndarray | slice) -> np.ndarray | slice:
        """Cells of the richer space inside some (k,) of the space, or all of them for a slice of all."""
        return cells if self._nested is None or isinstance(cells, slice) else self._nested.cells_in(cells)

    def prolonged(self, field: np.ndarray) -> np.ndarray:
        """A field (n, f) of the space at the nodes (m, f) of the richer one."""
        return self.prolongation @ field


def _from_first_order(mesh: Mesh, space: LagrangeSpace) -> sp.csr_matrix:
    import scipy.sparse as sp

    corners, sides = np.arange(len(mesh.X)), mesh.edge_nodes
    rows = np.concatenate([space.corner_number, np.repeat(space.side_number, 2)])
    values = np.concatenate([np.ones(len(corners)), np.full(sides.size, 0.5)])
    return sp.csr_matrix((values, (rows, np.concatenate([corners, sides.ravel()]))), (len(space.X), len(corners)))


def _from_second_order(coarse: Mesh | LagrangeSpace, fine: LagrangeSpace) -> sp.csr_matrix:
    import scipy.sparse as sp

    cells = fine.cells.reshape(-1, 4, 6)
    points = np.concatenate([PARTS, 0.5 * (PARTS + PARTS[:, [1, 2, 0]])], axis=1)
    basis = np.stack([quadratic_basis(own)[0] for own in points])
    # Each node from the first of the parts that have it.
    nodes, first = np.unique(cells, return_index=True)
    values = np.broadcast_to(basis, (len(cells), 4, 6, 6)).reshape(-1, 6)[first]
    columns = coarse.cells[first // 24]
    rows = np.repeat(nodes, 6)
    return sp.csr_matrix((values.ravel(), (rows, columns.ravel())), (len(fine.X), len(coarse.X)))
