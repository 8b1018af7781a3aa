"""The start of the process that writes a recording: as a copy of this one where that is safe, else a new Python."""

from __future__ import annotations

import errno
import gc
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import NamedTuple

from restshape.errors import UserError
from restshape.replay.recording.ring import Ring

NAME = "recorder"
"""Of a process that is a copy."""
RING_BYTES = 32 << 20
MPI_VARIABLES = ("OMPI_", "PMIX_", "PMI_", "PRTE_", "HYDRA_", "MPI_LOCAL")
LIBRARIES = ("restshape._kernels", "petsc4py.PETSc", "mpi4py.MPI", "h5py", "gmsh")
"""With one of these a process is copied no more: PETSc's and gmsh's own HDF5, MPI and threads would be in the copy."""
MODULE = "restshape.replay.recording.recorder_process"


class Begun(NamedTuple):
    """A process that waits for a recording to write: its shared memory, and pipes for commands, control and answers."""

    ring: Ring
    process: Copy | subprocess.Popen[bytes]
    pipes: tuple[int, int, int]

    def abandon(self) -> None:
        """Let the process end that has nothing to write."""
        for fd in (*self.pipes, self.ring.fd):
            os.close(fd)
        self.process.wait()


class Copy:
    """A process that is a copy of this one: what `Recorder` needs of `subprocess.Popen`.

    Attributes:
        pid: its process number.
        returncode: its exit code, once it has been waited for.
    """

    def __init__(self, pid: int) -> None:
        self.pid = pid
        self.returncode: int | None = None

    def poll(self) -> int | None:
        """Its exit code, or None while it runs."""
        return self._waited(os.WNOHANG)

    def wait(self) -> int | None:
        """Its exit code, once it has ended."""
        return self._waited(0)

    def _waited(self, options: int) -> int | None:
        if self.returncode is None:
            try:
                pid, status = os.waitpid(self.pid, options)
            except ChildProcessError:
                pid, status = self.pid, 0
            if pid:
                self.returncode = os.waitstatus_to_exitcode(status)
        return self.returncode


def begun(capacity: int = RING_BYTES) -> Begun:
    """A process that is to write a recording: begin it before MPI, and early, for what is loaded by then is copied.

    Args:
        capacity: bytes of the memory that is shared with it.

    Raises:
        UserError: there is no memory for it.
    """
    try:
        ring = Ring.create(capacity)
    except OSError as error:
        # The memory is a file without a place, to which the limit of file sizes applies.
        do = "raise the limit of file sizes: ulimit -f" if error.errno == errno.EFBIG else "close other programs"
        raise UserError(f"no memory for the recorder ({error.strerror})", do=do) from error
    inputs, control, answers = os.pipe(), os.pipe(), os.pipe()
    theirs = (ring.fd, inputs[0], control[0], answers[1])
    environment = {key: value for key, value in os.environ.items() if not key.startswith(MPI_VARIABLES)}
    process = _started(theirs, ",".join(map(str, sorted(_cores()))), environment)
    for fd in theirs[1:]:
        os.close(fd)
    return Begun(ring, process, (inputs[1], control[1], answers[0]))


def _cores() -> set[int]:
    """The cores for the recorder process: those of this process, or of the launcher that has bound this one to some."""
    own = os.sched_getaffinity(0)
    if any(name.startswith(MPI_VARIABLES) for name in os.environ if name.endswith("_RANK")):
        with suppress(OSError):
            return own | os.sched_getaffinity(os.getppid())
    return own


def _started(theirs: Sequence[int], cores: str, environment: Mapping[str, str]) -> Copy | subprocess.Popen[bytes]:
    """The process that writes, in a session of its own.

    A copy has Python and numpy loaded, which take a new one 0.1 s.

    Args:
        theirs: file descriptors that it inherits, as `recorder_process` names them; cores: that it may run on.
        environment: of the process.
    """
    if threading.active_count() == 1 and not any(name in sys.modules for name in LIBRARIES):
        sys.stdout.flush()
        sys.stderr.flush()
        pid = os.fork()
        if pid:
            return Copy(pid)
        _write(theirs, cores, environment)
    return subprocess.Popen(
        [sys.executable, "-P", "-m", MODULE, *map(str, theirs), cores],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        pass_fds=theirs,
        start_new_session=True,
        env=environment,
    )


def _write(theirs: Sequence[int], cores: str, environment: Mapping[str, str]) -> None:
    """What the copy does, to its end."""
    code = 3
    try:
        os.setsid()
        for number in signal.valid_signals():
            # Handlers in Python are for the command that this process was a copy of.
            if callable(signal.getsignal(number)):
                signal.signal(number, signal.SIG_DFL)
        nowhere = os.open(os.devnull, os.O_RDWR)
        for fd in range(3):
            os.dup2(nowhere, fd)
        low = 3
        for fd in sorted(theirs):
            os.closerange(low, fd)
            low = fd + 1
        os.closerange(low, os.sysconf("SC_OPEN_MAX"))
        os.environ.clear()
        os.environ.update(environment)
        with suppress(OSError), open("/proc/self/comm", "w") as name:
            name.write(NAME)
        gc.freeze()
        gc.enable()
        from restshape.replay.recording.recorder_process import main

        code = main([*map(str, theirs), cores])
    finally:
        os._exit(code)
