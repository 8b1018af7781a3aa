"""Nodal values that are whole on every rank, and PETSc's vectors of this rank's rows of them."""

import numpy as np
from petsc4py import PETSc

from restshape.algebra.factors.gathering import gather_vector
from restshape.arrays import Reals


class NodalVectors:
    """Turns arrays (n, f) into distributed vectors and back.

    Args:
        comm: PETSc communicator.
        shape: (n, f) of the unknowns.
        rows: this rank's, of n f.
    """

    def __init__(self, comm: PETSc.Comm, shape: tuple[int, ...], rows: slice) -> None:
        self.comm, self.shape, self.rows = comm, shape, rows
        self.whole = comm.size == 1

    def vector(self) -> PETSc.Vec:
        """A new vector, all zero."""
        size = (self.rows.stop - self.rows.start, self.shape[0] * self.shape[1])
        return PETSc.Vec().createWithArray(np.zeros(size[0]), size=size, comm=self.comm)

    def values(self, vector: PETSc.Vec) -> Reals:
        """All nodal values (n, f) of a vector; on one rank they are those of the vector itself, to be read only."""
        own = vector.getArray(readonly=True)
        if self.whole:
            return own.reshape(self.shape)
        gathered = np.empty(self.shape[0] * self.shape[1])
        gathered[self.rows] = own
        return gather_vector(gathered, self.rows, self.comm).reshape(self.shape)

    def put(self, values: Reals, vector: PETSc.Vec) -> None:
        """Set a vector to this rank's rows of nodal values (n, f)."""
        vector.getArray()[:] = values.ravel()[self.rows]
        vector.stateIncrease()
