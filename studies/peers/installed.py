"""Which peers there are, where they are installed, and how one is started."""

from __future__ import annotations

import os
import subprocess
import tempfile
import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from restshape_studies.bench.process import pin

from restshape.errors import UserError

HERE = Path(__file__).parent
WAYS = ("documented", "tuned")
"""As a peer's documentation would have it, and as an expert would tune it."""
PROGRAMS = {
    "dolfinx": "dolfinx",
    "scikit-fem": "scikit_fem",
    "ngsolve": "ngsolve",
    "freefem": "freefem",
    "newton": "newton",
}
"""Folders of programs by peer."""
NO_PROGRAM = 4
"""Code with which a process ends where a peer cannot do a problem."""


@dataclass(frozen=True)
class Ended:
    """A process that has ended.

    Args:
        code: 0 where all went well; said: the last line of its errors.
        seconds, processor: from its start to its end; peak_mb: of its memory, and of processes that it waited for.
    """

    code: int
    said: str
    seconds: float
    processor: float
    peak_mb: float


def python_of(peer: str, folder: Path) -> Path:
    """The Python that runs a peer's programs.

    Raises:
        UserError: the peer is not installed there.
    """
    path = folder / peer / "python"
    if not path.is_file():
        raise UserError(f"{peer} is not installed in {folder}", "--installed", f"scripts/peers.sh {folder} {peer}")
    return path


def run(command: Sequence[str], seconds: float, **surroundings: str) -> Ended:
    """Runs a process to its end, on one core and with one thread; it is ended after so many seconds.

    Args:
        command: its words; seconds: that it may take; surroundings: further variables.
    """
    with tempfile.TemporaryFile("w+") as errors:
        begun = time.perf_counter()
        process = subprocess.Popen(
            command,
            stdout=subprocess.DEVNULL,
            stderr=errors,
            env=os.environ | {"OMP_NUM_THREADS": "1"} | surroundings,
            preexec_fn=pin,
        )
        late = threading.Timer(seconds, process.kill)
        late.start()
        _, status, usage = os.wait4(process.pid, 0)
        late.cancel()
        elapsed = time.perf_counter() - begun
        process.returncode = os.waitstatus_to_exitcode(status)
        errors.seek(0)
        lines = [line for line in errors.read().splitlines() if line.strip()]
    said = f"has not ended within {seconds:.0f} s" if elapsed >= seconds else (lines or ["no message"])[-1]
    return Ended(process.returncode, said, elapsed, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024)
