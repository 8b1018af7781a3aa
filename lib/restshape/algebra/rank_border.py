"""Unknowns without which the ranks' own ones do not couple: where a matrix is parted among ranks."""

# Few programs are of several ranks, and SciPy's sparse matrices take 0.07 s to load.

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from restshape.arrays import Flags, Integers, Reals

if TYPE_CHECKING:
    import scipy.sparse as sp


class RankBorder:
    """The border of the ranks' rows of a symmetric pattern, and what each rank has inside.

    Of two unknowns of two ranks that couple, the one with more couplings to other ranks is in the border.

    Args:
        mat: whose rows are shared; on two ranks at least; collective.

    Attributes:
        rows: (m,) all unknowns of the border, ascending.
        inside, own: places among this rank's rows of those inside, and of those in the border.
        own_places: places in `rows` of this rank's; beside: (k,) of those that its inside couples with.
    """

    def __init__(self, mat: PETSc.Mat) -> None:
        first, last = mat.getOwnershipRange()
        indptr, indices = (np.array(part) for part in mat.getRowIJ())
        size, world = mat.getSize()[0], mat.getComm().tompi4py()
        row_of = np.repeat(np.arange(last - first), np.diff(indptr))
        chosen = _cover(row_of, indices, first, last, size, world)
        self.rows = np.concatenate(world.allgather(first + np.flatnonzero(chosen)))
        self.inside, self.own = np.flatnonzero(~chosen), np.flatnonzero(chosen)
        self.own_places = np.searchsorted(self.rows, first + self.own)
        place = np.full(size, -1)
        place[self.rows] = np.arange(len(self.rows))
        of_border, other = chosen[row_of], place[indices]
        self.beside = np.unique(other[~of_border & (other >= 0)])
        self._set_local(row_of, indices, first, other, of_border)
        self._between = np.flatnonzero(of_border & (other >= 0))
        self._between_rows, self._between_columns = place[first + row_of[self._between]], other[self._between]

    def _set_local(self, row_of: Integers, indices: Integers, first: int, other: Integers, of_border: Flags) -> None:
        """Note the pattern of `local`: rows inside, with the border's columns behind, and a diagonal of the border."""
        import scipy.sparse as sp

        inside, beside = len(self.inside), len(self.beside)
        number = np.full(len(self.inside) + len(self.own), -1)
        number[self.inside] = np.arange(inside)
        taken = np.flatnonzero(~of_border)
        column, in_border = indices[taken], other[taken] >= 0
        columns = np.empty(len(taken), dtype=int)
        columns[in_border] = inside + np.searchsorted(self.beside, other[taken][in_border])
        columns[~in_border] = number[column[~in_border] - first]
        tail = np.arange(inside, inside + beside)
        rows, columns = np.r_[number[row_of[taken]], tail], np.r_[columns, tail]
        # Entry 0 is none of the matrix's.
        source = sp.csr_matrix((np.r_[taken + 1, np.zeros(beside, dtype=int)], (rows, columns)), 2 * (inside + beside,))
        source.sort_indices()
        self._source, self._pattern = source.data, (source.indices.astype(np.int32), source.indptr.astype(np.int32))
        self._size = inside + beside

    def local(self, values: Reals) -> sp.csr_matrix:
        """The rows inside of a matrix on this pattern, with columns of the border behind, whose own block is 0.

        Args:
            values: the entries of this rank's rows, as PETSc has them.
        """
        import scipy.sparse as sp

        return sp.csr_matrix((np.r_[0.0, values][self._source], *self._pattern), 2 * (self._size,))

    def between(self, values: Reals) -> tuple[Integers, Integers, Reals]:
        """Rows and columns, by places in `rows`, and entries of the border's own block in this rank's rows."""
        return self._between_rows, self._between_columns, values[self._between]


def _cover(row_of: Integers, indices: Integers, first: int, last: int, size: int, world: MPI.Comm) -> Flags:
    """Which (n,) of this rank's rows are in the border; the arguments are the entries' rows and columns."""
    cut = (indices < first) | (indices >= last)
    degree = np.bincount(row_of[cut], minlength=last - first)
    every = np.zeros(size, dtype=int)
    for rows, degrees in world.allgather((first + np.flatnonzero(degree), degree[degree > 0])):
        every[rows] = degrees
    mine, theirs = first + row_of[cut], indices[cut]
    more = (every[mine] > every[theirs]) | ((every[mine] == every[theirs]) & (mine > theirs))
    chosen = np.zeros(last - first, dtype=bool)
    chosen[row_of[cut][more]] = True
    return chosen
