"""Writes that reach a file together or not at all, however the process ends that makes them.

HDF5 overwrites its metadata in place, some tens of writes a flush; a process that is killed between two of them leaves
a file that HDF5 cannot read, or reads wrongly. So they wait in memory, are written behind the end of what HDF5 uses as
one journal, and only then to their places. A whole journal whose writes were not all made is completed by a reader.

Source: write-ahead logging with redo, J. Gray and A. Reuter, Transaction Processing (1993), chapter 9.
"""

import errno
import fcntl
import os
import struct
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO, NamedTuple

_MARK = b"rs-redo1"
_FOOTER = struct.Struct("<8sQI4x")
"""At the very end of the file: mark, bytes of the entries before it, their CRC-32."""
_ENTRY = struct.Struct("<QQ")
"""Before the bytes of each write: their place in the file, and how many they are."""


class Write(NamedTuple):
    """Bytes for a place of a file."""

    start: int
    data: bytes | memoryview


class Unfinished(OSError):
    """A file has writes to be made, and may not be written."""


class JournaledFile:
    """A file object for HDF5 that keeps what is written outside of `direct` in memory, until `settle`.

    Args:
        descriptor: of a file open for reading and writing, which stays open.

    Attributes:
        end: bytes that HDF5 uses, as of its last flush.
        settling: writes are on their way to their places; whoever truncates the file now takes the journal away.
    """

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._pending: list[Write] = []
        self._directly = False
        self._position = 0
        self.end = 0
        self.settling = False

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """The new position."""
        if whence == os.SEEK_END:
            offset += self._size()
        elif whence == os.SEEK_CUR:
            offset += self._position
        self._position = offset
        return self._position

    def tell(self) -> int:
        """The position."""
        return self._position

    def read(self, count: int) -> bytes:
        """The next bytes, as HDF5 has written them."""
        buffer = bytearray(count)
        return bytes(buffer[: self.readinto(buffer)])

    def readinto(self, buffer: bytearray | memoryview) -> int:
        """Fills the buffer as far as the file goes; returns how far."""
        view, start = memoryview(buffer).cast("B"), self._position
        got = max(min(self._size() - start, len(view)), 0)
        found = os.pread(self._descriptor, got, start)
        view[: len(found)] = found
        for write in self._pending:
            first, last = max(write.start, start), min(write.start + len(write.data), start + got)
            if first < last:
                view[first - start : last - start] = write.data[first - write.start : last - write.start]
        self._position += got
        return got

    def write(self, data: bytes | memoryview) -> int:
        """Takes bytes for the position."""
        count = len(data)
        if self._directly:
            _put(self._descriptor, Write(self._position, data))
        else:
            self._pending.append(Write(self._position, bytes(data)))
        self._position += count
        return count

    def truncate(self, size: int) -> int:
        """Takes note of how much HDF5 uses; room behind it stays."""
        self.end = size
        return size

    def flush(self) -> None:
        """Does nothing: see `settle`."""

    @contextmanager
    def direct(self) -> Iterator[None]:
        """Within it, bytes are written at once: those that no metadata in the file speaks of yet."""
        self._directly = True
        try:
            yield
        finally:
            self._directly = False

    def settle(self) -> None:
        """Makes all writes that wait, together or not at all.

        Raises:
            OSError: no room for the journal: the file is as it was, and the writes still wait.
        """
        if not self._pending:
            return
        journal = b"".join(_ENTRY.pack(write.start, len(write.data)) + write.data for write in self._pending)
        footer = _FOOTER.pack(_MARK, len(journal), zlib.crc32(journal))
        used = max(self.end, *(write.start + len(write.data) for write in self._pending))
        size, need = os.fstat(self._descriptor).st_size, used + len(journal) + len(footer)
        if need > size:
            os.posix_fallocate(self._descriptor, size, need - size)
        start = max(size, need) - len(journal) - len(footer)
        _put(self._descriptor, Write(start, journal + footer))
        self.settling = True
        _finish(self._descriptor, self._pending, start + len(journal))
        self.settling = False
        self._pending = []

    def _size(self) -> int:
        reach = max((write.start + len(write.data) for write in self._pending), default=0)
        return max(os.fstat(self._descriptor).st_size, reach)


def lock(descriptor: int) -> None:
    """Keeps readers away from a file that is being written, as HDF5 does for files that it opens itself.

    Raises:
        BlockingIOError: another process reads or writes it.
    """
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        # A file system without locks.
        if error.errno not in (errno.ENOLCK, errno.EOPNOTSUPP, errno.ENOSYS):
            raise


def finish_journal(path: Path) -> None:
    """Makes the writes of a file that its writer was killed between, if there are any.

    Raises:
        BlockingIOError: its writer lives.
        Unfinished: there are some, and the file may not be written.
        OSError: it cannot be read or written.
    """
    with path.open("rb") as file:
        if _journal_in(file) is None:
            return
    try:
        opened = path.open("r+b")
    except OSError as error:
        raise Unfinished(error.errno, error.strerror, str(path)) from error
    with opened:
        lock(opened.fileno())
        if (found := _journal_in(opened)) is not None:
            _finish(opened.fileno(), found.writes, found.footer)


class _Journal(NamedTuple):
    writes: list[Write]
    footer: int


def _journal_in(file: BinaryIO) -> _Journal | None:
    """The journal of a file and where its footer is; None without a whole one."""
    place = os.fstat(file.fileno()).st_size - _FOOTER.size
    if place < 0:
        return None
    mark, length, code = _FOOTER.unpack(os.pread(file.fileno(), _FOOTER.size, place))
    start = place - length
    if mark != _MARK or start < 0:
        return None
    journal = os.pread(file.fileno(), length, start)
    if len(journal) != length or zlib.crc32(journal) != code:
        return None
    writes, at = [], 0
    while at + _ENTRY.size <= length:
        first, count = _ENTRY.unpack_from(journal, at)
        at += _ENTRY.size
        writes.append(Write(first, journal[at : at + count]))
        at += count
        if at > length or first + count > start:
            return None
    return _Journal(writes, place) if at == length else None


def _finish(descriptor: int, writes: list[Write], footer: int) -> None:
    for write in writes:
        _put(descriptor, write)
    _put(descriptor, Write(footer, bytes(_FOOTER.size)))


def _put(descriptor: int, write: Write) -> None:
    data, start = memoryview(write.data).cast("B"), write.start
    while data:
        count = os.pwrite(descriptor, data, start)
        data, start = data[count:], start + count
