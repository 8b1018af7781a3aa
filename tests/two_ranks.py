"""Two ranks that stay: they run command line after command line, so that MPI and all imports start once."""

import json
import socket
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

RANKS = 2
PROGRAM = Path(__file__).with_name("rank_program.py")


class TwoRanks:
    """Runs commands on two ranks of processes that are started at the first one, and again after a failure.

    Args:
        start: the words that start a program on ranks.
        first: what the process that starts them does before.
        environment: of the processes.
        seconds: that a command may take.
    """

    def __init__(
        self,
        start: Sequence[str],
        first: Callable[[], None] | None,
        environment: dict[str, str],
        seconds: float = 120.0,
    ) -> None:
        self.start, self.first, self.environment, self.seconds = start, first, environment, seconds
        self.process: subprocess.Popen | None = None
        self.links: list = []

    def __call__(self, *words: object, folder: Path) -> subprocess.CompletedProcess:
        """What a command gave in a folder: the larger exit code, and what the ranks printed, the first one's first."""
        asked = json.dumps({"words": [str(word) for word in words], "folder": str(folder)})
        try:
            if self.process is None:
                self._start()
            for link in self.links:
                print(asked, file=link, flush=True)
            reported = [json.loads(link.readline()) for link in self.links]
        except (OSError, ValueError) as error:
            # One of them waits for the other, or is no more.
            self.stop()
            raise RuntimeError(f"two ranks did not both answer: {words}") from error
        code = max(answer["code"] for answer in reported)
        out, err = ("".join(answer[key] for answer in reported) for key in ("out", "err"))
        return subprocess.CompletedProcess(words, code, out, err)

    def _start(self) -> None:
        with tempfile.TemporaryDirectory() as folder, socket.socket(socket.AF_UNIX) as door:
            door.bind(path := f"{folder}/door")
            door.listen(RANKS)
            door.settimeout(self.seconds)
            command, nothing = [*self.start, sys.executable, str(PROGRAM), path], subprocess.DEVNULL
            self.process = subprocess.Popen(command, env=self.environment, stdin=nothing, preexec_fn=self.first)
            for _ in range(RANKS):
                link = door.accept()[0]
                link.settimeout(self.seconds)
                self.links.append(link.makefile("rw"))
                link.close()
        self.links.sort(key=lambda link: not json.loads(link.readline())["first"])

    def stop(self) -> None:
        """End the processes."""
        for link in self.links:
            link.close()
        if self.process is not None:
            try:
                self.process.wait(timeout=5)
            except subprocess.TimeoutExpired:
                self.process.terminate()
                self.process.wait(timeout=20)
        self.process, self.links = None, []
