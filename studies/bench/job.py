"""One timed replay in a process of its own: what it is given, and the process that runs it."""

import json
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from restshape.cli.petsc_notes import note_petsc
from restshape.cli.verbosity import relay
from restshape.errors import UserError

Row = dict[str, Any]

STOPPED = "stopped"
"""Begins what is said of a process that has used up its time."""


@dataclass(frozen=True)
class Job:
    """One replay of files.

    Args:
        scene: scene file.
        edits: edit script; empty: the scene's first shape alone.
        policy: name of the policy; with another initial guess than its own ``NAME:GUESS``.
        overrides: ``key=value`` as after --set.
        petsc: words for PETSc's options database.
        frames: number of frames to compute, the first included; None for all of them.
        count: count PETSc's events a frame, which costs time.
        estimate: estimate errors, and jumps of the mesh, in the frames that the scene says; else in none.
        enough: stop after so many frames of a level, by level.
        seconds: that its process may take; None: no limit.
        predict: "none" or "linear", as after --predict.
        measure: "prediction", "derivative" or "starts", or a module's full name: what is measured in place of the
            frames' times.
        details: what that module is given besides.
    """

    scene: str
    edits: str
    policy: str
    overrides: tuple[str, ...] = ()
    petsc: tuple[str, ...] = ()
    frames: int | None = None
    count: bool = False
    estimate: bool = False
    enough: dict[str, int] = field(default_factory=dict)
    seconds: float | None = None
    predict: str = "none"
    measure: str = ""
    details: dict[str, Any] = field(default_factory=dict)

    def dumps(self) -> str:
        """The job as JSON."""
        return json.dumps(asdict(self))

    @classmethod
    def loads(cls, text: str) -> "Job":
        """The job of that JSON."""
        found = json.loads(text)
        return cls(**{**found, "overrides": tuple(found["overrides"]), "petsc": tuple(found["petsc"])})


@dataclass
class Outcome:
    """What a process reported: a row a frame, and how it ended.

    Args:
        rows: in order; as many as were computed before the end.
        problem: why it ended early; empty when it did not.
        found: what was measured in place of the frames' times.
        unused: words for PETSc that it made no use of; None where the process ended before that was known.
    """

    rows: list[Row]
    problem: str = ""
    found: Row | None = None
    unused: list[str] | None = None


_left: dict[tuple[str, ...], list[str]] = {}
"""Words for PETSc of the jobs of this process, and those that none of them has used."""


def unused_by_all(words: Sequence[str]) -> list[str]:
    """Those of the words for PETSc that no job with them has used so far; none where no such job has ended."""
    return _left.get(tuple(words), [])


def note_words(words: Sequence[str]) -> None:
    """Prints which words for PETSc no job has used, and which have no effect."""
    note_petsc(words, unused_by_all(words))


def run(job: Job, seconds: float | None = None, start: Callable[..., subprocess.Popen] = subprocess.Popen) -> Outcome:
    """What the job gave in a fresh process on one core.

    Args:
        job: what to replay.
        seconds: after so long the process is ended, in place of the job's own; the rows until then are kept.
        start: starts processes.

    Raises:
        UserError: the job cannot be run: a bad scene, script, or option.
    """
    seconds = job.seconds if seconds is None else seconds
    with tempfile.TemporaryDirectory(prefix="restshape-bench-") as folder:
        reports = Path(folder) / "reports.jsonl"
        command = [sys.executable, "-P", "-m", "restshape_studies.bench.process", str(reports)]
        process = start(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            env=os.environ | {"OMP_NUM_THREADS": "1"},
        )
        try:
            _, stderr = process.communicate(job.dumps(), timeout=seconds)
            relay(stderr)
            problem = ending(process.returncode, stderr)
        except subprocess.TimeoutExpired:
            problem = f"{STOPPED} after {seconds:.0f} s"
        finally:
            if process.poll() is None:
                process.kill()
                process.communicate()
        outcome = read_reports(reports, problem)
    if outcome.unused is not None:
        _left[job.petsc] = [word for word in _left.get(job.petsc, outcome.unused) if word in outcome.unused]
    return outcome


def ending(code: int, stderr: str) -> str:
    """What the end of a process means; nothing where all went well, or where the process itself reported why."""
    if code == 0:
        return ""
    if code == -signal.SIGKILL:
        return "killed by the system, as when memory runs out"
    # A crash of Python's ends with a list of everything imported, which shows nothing.
    lines = [line for line in stderr.splitlines() if line.strip() and not line.startswith("Extension modules:")]
    return f"ended with code {code}: {lines[-1] if lines else 'no message'}"


def read_reports(reports: Path, problem: str) -> Outcome:
    """The outcome from the lines of a process; a last line that is torn is left out."""
    outcome = Outcome([], problem)
    for line in reports.read_text().split("\n")[:-1] if reports.is_file() else []:
        kind, content = json.loads(line)
        if kind == "error":
            raise UserError(**content)
        if kind == "found":
            outcome.found = content
        elif kind == "unused":
            outcome.unused = content
        else:
            outcome.rows.append(content)
    return outcome
