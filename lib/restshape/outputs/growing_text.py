"""Texts that grow line by line: what is there is whole lines, however the process ends."""

import errno
import os
from pathlib import Path

from restshape.outputs.atomic_files import write_whole


class GrowingText:
    """A file of lines, each in it as soon as it is added.

    Args:
        path: of the file, which is replaced whole.
        text: with which it begins; it ends with a line.

    Raises:
        OSError: it cannot be written.
    """

    def __init__(self, path: Path, text: str) -> None:
        self.path = path
        write_whole(path, text)
        self._file = os.open(path, os.O_WRONLY | os.O_CLOEXEC)
        self._end = self._length = len(text.encode())

    def add(self, line: str) -> None:
        """Adds a line, given without its end: all of it, or nothing.

        Raises:
            OSError: there is no room.
        """
        self.add_for_now(line)
        self._end = self._length

    def add_for_now(self, line: str) -> None:
        """Adds a line that the next one takes the place of; errors as of `add`."""
        content = f"{line}\n".encode()
        if self._end + len(content) < self._length:
            os.ftruncate(self._file, self._end)
        if os.pwrite(self._file, content, self._end) < len(content):
            os.ftruncate(self._file, self._end)
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(self.path))
        self._length = self._end + len(content)

    def replace(self, text: str) -> None:
        """Puts another text in place of all lines; errors as of `add`, after which the lines of before are there."""
        write_whole(self.path, text)
        before, self._file = self._file, os.open(self.path, os.O_WRONLY | os.O_CLOEXEC)
        os.close(before)
        self._end = self._length = len(text.encode())

    def close(self) -> None:
        """Adds no more."""
        if self._file >= 0:
            os.close(self._file)
            self._file = -1
