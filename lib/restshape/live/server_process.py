"""The simulating process as the server holds it: started at once, ended at any time, started again where it was."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from collections.abc import Sequence

WORKER = "restshape.live.worker"
PARENT = "RESTSHAPE_LIVE_PARENT"
"""Environment variable with the number of the process with which a session ends."""


class SimulatingProcess:
    """A process that simulates, and the server's end of the socket pair to it.

    Args:
        words: its arguments: scene and options.

    Attributes:
        words: as given; end: of the socket pair.
        lines: text of the script so far, an event a line, from which another process goes on.
        events: that these lines hold.
        resting: line of the event in which the simulation comes to rest, as it is so far; empty where it does not.
    """

    def __init__(self, words: Sequence[str]) -> None:
        self.words = list(words)
        self.lines = self.resting = ""
        self.events = 0
        self.end, self._process = self._started([])

    @property
    def can_start(self) -> bool:
        """Whether it can be started again."""
        return True

    def write(self, lines: str, events: int) -> None:
        """The script has gained lines, and has so many events now."""
        self.lines, self.resting, self.events = self.lines + lines, "", events

    def start_again(self) -> None:
        """Starts another process in place of one that has ended; it waits for the lines of the script."""
        self.write(self.resting, self.events + bool(self.resting))
        self.end, self._process = self._started(["--resume"])

    def command(self, number: int, more: list[str]) -> list[str]:
        """What is run, with a descriptor of the link and further options."""
        return [sys.executable, "-m", WORKER, "--link", str(number), *more, *self.words]

    def _started(self, more: list[str]) -> tuple[socket.socket, subprocess.Popen[bytes]]:
        here, there = socket.socketpair()
        with there:
            number = there.fileno()
            command = self.command(number, more)
            # In a session of its own: Ctrl-C is for the server, which ends it in order.
            process = subprocess.Popen(command, pass_fds=[number], stdin=subprocess.DEVNULL, start_new_session=True)
        return here, process

    def kill(self) -> None:
        """Ends it at once, whatever it does."""
        self._process.kill()

    def wait(self, seconds: float | None = None) -> int:
        """Its exit code, once it has ended; it is killed where that takes longer than so many seconds."""
        try:
            return self._process.wait(seconds)
        except subprocess.TimeoutExpired:
            self.kill()
            return self._process.wait()


class GivenProcess(SimulatingProcess):
    """The first rank of several, which has started the server: it is not the server's to end, nor to start again.

    Args:
        number: descriptor of the server's end of the socket pair.
    """

    def __init__(self, number: int) -> None:
        self.lines, self.resting, self.events = "", "", 0
        self.end = socket.socket(fileno=number)

    @property
    def can_start(self) -> bool:
        """It cannot."""
        return False

    def start_again(self) -> None:
        """Never called."""
        raise NotImplementedError

    def kill(self) -> None:
        """Leaves it to find that its link has closed."""

    def wait(self, seconds: float | None = None) -> int:
        """Nothing is known of it but that its link has closed."""
        return 0


MPI_NAMES = ("OMPI_", "PMIX_", "PMI_", "PRTE_", "HYDRA_", "MPIR_", "MPI_LOCAL")


def clean_environment() -> dict[str, str]:
    """The environment without what makes a process a rank of MPI."""
    return {name: value for name, value in os.environ.items() if not name.startswith(MPI_NAMES)}
