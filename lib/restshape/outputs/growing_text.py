"""Texts that grow line by line: what is there is whole lines, however the process ends."""

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
        self._end = self._last = len(text.encode())

    def add(self, line: str) -> None:
        """Adds a line, given without its end."""
        content = f"{line}\n".encode()
        os.pwrite(self._file, content, self._end)
        self._last, self._end = self._end, self._end + len(content)

    def replace_last(self, line: str) -> None:
        """Puts a line in place of the one that was added last."""
        content, before = f"{line}\n".encode(), self._end
        os.pwrite(self._file, content, self._last)
        self._end = self._last + len(content)
        if self._end < before:
            os.ftruncate(self._file, self._end)

    def replace(self, text: str) -> None:
        """Puts another text in place of all lines."""
        os.close(self._file)
        self._file = -1
        write_whole(self.path, text)
        self._file = os.open(self.path, os.O_WRONLY | os.O_CLOEXEC)
        self._end = self._last = len(text.encode())

    def close(self) -> None:
        """Adds no more."""
        if self._file >= 0:
            os.close(self._file)
            self._file = -1
