"""A process that shows what it does line by line, and may crash or hang while it does."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from restshape_studies.bench.job import ending

from restshape.cli.verbosity import relay

REPORTS = "reports.jsonl"
LOOK = 0.05
"""Seconds between two looks at a process."""

READY = "ready"
"""What a process reports first that works on one thing for long before it has another line to report."""

WAITING = 10.0
"""How many times as long a process may be silent that does not compute, where the system does not report why."""

START = 60.0
"""Seconds that a process may take besides to come to its first line: a busy machine imports slowly."""

LAST_WORDS = 10.0
"""Seconds that a process may take to say where it was."""


@dataclass(frozen=True)
class End:
    """How a process ended.

    Args:
        problem: empty where all went well.
        hung: it was ended because it had reported nothing for too long.
        last_words: the last lines of its messages.
    """

    problem: str
    hung: bool
    last_words: str


class Telling:
    """The file that a process reports its lines to; ``report(kind, content)``."""

    def __init__(self, folder: Path) -> None:
        self.file = (folder / REPORTS).open("w", buffering=1)

    def __call__(self, kind: str, content: Any = None) -> None:
        self.file.write(json.dumps([kind, content]) + "\n")


def watch(
    module: str, folder: Path, job: Any, silence: float, heard: Callable[[str, Any], None], words: tuple[str, ...] = ()
) -> End:
    """How a process ended that runs a module with a folder as its argument.

    Args:
        module: is given `job` as JSON on stdin, and reports its lines to the folder's file.
        folder: for files of the process.
        job: what it shall do.
        silence: seconds without a line after which it is ended: of the processor's time, or of waiting for something
            else than the processor; `START` more before the first one.
        heard: is given each line, as soon as it is there.
        words: further arguments.
    """
    (folder / REPORTS).unlink(missing_ok=True)
    with (folder / "stderr").open("w") as stderr:
        process = subprocess.Popen(
            [sys.executable, "-P", "-m", module, str(folder), *words],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=stderr,
            text=True,
            env=os.environ | {"OMP_NUM_THREADS": "1"},
        )
        try:
            process.stdin.write(json.dumps(job))
            process.stdin.close()
            hung = _listen(process, folder / REPORTS, silence, heard)
        finally:
            _end(process)
    messages = (folder / "stderr").read_text(errors="replace")
    relay(messages)
    problem = f"reported nothing for {silence:g} s" if hung else ending(process.returncode, messages)
    lines = [line for line in messages.splitlines() if line.strip()]
    return End(problem, hung, " | ".join(lines[-8:]))


def _end(process: subprocess.Popen) -> None:
    """End a process if it still runs, so that it says where it is if it can."""
    if process.poll() is None:
        process.send_signal(signal.SIGABRT)
        try:
            process.wait(LAST_WORDS)
        except subprocess.TimeoutExpired:
            process.kill()
    process.wait()


def _listen(process: subprocess.Popen, path: Path, silence: float, heard: Callable[[str, Any], None]) -> bool:
    """Hand on all lines until the process ends; whether it was silent for too long."""
    at, clock = 0, Silence(process.pid, silence, START)
    while True:
        over = process.poll() is not None
        whole = path.read_bytes()[at:] if path.is_file() else b""
        whole = whole[: whole.rfind(b"\n") + 1]
        for line in whole.splitlines():
            kind, content = json.loads(line)
            if kind != READY:
                heard(kind, content)
        at += len(whole)
        if whole:
            clock = Silence(process.pid, silence)
        if over or clock.over():
            return not over
        time.sleep(LOOK)


class Silence:
    """How long a process has been silent, by its own time: on a busy machine others have the processor for long.

    Args:
        process: its number.
        limit: seconds of computing, or of waiting for anything but the processor, after which it is too long.
        more: seconds besides.
    """

    def __init__(self, process: int, limit: float, more: float = 0.0) -> None:
        self.process, self.limit, self.more = process, limit, more
        self.since, self.computed, self.queued = time.monotonic(), processor_time(process), queue_time(process)

    def over(self) -> bool:
        """Whether it has been too long."""
        computed, queued = processor_time(self.process) - self.computed, queue_time(self.process)
        known = queued is not None and self.queued is not None
        waited = time.monotonic() - self.since - computed - (queued - self.queued if known else 0.0)
        return computed > self.limit + self.more or waited > self.limit * (1.0 if known else WAITING) + self.more


def processor_time(process: int) -> float:
    """Seconds that a process has computed; 0 where the system does not report."""
    try:
        fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return 0.0
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def queue_time(process: int) -> float | None:
    """Seconds that the first thread of a process could have computed, but others had the processor.

    None where the system does not report.
    """
    try:
        return int(Path(f"/proc/{process}/schedstat").read_text().split()[1]) / 1e9
    except (OSError, IndexError):
        return None
