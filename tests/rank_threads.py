"""Ranks that are threads: what they exchange, without processes."""

from concurrent.futures import ThreadPoolExecutor
from threading import Barrier
from types import SimpleNamespace

import numpy as np


class Ranks:
    """Threads that exchange what ranks do."""

    def __init__(self, size: int) -> None:
        self.size, self.barrier, self.given = size, Barrier(size, timeout=20), [None] * size

    def run(self, work):
        """The results of a function of a communicator, of all ranks."""
        with ThreadPoolExecutor(self.size) as pool:
            return list(pool.map(work, [self.comm(k) for k in range(self.size)]))

    def comm(self, rank: int):
        """What stands for PETSc's communicator of a rank."""
        return SimpleNamespace(rank=rank, size=self.size, tompi4py=World(self, rank))


class World:
    """What a rank knows of the others."""

    def __init__(self, ranks: Ranks, rank: int) -> None:
        self.ranks, self.rank, self.size = ranks, rank, ranks.size

    def __call__(self):
        return self

    def allgather(self, given):
        self.ranks.given[self.rank] = given
        self.ranks.barrier.wait()
        found = list(self.ranks.given)
        self.ranks.barrier.wait()
        return found

    def Allgatherv(self, given, out):
        out[0][...] = np.concatenate(self.allgather(np.array(given)))

    def gather(self, given):
        found = self.allgather(given)
        return None if self.rank else found

    def bcast(self, given):
        return self.allgather(given)[0]

    def Bcast(self, given, root):
        given[...] = self.allgather(np.array(given))[root]

    def Allgather(self, given, out):
        out[...] = np.array(self.allgather(np.array(given))).reshape(out.shape)
