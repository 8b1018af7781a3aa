"""A ring of records in memory that two processes share: one writes, the other reads.

The memory is an anonymous file (``memfd``): its first page holds counters that the reader writes (`TAIL`, `SAFE`,
`FAILED`), the rest holds records. A record is a 32-byte head (kind, payload length, two floats) and its payload,
contiguous and aligned to 32 bytes. Positions count bytes since the start and never wrap; the writer publishes its
position through a pipe, whose locking in the kernel also orders the memory writes before it.
"""

import mmap
import os
import struct
from collections.abc import Iterator
from typing import NamedTuple

PAGE = 4096
HEAD = struct.Struct("<IxxxxQdd")
TAIL, SAFE, FAILED = 0, 1, 2
WRAP, HEADER, NOTE, TOPOLOGY, LAYOUT, FRAME, CLOSE = range(7)


class Record(NamedTuple):
    """One record as the reader sees it; ``payload`` is valid until the reader releases it."""

    kind: int
    payload: memoryview
    a: float
    b: float


def _aligned(size: int) -> int:
    return (size + 31) & ~31


class Ring:
    """One end of the ring.

    Args:
        fd: the shared file, its size already set.
    """

    def __init__(self, fd: int) -> None:
        self.fd = fd
        self.position = 0
        self._map()

    @classmethod
    def create(cls, capacity: int) -> "Ring":
        """A new ring, its memory reserved: a full machine is an error here and not a crash later.

        Raises:
            OSError: there is not enough memory.
        """
        fd = os.memfd_create("restshape-recorder")
        os.posix_fallocate(fd, 0, PAGE + _aligned(capacity))
        return cls(fd)

    def _map(self) -> None:
        size = os.fstat(self.fd).st_size
        memory = mmap.mmap(self.fd, size, flags=mmap.MAP_SHARED | mmap.MAP_POPULATE)
        self.memory = memoryview(memory)
        self.counters = self.memory[:PAGE].cast("q")
        self.capacity = size - PAGE

    def grow(self, capacity: int) -> None:
        """Enlarges the memory; only while the reader has released everything."""
        os.posix_fallocate(self.fd, 0, PAGE + _aligned(capacity))
        self._map()

    def follow(self) -> None:
        """Remaps the memory where the other end has enlarged it."""
        if os.fstat(self.fd).st_size != self.capacity + PAGE:
            self._map()

    def begin(self, kind: int, length: int, a: float = 0.0, b: float = 0.0) -> int | None:
        """The place of a new record's payload in ``memory``, or None while the ring is full.

        The record exists for the reader once `commit` has been called and the position published.
        """
        need = _aligned(HEAD.size + length)
        at = self.position % self.capacity
        skip = self.capacity - at if at + need > self.capacity else 0
        if self.position + skip + need - self.counters[TAIL] > self.capacity:
            return None
        if skip:
            HEAD.pack_into(self.memory, PAGE + at, WRAP, skip - HEAD.size, 0.0, 0.0)
            at = 0
        HEAD.pack_into(self.memory, PAGE + at, kind, length, a, b)
        self._next = self.position + skip + need
        return PAGE + at + HEAD.size

    def commit(self) -> int:
        """The position after the record that `begin` placed: to be published."""
        self.position = self._next
        return self.position

    def records(self, end: int) -> Iterator[Record]:
        """The records between the reader's position and ``end``; the position moves with them."""
        while self.position < end:
            at = PAGE + self.position % self.capacity
            kind, length, a, b = HEAD.unpack_from(self.memory, at)
            self.position += _aligned(HEAD.size + length)
            if kind != WRAP:
                yield Record(kind, self.memory[at + HEAD.size : at + HEAD.size + length], a, b)

    def release(self) -> None:
        """Gives back everything that has been read."""
        self.counters[TAIL] = self.position
