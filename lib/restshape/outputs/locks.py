"""A lock on a recording that is being written: held by the process that writes, gone with it however it ends."""

import errno
import fcntl
import os
from contextlib import suppress
from pathlib import Path

from restshape.outputs.atomic_files import LONGEST

WORDS = b"restshape writes a recording\n"
"""Content of a lock's file."""


class Locked(OSError):
    """Another process writes this recording."""


class Lock:
    """The lock of a path: a file NAME.lock, locked by the system, so that one that a killed process left is free.

    Args:
        path: of the recording.

    Raises:
        Locked: another process holds it.
        OSError: the file cannot be made, or is not a lock.
    """

    def __init__(self, path: Path) -> None:
        short = os.fsencode(path.name)[: LONGEST - len(".lock")].decode(errors="ignore")
        self.path = path.with_name(f"{short}.lock")
        while True:
            self._file = os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC, 0o644)
            try:
                self._take()
            except OSError:
                os.close(self._file)
                raise
            if self._is_there():
                os.pwrite(self._file, WORDS, 0)
                return
            # The last holder removed it between our two steps.
            os.close(self._file)

    def _take(self) -> None:
        if os.pread(self._file, len(WORDS) + 1, 0) not in (b"", WORDS):
            raise FileExistsError(errno.EEXIST, "this file is there, and is no lock", str(self.path))
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise Locked(error.errno, "another run is writing this recording", str(self.path)) from error
        except OSError as error:
            # A file system without locks.
            if error.errno not in (errno.ENOLCK, errno.EOPNOTSUPP, errno.ENOSYS):
                raise

    def _is_there(self) -> bool:
        try:
            found = os.stat(self.path, follow_symlinks=False)
        except FileNotFoundError:
            return False
        mine = os.fstat(self._file)
        return (found.st_dev, found.st_ino) == (mine.st_dev, mine.st_ino)

    def release(self) -> None:
        """Removes the lock's file, and lets go of it."""
        with suppress(OSError):
            if self._is_there():
                self.path.unlink()
        os.close(self._file)
