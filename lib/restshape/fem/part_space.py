"""What is looked at of a large space: few cells, or a rank's share of them, and the cells around them."""

from __future__ import annotations

import numpy as np
from petsc4py import PETSc

from restshape.algebra.factors.row_share import RowShare
from restshape.fem.entity_sets import cells_around
from restshape.fem.space import Space

LEAST_SHARED = 30_000
"""Cells below which ranks observe and estimate whole: they would save little, and wait for each other once more.

Least milliseconds of observation, residual and estimate of `plate` on two ranks of a busy machine, whole beside shared:
0.83 and 0.78 with 9,928 triangles, 1.36 and 1.32 with 20,102, 2.16 and 1.71 with 34,052, 9.8 and 8.2 with 80,083.
"""


def pays(comm: PETSc.Comm, space: Space) -> bool:
    """Whether ranks are faster when each observes its share of the cells of a space, and results are summed."""
    return comm.size > 1 and len(space.cells) >= LEAST_SHARED and space.dofs is space.cells


class CellPatch:
    """Some cells of a space, and two rings around them, with nodes that are numbered by themselves.

    The rings hold what recovery at the nodes of the cells reads: a node at a border takes the mean of the polynomials
    of nodes next to it, which take the cells around them. Nodes and cells keep their order, so that what is recovered
    at these nodes is what the whole space gives, bit for bit.

    Args:
        space: whole; its nodes may move. After flips another patch is made.
        own: the cells, ascending numbers (s,) or a slice of all.

    Attributes:
        nodes: (k,) numbers in the space; own: as it is given; share: the same cells among `cells`.
        chosen: (m,) int32 cells in the space, ascending.
        X, cells, cell_region, topology, geometry, dim, cell_type: as of a space, of this patch.
    """

    def __init__(self, space: Space, own: np.ndarray | slice) -> None:
        self.space, self.own = space, own
        self.chosen = cells_around(space, self._nodes_of(cells_around(space, self._nodes_of(own))))
        self.share = self._share(own)
        self.nodes = self._nodes_of(self.chosen)
        number = np.zeros(len(space.X), dtype=np.int32)
        number[self.nodes] = np.arange(len(self.nodes), dtype=np.int32)
        self.cells = number[space.cells[self.chosen]]
        self.cell_region = space.cell_region[self.chosen]
        self.dim, self.cell_type = space.dim, space.cell_type
        self.topology, self.geometry = space.topology, space.geometry
        self.X = space.X[self.nodes]

    def _share(self, own: np.ndarray | slice) -> np.ndarray | slice:
        """The own cells among the chosen ones."""
        if not isinstance(own, slice):
            return np.searchsorted(self.chosen, own)
        if own.stop == own.start:
            self.chosen = np.empty(0, dtype=np.int32)
        first = int(np.searchsorted(self.chosen, own.start))
        return slice(first, first + own.stop - own.start)

    @property
    def fits(self) -> bool:
        """Whether no edge has been flipped since it was made."""
        return self.topology == self.space.topology

    def follow(self) -> None:
        """Take the nodes where they are now."""
        if self.geometry != self.space.geometry:
            np.take(self.space.X, self.nodes, axis=0, out=self.X)
            self.geometry = self.space.geometry

    def of_cells(self, parameters: np.ndarray) -> np.ndarray:
        """Parameters (m, p) of its cells, from those (ne, p) of all, or (p,) the same everywhere."""
        return parameters[self.chosen] if parameters.ndim > 1 else parameters

    def _nodes_of(self, cells: np.ndarray | slice) -> np.ndarray:
        on = np.zeros(len(self.space.X), dtype=bool)
        on[self.space.cells[cells]] = True
        return np.flatnonzero(on).astype(np.int32)


class PartSpace(CellPatch):
    """A rank's share of the cells, and two rings around it. The share are consecutive cells, as many on each rank.

    Args:
        comm: PETSc communicator of the ranks.
        space: whole on each of them; its nodes may move. After flips another part is made.
    """

    own: slice
    share: slice

    def __init__(self, comm: PETSc.Comm, space: Space) -> None:
        self.sums = RowShare(comm, slice(0, 0), 0)
        count, size = len(space.cells), comm.size
        super().__init__(space, slice(count * comm.rank // size, count * (comm.rank + 1) // size))

    def summed(self, values: np.ndarray) -> np.ndarray:
        """The sum of values (k,) over the ranks, in their order; collective."""
        return self.sums.summed(values)
