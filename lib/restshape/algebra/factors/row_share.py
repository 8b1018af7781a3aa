"""What a rank has of vectors that ranks share: the unknowns that it owns, and sums over all ranks."""

import numpy as np
from petsc4py import PETSc

from restshape.algebra.row_products import row_products
from restshape.arrays import Reals


class RowShare:
    """The unknowns of this rank among all: the columns that it has of rows (k, n).

    Sums are of the ranks in their order, so that their bits repeat, and are the same on each of them.

    Args:
        comm: PETSc communicator.
        unknowns: this rank's.
        size: how many unknowns there are on all ranks.
    """

    def __init__(self, comm: PETSc.Comm, unknowns: slice, size: int) -> None:
        self.comm, self.unknowns, self.size = comm, unknowns, size
        self.alone = comm.size == 1
        self._world = None if self.alone else comm.tompi4py()

    @classmethod
    def of(cls, mat: PETSc.Mat) -> "RowShare":
        """That of a square matrix."""
        return cls(mat.getComm(), slice(*mat.getOwnershipRange()), mat.getSize()[0])

    @property
    def count(self) -> int:
        """How many unknowns this rank owns."""
        return self.unknowns.stop - self.unknowns.start

    def own(self, rows: Reals) -> Reals:
        """This rank's columns of rows (k, n) that it has whole; on one rank the rows themselves."""
        return rows if self.alone else np.ascontiguousarray(rows[:, self.unknowns])

    def whole(self, rows: Reals) -> Reals:
        """Rows (k, n) of which each rank has its own columns; collective, on one rank the rows themselves."""
        if self._world is None:
            return rows
        counts = [len(rows) * count for count in self._world.allgather(self.count)]
        flat = np.empty(len(rows) * self.size)
        self._world.Allgatherv(np.ascontiguousarray(rows), [flat, counts])
        if not len(rows):
            return flat.reshape(0, self.size)
        parts = np.split(flat, np.cumsum(counts)[:-1])
        return np.concatenate([part.reshape(len(rows), -1) for part in parts], axis=1)

    def summed(self, part: Reals | np.float64) -> Reals:
        """The sum of an array, or of a number, over the ranks; collective."""
        if self._world is None:
            return np.asarray(part)
        parts = np.empty((self.comm.size, *part.shape))
        self._world.Allgather(np.ascontiguousarray(part), parts)
        return parts.sum(axis=0)

    def products(self, a: Reals, b: Reals) -> Reals:
        """The scalar products (k, m) of rows a (k, n) with rows b (m, n), of which each rank has its columns."""
        return self.summed(row_products(a, b))

    def squares(self, a: Reals, b: Reals) -> Reals:
        """The scalar products (k,) of rows a (k, n) with those of b (k, n) at the same place."""
        return self.summed(np.einsum("ki,ki->k", a, b))

    def norms(self, rows: Reals) -> Reals:
        """The norms (k,) of rows (k, n)."""
        return np.linalg.norm(rows, axis=1) if self.alone else np.sqrt(self.squares(rows, rows))
