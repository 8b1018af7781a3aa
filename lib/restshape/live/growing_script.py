"""The script of a live session as a file, which grows with it."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from restshape.errors import UserError
from restshape.outputs.growing_text import GrowingText


class GrowingScript:
    """A file with the lines of the events that were carried out; it is there from the first call of `begin` on.

    Args:
        path: of the file; None: nothing is written.

    Attributes:
        count: of events that it holds, or would hold.
    """

    def __init__(self, path: Path | None) -> None:
        self._path, self.count = path, 0
        self._file: GrowingText | None = None
        self._beginning: str | None = None
        self._waiting: list[str] = []

    @property
    def name(self) -> str:
        """What people call it; empty where nothing is written."""
        return str(self._path or "")

    @property
    def lacks_lines(self) -> bool:
        """Whether something could not be written so far."""
        return self._beginning is not None or bool(self._waiting)

    def begin(self, header: str, lines: Sequence[str] = ()) -> None:
        """Puts a header and lines of events in place of what the file holds.

        Raises:
            UserError: it cannot be written; what is missing is written with what comes next, if that can be.
        """
        self.count = len(lines)
        self._beginning, self._waiting = "".join(f"{line}\n" for line in (header, *lines)), []
        self.write("name another file")

    def add(self, line: str) -> None:
        """Adds an event; errors as of `begin`."""
        self.count += 1
        if self._path is not None:
            self._waiting.append(line)
            self.write()

    def write(self, remedy: str = "make room on the disk") -> None:
        """Writes what could not be written before; errors as of `begin`."""
        if self._path is None:
            self._beginning, self._waiting = None, []
            return
        try:
            if self._beginning is not None:
                if self._file is None:
                    self._file = GrowingText(self._path, self._beginning)
                else:
                    self._file.replace(self._beginning)
                self._beginning = None
            while self._waiting and self._file is not None:
                self._file.add(self._waiting[0])
                self._waiting.pop(0)
        except OSError as error:
            what = f"it cannot be written: {(error.strerror or str(error)).lower()}"
            raise UserError(what, f"--out {self._path}", remedy) from error

    def add_for_now(self, line: str) -> None:
        """Adds an event that has not ended, as it is so far: the next one takes its place; nothing without room."""
        if self._file is not None and self._beginning is None and not self._waiting:
            with suppress(OSError):
                self._file.add_for_now(line)

    def close(self) -> None:
        """Adds no more."""
        if self._file is not None:
            self._file.close()
