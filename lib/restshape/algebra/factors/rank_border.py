"""Unknowns without which the ranks' own ones do not couple: where a matrix is parted among ranks."""

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from restshape import _kernels
from restshape.arrays import Flags, Indices, Integers, Reals

Csr = tuple[Integers | Indices, Integers | Indices, Reals]
"""Starts (n + 1,), columns (k,) and entries (k,) of a sequential matrix by rows."""


class RankBorder:
    """The border of the ranks' rows of a symmetric pattern, and what each rank has inside.

    Of two unknowns of two ranks that couple, the one with more couplings to other ranks is in the border.

    Args:
        mat: whose rows are shared; on two ranks at least; collective.

    Attributes:
        rows: (m,) all unknowns of the border, ascending.
        inside, own: places among this rank's rows of those inside, and of those in the border.
        own_places: places in `rows` of this rank's; beside: (k,) of those that its inside couples with.
        number: of each column of this rank's rows, own ones and then those of others, its place in `inside`, or behind
            these in `beside`; -1: none.
    """

    def __init__(self, mat: PETSc.Mat) -> None:
        first, last = mat.getOwnershipRange()
        world, count = mat.getComm().tompi4py(), last - first
        rows, columns, others = _kernels.couplings_of_ranks(mat.handle)
        chosen = _cover(rows, columns, first, count, mat.getSize()[0], world)
        self.rows = np.concatenate(world.allgather(first + np.flatnonzero(chosen)))
        self.inside, self.own = np.flatnonzero(~chosen), np.flatnonzero(chosen)
        self.own_places = np.searchsorted(self.rows, first + self.own)
        place = np.full(count + len(others), -1, dtype=PETSc.IntType)
        place[self.own] = self.own_places
        found = np.flatnonzero(np.isin(others, self.rows))
        place[count + found] = np.searchsorted(self.rows, others[found])
        in_border = np.flatnonzero((place >= 0) & (_kernels.met_by_inside(mat.handle, place) > 0))
        self.beside = np.unique(place[in_border])
        self.number = np.full(len(place), -1, dtype=PETSc.IntType)
        self.number[self.inside] = np.arange(len(self.inside))
        self.number[in_border] = len(self.inside) + np.searchsorted(self.beside, place[in_border])
        self._between = _kernels.between_ranks(mat.handle, place)
        self._local: tuple[Indices, Indices, Indices] | None = None

    def local(self, mat: PETSc.Mat) -> Csr:
        """The rows inside of a matrix on this pattern, with columns of the border behind, whose own block is 0."""
        if self._local is None:
            counts = len(self.inside), len(self.beside)
            self._local = _kernels.bordered_pattern(mat.handle, self.number, *counts)
        starts, columns, entries = self._local
        return starts, columns, _taken(mat, entries)

    def between(self, mat: PETSc.Mat) -> tuple[Integers, Integers, Reals]:
        """Rows and columns, by places in `rows`, and entries of the border's own block in this rank's rows."""
        rows, columns, entries = self._between
        return rows, columns, _taken(mat, entries)


def _taken(mat: PETSc.Mat, entries: Indices) -> Reals:
    """Entries (k,) of this rank's rows of a matrix, by their numbers."""
    values = np.empty(len(entries))
    _kernels.take_entries(mat.handle, entries, values)
    return values


def _cover(rows: Integers, columns: Integers, first: int, count: int, size: int, world: MPI.Comm) -> Flags:
    """Which (count,) of this rank's rows are in the border.

    Args:
        rows: (k,) of the entries in columns of other ranks, by their places among this rank's; columns: theirs (k,).
        first: of this rank's rows; size: rows of all ranks; world: the ranks.
    """
    degree = np.bincount(rows, minlength=count)
    every = np.zeros(size, dtype=np.int32)
    coupled = np.flatnonzero(degree)
    for others, degrees in world.allgather((first + coupled, degree[coupled])):
        every[others] = degrees
    mine, theirs = first + rows, columns
    more = (every[mine] > every[theirs]) | ((every[mine] == every[theirs]) & (mine > theirs))
    chosen = np.zeros(count, dtype=bool)
    chosen[rows[more]] = True
    return chosen
