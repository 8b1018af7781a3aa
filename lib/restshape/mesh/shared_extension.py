"""Harmonic maps on ranks: each eliminates the inside of its part of the mesh, the first one solves for their border."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from petsc4py import PETSc

from restshape import _kernels
from restshape.mesh.relocate import Extension, Harmonic, HarmonicExtension

if TYPE_CHECKING:
    from mpi4py import MPI

    from restshape.mesh.mesh import Mesh

LEAST_CELLS = 20_000
"""Cells below which each rank makes the map whole: there the border and messages cost as much as is saved.

Work of the map of `plate` on two ranks, waiting left out, over that of the whole: 0.99 with 18,920 triangles, 0.56 with
134,821, 0.59 with 303,747.
"""
MOST_BORDER = 4_000
"""Nodes between ranks whose dense factor, of 128 MB, the first rank is asked for; with more, maps are made whole."""
NO_AREA = "the mesh has a triangle without area"


class MeshPart:
    """The cells of a rank, those whose smallest node it owns, and what of their nodes others have too.

    Args:
        mesh: whole on each rank, its nodes numbered by ranks.
        nodes: (nb,) boundary nodes, int32.
        rank: of this part.

    Attributes:
        own: (k,) nodes of the part; cells: (m, 3) by their numbers there, until an extension is made of it.
        given: (j,) which boundary nodes are among them, by their rows; given_nodes: (j,) int32 their numbers there.
        border: (b,) all free nodes of several parts, ascending; places: (c,) those of this part among them;
            border_nodes: (c,) int32 their numbers there.
        first: (n,) the first rank that has each node.
    """

    def __init__(self, mesh: Mesh, nodes: np.ndarray, rank: int) -> None:
        n, ranks = len(mesh.X), len(mesh.node_offsets) - 1
        of_cell = np.searchsorted(mesh.node_offsets, mesh.cells.min(axis=1), side="right") - 1
        self.first, parts = np.full(n, ranks, dtype=np.int32), np.zeros(n, dtype=np.int32)
        for k in reversed(range(ranks)):
            on = np.zeros(n, dtype=bool)
            on[mesh.cells[of_cell == k]] = True
            self.first[on] = k
            parts += on
            if k == rank:
                self.own = np.flatnonzero(on)
        free = np.ones(n, dtype=bool)
        free[nodes] = False
        self.border = np.flatnonzero(free & (parts > 1))
        number = np.full(n, -1, dtype=np.int32)
        number[self.own] = np.arange(len(self.own), dtype=np.int32)
        self.cells = number[mesh.cells[of_cell == rank]]
        self.given = np.flatnonzero(number[nodes] >= 0)
        self.given_nodes = number[nodes[self.given]]
        self.places = np.flatnonzero(number[self.border] >= 0)
        self.border_nodes = number[self.border[self.places]]


class SharedHarmonicExtension:
    """Solves Laplace's equation on the mesh as it lies, as `HarmonicExtension`, on ranks together; collective.

    Substructuring: the insides of the parts do not couple, so that the Schur complement of their border is the sum of
    what each of them leaves there, in the order of the ranks.

    Args:
        world: the ranks; mesh: whole on each of them; part: of this one.

    Source: J. S. Przemieniecki, AIAA J. 1 (1963) 138.
    """

    def __init__(self, world: MPI.Intracomm, mesh: Mesh, part: MeshPart) -> None:
        self.world, self.part, self._size = world, part, len(mesh.X)
        self._kernel: _kernels.HarmonicExtension
        self._factor: PETSc.Mat | None = None

        def begin() -> None:
            X = np.ascontiguousarray(mesh.X[part.own])
            self._kernel = _kernels.HarmonicExtension(X, part.cells, part.given_nodes, part.border_nodes)
            # The kernel has a copy.
            del part.cells

        self._together(begin)

    def __call__(self, values: np.ndarray) -> np.ndarray:
        """Values (n, k) at all nodes from values (nb, k) at the boundary nodes."""
        return self._gather(self._solve(values))

    def adapted(self, values: np.ndarray) -> np.ndarray:
        """The same, adapted to values (nb, k) as by `HarmonicExtension.adapted`."""
        largest = max(self.world.allgather(self._kernel.weigh(self._solve(values))))
        self._together(lambda: self._kernel.stiffen(largest))
        own = self._solve(values)
        # What is gathered takes the place of the factor.
        del self._kernel
        return self._gather(own)

    def _gather(self, own: np.ndarray) -> np.ndarray:
        """Values (n, k) at all nodes from those (m, k) of the ranks' parts."""
        world, first = self.world, self.part.first
        found = np.empty((self._size, own.shape[1]))
        # One part after the other: copies of all of them would be most of what is held here.
        for rank in range(world.size):
            rows = np.flatnonzero(first == rank)
            part = np.empty((len(rows), own.shape[1]))
            if rank == world.rank:
                part[:] = own[first[self.part.own] == rank]
            world.Bcast(part, rank)
            found[rows] = part
        return found

    def _together(self, make: Callable[[], None]) -> None:
        """Have each rank make a factor of its inside, and the first one that of the border.

        Raises:
            RuntimeError: one of them has none.
        """
        try:
            make()
            left = self._kernel.complement()
        except RuntimeError:
            left = None
        parts, failed = self.world.gather((self.part.places, left)), False
        if parts is not None:
            failed = any(part is None for _, part in parts)
            if not failed:
                failed = not self._factor_border(parts)
        if self.world.bcast(failed):
            raise RuntimeError(NO_AREA)

    def _factor_border(self, parts: list[tuple[np.ndarray, np.ndarray]]) -> bool:
        """Factor the sum of what the ranks leave, on the first one; whether there is a factor."""
        complement = np.zeros(2 * (len(self.part.border),))
        for places, left in parts:
            complement[np.ix_(places, places)] += left
        if not len(complement):
            return True
        # LAPACK makes a factor of numbers that are none, too.
        if not np.isfinite(np.diagonal(complement)).all():
            return False
        self._factor = PETSc.Mat().createDense(complement.shape, array=complement, comm=PETSc.COMM_SELF)
        self._factor.setOption(PETSc.Mat.Option.SPD, True)
        try:
            self._factor.factorCholesky(PETSc.IS().createStride(len(complement), comm=PETSc.COMM_SELF))
        except PETSc.Error:
            return False
        return True

    def _at_border(self, loads: np.ndarray) -> np.ndarray:
        """Values (m, k) at the border from loads (m, k) of all parts, on the rank that has its factor."""
        if self._factor is None:
            return loads
        found, (b, x) = np.empty_like(loads), self._factor.createVecs()
        for k in range(loads.shape[1]):
            b.setArray(loads[:, k])
            self._factor.solve(b, x)
            found[:, k] = x.getArray(readonly=True)
        return found

    def _solve(self, values: np.ndarray) -> np.ndarray:
        """Values (m, k) at the nodes of this rank's part."""
        part = self.part
        given = np.ascontiguousarray(values[part.given])
        loads = self.world.gather((part.places, self._kernel.reduce(given)))
        found = None
        if loads is not None:
            found = np.zeros((len(part.border), values.shape[1]))
            for places, load in loads:
                found[places] += load
            found = self._at_border(found)
        at_border = self.world.bcast(found)
        return self._kernel.complete(given, np.ascontiguousarray(at_border[part.places]))


def harmonic_on(world: MPI.Intracomm) -> Harmonic:
    """What makes harmonic extensions of a mesh and its boundary nodes on ranks: shared where that is worth it."""

    def harmonic(mesh: Mesh, nodes: np.ndarray) -> Extension:
        if len(mesh.cells) < LEAST_CELLS:
            return HarmonicExtension(mesh, nodes)
        part = MeshPart(mesh, nodes, world.rank)
        if len(part.border) > MOST_BORDER:
            return HarmonicExtension(mesh, nodes)
        return SharedHarmonicExtension(world, mesh, part)

    return harmonic
