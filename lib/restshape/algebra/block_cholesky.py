"""A complete factor of matrices of 3 by 3 blocks, in PETSc's symmetric block format: half the work of numbers."""

from __future__ import annotations

import numpy as np
from petsc4py import PETSc

from restshape.arrays import Indices

BLOCK = 3


class BlockCholesky:
    """The preconditioner that a complete factor of a symmetric positive definite matrix is, on one rank.

    PETSc orders and factors what is not in blocks by single numbers. Here nodes are ordered by minimum degree, once a
    pattern, and the blocks of the upper triangle copied in that order; order and symbolic factor are kept with it.

    Args:
        pc: is made one of type python with this context.

    Source: P. R. Amestoy, T. A. Davis and I. S. Duff, SIAM J. Matrix Anal. Appl. 17 (1996), 886.
    """

    def __init__(self, pc: PETSc.PC) -> None:
        self.copy: PETSc.Mat = None
        self.right: PETSc.Vec = None
        self.way: PETSc.Vec = None
        self.pattern: tuple[Indices, Indices] | None = None
        self.inner = PETSc.PC().create(PETSc.COMM_SELF)
        self.inner.setType("cholesky")
        self.inner.setFactorOrdering("natural")
        pc.setType("python")
        pc.setPythonContext(self)

    def setUp(self, pc: PETSc.PC) -> None:
        """Factor the matrix as it is now."""
        rows, columns, values = pc.getOperators()[1].getValuesCSR()
        if not self._same(rows, columns):
            self._order(rows, columns)
            self.inner.reset()
        self.copy.setValuesBlockedCSR(self.starts, self.blocks, values[self.places].ravel())
        self.copy.assemble()
        self.inner.setOperators(self.copy)
        self.inner.setUp()
        self.factor = self.inner.getFactorMatrix()

    def apply(self, pc: PETSc.PC, r: PETSc.Vec, z: PETSc.Vec) -> None:
        """Set z to the solution with right side r."""
        self.right.getArray()[:] = r.getArray(readonly=True)[self.order]
        self.right.stateIncrease()
        self.factor.solve(self.right, self.way)
        z.getArray()[self.order] = self.way.getArray(readonly=True)
        z.stateIncrease()

    def destroy(self, pc: PETSc.PC) -> None:
        """Free PETSc's objects."""
        parts = (self.copy, self.right, self.way) if self.copy else ()
        for part in (self.inner, *parts):
            part.destroy()

    def _same(self, rows: Indices, columns: Indices) -> bool:
        known = self.pattern
        return known is not None and np.array_equal(known[0], rows) and np.array_equal(known[1], columns)

    def _order(self, rows: Indices, columns: Indices) -> None:
        """Order the nodes of a pattern, and find where each block of the upper triangle is in its values."""
        n = (len(rows) - 1) // BLOCK
        # All rows of a node have the same columns, in threes.
        first, wide = rows[:-1:BLOCK], np.diff(rows)[::BLOCK] // BLOCK
        starts = np.concatenate([[0], np.cumsum(wide)])
        node = np.repeat(np.arange(n), wide)
        within = BLOCK * (np.arange(starts[-1]) - starts[node])
        other = columns[first[node] + within] // BLOCK
        graph = PETSc.Mat().createAIJ(
            (n, n), csr=(starts.astype(np.int32), other.astype(np.int32), np.ones(len(other))), comm=PETSc.COMM_SELF
        )
        sets = graph.getOrdering("amd")
        nodes = sets[0].getIndices().copy()
        place = np.empty(n, dtype=np.int64)
        place[nodes] = np.arange(n)
        upper = np.flatnonzero(place[node] <= place[other])
        sort = upper[np.lexsort((place[other[upper]], place[node[upper]]))]
        lengths = np.bincount(place[node[sort]], minlength=n)
        self.starts = np.concatenate([[0], np.cumsum(lengths)]).astype(np.int32)
        self.blocks = place[other[sort]].astype(np.int32)
        # Value (i, j) of a block is in the i-th row of its node.
        begin, length = first[node[sort]] + within[sort], BLOCK * wide[node[sort]]
        i, j = np.indices((BLOCK, BLOCK))
        self.places = begin[:, None, None] + i * length[:, None, None] + j
        self.order = (BLOCK * nodes[:, None] + np.arange(BLOCK)).ravel()
        self.pattern = rows, columns
        for part in (graph, *sets):
            part.destroy()
        self._create(n)

    def _create(self, n: int) -> None:
        """New matrix and vectors for the order that was found."""
        if self.copy:
            for part in (self.copy, self.right, self.way):
                part.destroy()
        size = BLOCK * n
        zero = np.zeros(self.places.size)
        self.copy = PETSc.Mat().createSBAIJ(
            (size, size), BLOCK, csr=(self.starts, self.blocks, zero), comm=PETSc.COMM_SELF
        )
        self.right, self.way = self.copy.createVecs()
